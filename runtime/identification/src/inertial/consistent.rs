//! Inertial parameters of bodies that can exist, as a convex program.
//!
//! `minimize ½ xᵀ H x − gᵀ x` over parameters whose bodies have positive semidefinite pseudo-inertias (Sousa,
//! Cortesão 2014; Wensing, Kim, Slotine 2017) and whose listed further entries are not negative. For least
//! squares `H = Wᵀ W` and `g = Wᵀ τ`, plus what `regularized::towards` returns.
//!
//! The method is a primal-dual interior-point method over the 4 × 4 pseudo-inertias; it needs ten to thirty
//! factorizations of a matrix as large as H. It always returns the global minimum, up to a gap that it states.

pub(crate) use super::problem::ConsistentProblem;

use super::interior_point::{Cone, Point};
use super::pseudo_inertia::{PER_BODY, from_pseudo_inertia, margin, pseudo_inertia};
use super::scaled::Scaled;
use crate::error::{IdentificationError, Result, require_finite, require_length, require_setting};
use nalgebra::{DMatrix, DVector, Matrix4};

/// Smallest [`margin`] of a body in a solution.
pub(crate) const MARGIN: f64 = 1e-6;

/// Gap and residual of a solution, relative to what the objective gains from zero to its free minimum; larger
/// ones are an error.
pub(crate) const TOLERANCE: f64 = 1e-8;

/// The minimum, with the numbers that show it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ConsistentSolution {
    /// x. Each body's [`margin`] is at least [`MARGIN`] (up to rounding); the listed entries are ≥ 0.
    pub parameters: DVector<f64>,
    /// `½ xᵀ H x − gᵀ x`.
    pub objective: f64,
    /// How far the objective can lie above the smallest, in its unit: the duality gap of the returned x.
    pub gap: f64,
    /// [`Self::gap`] relative to what the objective gains from zero to its minimum without cones.
    pub relative_gap: f64,
    /// Largest violation of the stationarity `H x − g − z = 0`, scaled by its terms.
    pub residual: f64,
    /// Factorizations needed.
    pub iterations: usize,
    /// Bodies which the data would make impossible: their pseudo-inertias are singular up to the margin.
    pub on_boundary: Vec<usize>,
    /// Listed entries that would be negative without the bound, or that H does not contain. They are exactly zero.
    pub at_zero: Vec<usize>,
    /// Directions of x that H does not determine.
    pub open: usize,
}

/// Solves the program.
///
/// # Errors
/// Shapes that disagree, values that are not finite, an H that is not symmetric or not positive semidefinite,
/// or an iteration that does not reach [`TOLERANCE`].
pub(crate) fn solve(problem: &ConsistentProblem) -> Result<ConsistentSolution> {
    check(problem)?;
    let scaled = Scaled::new(problem)?;
    let cone = Cone {
        hessian: &scaled.hessian,
        linear: &scaled.linear,
        blocks: problem.bodies,
        scalars: &problem.nonnegative,
    };
    let point = cone.minimize();
    require_converged(&point)?;
    let mut parameters = scaled.parameters(&point.u);
    let at_zero = at_zero(problem, &scaled, &point);
    for &i in &at_zero {
        parameters[i] = 0.0;
    }
    let on_boundary = keep_margin(problem.bodies, &mut parameters);
    require_possible(problem.bodies, &parameters, point.iterations)?;
    let product = &problem.hessian * &parameters;
    let energy = scaled.energy;
    let gap = gap(problem, &scaled, &point, &parameters);
    Ok(ConsistentSolution {
        objective: 0.5 * parameters.dot(&product) - problem.linear.dot(&parameters),
        gap,
        relative_gap: gap / energy,
        residual: point.residual,
        iterations: point.iterations,
        on_boundary,
        at_zero,
        open: scaled.open,
        parameters,
    })
}

/// Upper bound of what the objective can still fall, for a point moved away from the iteration's last one.
fn gap(problem: &ConsistentProblem, scaled: &Scaled, point: &Point, parameters: &DVector<f64>) -> f64 {
    let last = scaled.parameters(&point.u);
    let moved = parameters - &last;
    let slope = &problem.hessian * &last - &problem.linear;
    let rise = moved.dot(&slope) + 0.5 * moved.dot(&(&problem.hessian * &moved));
    (point.gap * scaled.energy + rise).max(0.0)
}

/// Scaled entries and multipliers are of one size, and their product is nearly zero: the smaller one is.
fn at_zero(problem: &ConsistentProblem, scaled: &Scaled, point: &Point) -> Vec<usize> {
    let zero = |i: &usize| point.u[*i] < point.z[*i] || scaled.unseen.contains(i);
    problem.nonnegative.iter().copied().filter(zero).collect()
}

/// Moves bodies away from the boundary by enlarging the diagonal of their pseudo-inertias; returns which.
fn keep_margin(bodies: usize, parameters: &mut DVector<f64>) -> Vec<usize> {
    let mut moved = Vec::new();
    for (b, pi) in parameters.as_mut_slice().chunks_exact_mut(PER_BODY).take(bodies).enumerate() {
        let mut body = [0.0; PER_BODY];
        body.copy_from_slice(pi);
        let missing = MARGIN - margin(&body);
        if missing > 0.0 {
            let j = pseudo_inertia(&body);
            let enlarged = j + Matrix4::from_diagonal(&j.diagonal()) * (missing * (1.0 + 2.0 * MARGIN));
            pi.copy_from_slice(&from_pseudo_inertia(&enlarged));
            moved.push(b);
        }
    }
    moved
}

/// Sums of a pseudo-inertia's entries can lose the smaller ones entirely; then there is no result.
fn require_possible(bodies: usize, parameters: &DVector<f64>, iterations: usize) -> Result<()> {
    for (b, pi) in parameters.as_slice().chunks_exact(PER_BODY).take(bodies).enumerate() {
        let possible = margin(&std::array::from_fn(|k| pi[k])) > 0.0;
        if !possible || !pi.iter().all(|x| x.is_finite()) {
            return Err(IdentificationError::NotConverged {
                what: "the physically consistent estimate".into(),
                iterations,
                detail: format!(
                    "body {b} has moments so far apart that rounding makes it impossible: {pi:?}"
                ),
            });
        }
    }
    Ok(())
}

fn require_converged(point: &Point) -> Result<()> {
    if point.gap <= TOLERANCE && point.residual <= TOLERANCE {
        return Ok(());
    }
    Err(IdentificationError::NotConverged {
        what: "the physically consistent estimate".into(),
        iterations: point.iterations,
        detail: format!(
            "relative gap {:.1e}, residual {:.1e}, both must fall below {TOLERANCE:.0e}",
            point.gap, point.residual
        ),
    })
}

fn check(problem: &ConsistentProblem) -> Result<()> {
    let n = problem.linear.len();
    require_length("rows of the Hessian", n, problem.hessian.nrows())?;
    require_length("columns of the Hessian", n, problem.hessian.ncols())?;
    let needed = PER_BODY * problem.bodies;
    if n < needed {
        require_length("parameters, ten per body", needed, n)?;
    }
    require_finite("the Hessian", problem.hessian.as_slice())?;
    require_finite("the linear term", problem.linear.as_slice())?;
    for (k, &i) in problem.nonnegative.iter().enumerate() {
        let fresh = !problem.nonnegative[..k].contains(&i);
        let requirement = "it must be an entry behind the bodies, listed once";
        require_setting(
            &format!("nonnegative entry {k}"),
            i as f64,
            fresh && (needed..n).contains(&i),
            requirement,
        )?;
    }
    require_symmetric(&problem.hessian)
}

/// Symmetric up to rounding, relative to the diagonal.
fn require_symmetric(h: &DMatrix<f64>) -> Result<()> {
    for i in 0..h.nrows() {
        let requirement = "the Hessian's diagonal must not be negative";
        require_setting(&format!("Hessian entry ({i}, {i})"), h[(i, i)], h[(i, i)] >= 0.0, requirement)?;
        for j in 0..i {
            let size = (h[(i, i)] * h[(j, j)]).sqrt();
            let close = (h[(i, j)] - h[(j, i)]).abs() <= 1e-9 * size + f64::MIN_POSITIVE;
            let name = format!("Hessian entry ({i}, {j}) less ({j}, {i})");
            require_setting(&name, h[(i, j)] - h[(j, i)], close, "the Hessian must be symmetric")?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::is_physically_consistent;
    use super::super::pseudo_inertia::tests::body;
    use super::*;
    use crate::numeric::random::SplitMix64;

    /// The problem of `reference.py`: bodies from 10 g to 100 kg and from 3 mm to 0.3 m, behind them entries
    /// of several sizes, half of them not negative. Also the sizes.
    fn drawn(seed: u64, bodies: usize, further: usize, rows: usize) -> (ConsistentProblem, DVector<f64>) {
        let mut random = SplitMix64::new(seed);
        let n = PER_BODY * bodies + further;
        let (mut truth, mut sizes) = (Vec::new(), Vec::new());
        for _ in 0..bodies {
            let mass = 10f64.powf(4.0 * random.uniform() - 2.0);
            let size = 10f64.powf(2.0 * random.uniform() - 2.5);
            truth.extend(body(&mut random, mass, size));
            sizes.extend([mass]);
            sizes.extend([mass * size; 3]);
            sizes.extend([mass * size * size; 6]);
        }
        for _ in 0..further {
            let size = 10f64.powf(4.0 * random.uniform() - 3.0);
            truth.push(size * (2.0 * random.uniform() - 1.0));
            sizes.push(size);
        }
        let sizes = DVector::from_vec(sizes);
        let drawn: Vec<f64> = (0..rows * n).map(|_| 2.0 * random.uniform() - 1.0).collect();
        let unit = DMatrix::from_row_slice(rows, n, &drawn);
        let w = DMatrix::from_fn(rows, n, |i, j| unit[(i, j)] / sizes[j]);
        let noise: Vec<f64> = (0..rows).map(|_| 6.0 * random.uniform() - 3.0).collect();
        let tau = &w * DVector::from_vec(truth) + DVector::from_vec(noise);
        let nonnegative = (PER_BODY * bodies..n - further / 2).collect();
        (ConsistentProblem { hessian: w.tr_mul(&w), linear: w.tr_mul(&tau), bodies, nonnegative }, sizes)
    }

    /// Whether the point is feasible, as strictly as is promised.
    fn require_feasible(problem: &ConsistentProblem, solution: &ConsistentSolution) {
        for pi in solution.parameters.as_slice().chunks_exact(PER_BODY).take(problem.bodies) {
            let pi: &[f64; PER_BODY] = pi.try_into().unwrap();
            // The parameters are sums of the pseudo-inertia's entries: the smaller ones are rounded.
            let d = pseudo_inertia(pi).diagonal().rows(0, 3).into_owned();
            let rounding = 1e-15 * d.max() / d.min();
            assert!(is_physically_consistent(pi), "{pi:?}");
            assert!(margin(pi) > 0.99 * MARGIN - rounding, "{pi:?} {:e} {rounding:e}", margin(pi));
        }
        for &i in &problem.nonnegative {
            let x = solution.parameters[i];
            assert!(x >= 0.0 && (x == 0.0) == solution.at_zero.contains(&i), "{i} {x}");
        }
    }

    #[test]
    fn agrees_with_clarabel() {
        for line in include_str!("reference.txt").lines() {
            let numbers: Vec<f64> = line.split(' ').map(|x| x.parse().unwrap()).collect();
            let [seed, bodies, further, rows] = [0, 1, 2, 3].map(|k| numbers[k] as usize);
            let (problem, sizes) = drawn(seed as u64, bodies, further, rows);
            let solution = solve(&problem).unwrap();
            require_feasible(&problem, &solution);
            let (value, bound, scale) = (numbers[4], numbers[5], numbers[4].abs());
            // The gap is what the margin costs: without it the value is Clarabel's, to the digits that it has.
            let least = solution.objective - solution.gap;
            assert!(least < value + 1e-8 * scale && least > bound - 1e-8 * scale, "{least} {value} {bound}");
            assert!(solution.relative_gap < 1e-6 && solution.residual < 1e-10 && solution.iterations < 30);
            let difference = &solution.parameters - DVector::from_column_slice(&numbers[6..]);
            let largest = difference.component_div(&sizes).amax();
            println!(
                "{seed}: {} iterations, gap {:.1e}, {largest:e}",
                solution.iterations, solution.relative_gap
            );
            assert!(largest < 5e-5, "{seed}: {largest:e}");
        }
    }

    #[test]
    fn no_possible_point_is_better() {
        let (problem, _) = drawn(17, 3, 6, 50);
        let solution = solve(&problem).unwrap();
        let value = |x: &DVector<f64>| 0.5 * x.dot(&(&problem.hessian * x)) - problem.linear.dot(x);
        assert!(!solution.on_boundary.is_empty());
        let mut random = SplitMix64::new(3);
        for length in [1e-6, 1e-4, 1e-2, 1.0] {
            for _ in 0..50 {
                // Towards another possible point: convex, so possible.
                let mut other: Vec<f64> = (0..3)
                    .flat_map(|b| {
                        let mass = solution.parameters[PER_BODY * b] * 2.0 * random.uniform();
                        body(&mut random, mass, 0.1)
                    })
                    .collect();
                other.extend((0..6).map(|i| solution.parameters[30 + i] * (1.0 + random.normal().abs())));
                let to = DVector::from_vec(other) - &solution.parameters;
                let moved = &solution.parameters + to * length;
                assert!(value(&moved) >= solution.objective - solution.gap - 1e-9, "{length}");
            }
        }
    }

    #[test]
    fn possible_least_squares_stay_what_they_are() {
        let (mut problem, sizes) = drawn(5, 4, 6, 300);
        let mut truth: Vec<f64> = (0..4).flat_map(|b| body(&mut SplitMix64::new(b), 1.0, 0.1)).collect();
        truth.extend(sizes.iter().skip(40));
        let truth = DVector::from_vec(truth);
        problem.linear = &problem.hessian * &truth;
        let solution = solve(&problem).unwrap();
        assert!(solution.on_boundary.is_empty() && solution.at_zero.is_empty() && solution.open == 0);
        let difference = (&solution.parameters - &truth).component_div(&sizes).amax();
        assert!(difference < 1e-5 * truth.component_div(&sizes).amax(), "{difference:e}");
        // In other units of force and other frames of reference of the objective nothing changes.
        for factor in [1e-12, 1e12] {
            let other = ConsistentProblem {
                hessian: &problem.hessian * factor,
                linear: &problem.linear * factor,
                ..problem.clone()
            };
            let again = solve(&other).unwrap();
            assert!(
                (&again.parameters - &truth).component_div(&sizes).amax()
                    < 1e-5 * truth.component_div(&sizes).amax()
            );
        }
    }

    #[test]
    fn directions_without_data_are_counted_and_possible() {
        let (problem, _) = drawn(8, 3, 4, 20);
        let solution = solve(&problem).unwrap();
        require_feasible(&problem, &solution);
        assert_eq!(solution.open, 14);
        // The mass of the first body is not seen at all, nor is a free entry, nor one that is not negative.
        let (mut problem, _) = drawn(9, 2, 4, 60);
        for i in [0, 21, 23] {
            problem.hessian.row_mut(i).fill(0.0);
            problem.hessian.column_mut(i).fill(0.0);
            problem.linear[i] = 0.0;
        }
        let solution = solve(&problem).unwrap();
        require_feasible(&problem, &solution);
        assert_eq!(solution.open, 3);
        // No data at all.
        let nothing = ConsistentProblem {
            hessian: DMatrix::zeros(12, 12),
            linear: DVector::zeros(12),
            bodies: 1,
            nonnegative: vec![10],
        };
        let solution = solve(&nothing).unwrap();
        require_feasible(&nothing, &solution);
        assert_eq!((solution.open, solution.objective), (12, 0.0));
    }

    /// Data that see few directions and ask for impossible values of them: the multipliers are singular, too.
    #[test]
    fn few_directions_with_impossible_values_converge() {
        let mut random = SplitMix64::new(21);
        for case in 0..60 {
            let rank = 1 + case % 6;
            let w = DMatrix::from_fn(rank, 20, |r, k| match case {
                // One parameter alone, then the same of both bodies, then any.
                0..20 => f64::from(u8::from(k == case)),
                20..30 => f64::from(u8::from(k % 10 == (case + r) % 10)),
                _ => random.normal(),
            });
            let tau = DVector::from_fn(rank, |_, _| 10.0 * random.normal() - 5.0);
            let (hessian, linear) = (w.tr_mul(&w), w.tr_mul(&tau));
            let problem = ConsistentProblem { hessian, linear, bodies: 2, nonnegative: vec![] };
            let solution = solve(&problem).unwrap_or_else(|error| panic!("{case}: {error}"));
            require_feasible(&problem, &solution);
            assert!(solution.open >= 20 - rank, "{case}");
        }
    }

    #[test]
    fn bodies_lost_in_rounding_are_no_result() {
        // Ixx = Iyy = 10¹⁷ swallow Σxx and Σyy of Izz = 1.
        let mut lost = DVector::from_vec(vec![1.0, 0.0, 0.0, 0.0, 1e17, 0.0, 1e17, 0.0, 0.0, 1.0]);
        keep_margin(1, &mut lost);
        assert!(
            require_possible(1, &lost, 9)
                .unwrap_err()
                .to_string()
                .contains("body 0 has moments so far apart")
        );
    }

    #[test]
    fn bad_programs_have_messages() {
        let (good, _) = drawn(1, 1, 2, 40);
        let message = |change: &dyn Fn(&mut ConsistentProblem)| {
            let mut problem = good.clone();
            change(&mut problem);
            solve(&problem).unwrap_err().to_string()
        };
        assert!(message(&|p| p.hessian[(1, 2)] += 1e-3 * p.hessian[(2, 2)]).contains("must be symmetric"));
        assert!(message(&|p| p.hessian[(3, 3)] = -1.0).contains("diagonal must not be negative"));
        assert!(message(&|p| p.hessian[(11, 11)] *= 0.01).contains("positive semidefinite"));
        assert!(message(&|p| p.linear[0] = f64::NAN).contains("not finite"));
        assert!(message(&|p| p.nonnegative = vec![9]).contains("behind the bodies"));
        assert!(message(&|p| p.nonnegative = vec![10, 10]).contains("listed once"));
        assert!(message(&|p| p.nonnegative = vec![12]).contains("behind the bodies"));
        assert!(message(&|p| p.bodies = 2).contains("ten per body"));
    }
}
