//! Inertial parameters of physically possible bodies, as a convex program.
//!
//! The program is `minimize ½ xᵀ H x − gᵀ x` over parameters x whose bodies have positive semidefinite pseudo-inertias (Sousa,
//! Cortesão 2014; Wensing, Kim, Slotine 2017), with a list of other entries that are not negative. For least squares with the
//! regressor W and the forces τ, `H = Wᵀ W` and `g = Wᵀ τ`, plus the distance from the description.
//!
//! The solver is a primal-dual interior-point method over the 4 × 4 pseudo-inertias. It needs ten to thirty factorizations
//! of a matrix of the size of H. It finds the global minimum up to a known gap.

use super::interior_point::{Cone, Point};
use super::pseudo_inertia::{PER_BODY, from_pseudo_inertia, margin, pseudo_inertia};
use super::scaled::Scaled;
use crate::error::{IdentificationError, Result, require_finite};
use nalgebra::{DMatrix, DVector, Matrix4};

/// Smallest [`margin`] of a body in a solution.
pub(crate) const MARGIN: f64 = 1e-6;

/// Smallest diagonal entry of the second moments Σ, as a share of the trace of Σ. Moments of inertia are sums of diagonal
/// entries, so smaller entries would be lost by rounding.
const THINNEST: f64 = 1e-12;

/// Largest accepted gap and residual of a solution, relative to the decrease of the objective from zero to its unconstrained
/// minimum.
pub(crate) const TOLERANCE: f64 = 1e-8;

/// Convex program `minimize ½ xᵀ H x − gᵀ x` over the parameters x of physically possible bodies.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ConsistentProblem {
    /// Matrix H of the objective `½ xᵀ H x − gᵀ x`, `n × n`, symmetric and positive definite up to rounding.
    pub hessian: DMatrix<f64>,
    /// Vector g of the objective `½ xᵀ H x − gᵀ x`, n entries.
    pub linear: DVector<f64>,
    /// Number of bodies. The first `10 · bodies` entries of the unknown x are their inertial parameters.
    pub bodies: usize,
    /// Indices of other entries that must not be negative, for example rotor inertias and viscous friction.
    pub nonnegative: Vec<usize>,
}

/// The solution of a [`ConsistentProblem`].
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ConsistentSolution {
    /// Solution x. Each body's [`margin`] is at least [`MARGIN`] (up to rounding). An entry of
    /// [`ConsistentProblem::nonnegative`] is exactly zero if it would be negative without the bound.
    pub parameters: DVector<f64>,
    /// Indices of bodies that would be impossible without the constraints. Their pseudo-inertias are singular up to the margin.
    pub on_boundary: Vec<usize>,
}

/// Solves the convex program.
///
/// # Errors
/// [`IdentificationError::NotFinite`] if values are not finite, and [`IdentificationError::NotConverged`] if the iteration
/// does not reach [`TOLERANCE`] or if rounding makes a body impossible.
pub(crate) fn solve(problem: &ConsistentProblem) -> Result<ConsistentSolution> {
    let (mut parameters, point) = minimum(problem)?;
    for &i in problem.nonnegative.iter().filter(|&&i| point.u[i] < point.z[i]) {
        parameters[i] = 0.0;
    }
    let on_boundary = keep_margin(problem.bodies, &mut parameters);
    require_possible(problem.bodies, &parameters, point.iterations)?;
    Ok(ConsistentSolution { parameters, on_boundary })
}

/// The solution x of the iteration, which lies inside all cones, and the scaled point. Scaled entries and their multipliers
/// have similar sizes, so the smaller of the two counts as zero.
fn minimum(problem: &ConsistentProblem) -> Result<(DVector<f64>, Point)> {
    require_finite("the Hessian", problem.hessian.as_slice())?;
    require_finite("the linear term", problem.linear.as_slice())?;
    let scaled = Scaled::new(problem);
    let cone = Cone {
        hessian: &scaled.hessian,
        linear: &scaled.linear,
        blocks: problem.bodies,
        scalars: &problem.nonnegative,
    };
    let point = cone.minimize();
    require_converged(&point)?;
    Ok((scaled.parameters(&point.u), point))
}

/// Moves bodies away from the boundary by increasing the diagonal of their pseudo-inertias. Returns the indices of these
/// bodies.
fn keep_margin(bodies: usize, parameters: &mut DVector<f64>) -> Vec<usize> {
    let mut moved = Vec::new();
    for (b, pi) in parameters.as_mut_slice().chunks_exact_mut(PER_BODY).take(bodies).enumerate() {
        let mut j = pseudo_inertia(&std::array::from_fn(|k| pi[k]));
        let least = THINNEST * (j[(0, 0)] + j[(1, 1)] + j[(2, 2)]);
        let is_thin = (0..3).any(|k| j[(k, k)] < least);
        (0..3).for_each(|k| j[(k, k)] = j[(k, k)].max(least));
        let missing = (MARGIN - margin(&from_pseudo_inertia(&j))).max(0.0);
        if is_thin || missing > 0.0 {
            let enlarged = j + Matrix4::from_diagonal(&j.diagonal()) * (missing * (1.0 + 2.0 * MARGIN));
            pi.copy_from_slice(&from_pseudo_inertia(&enlarged));
            moved.push(b);
        }
    }
    moved
}

/// Fails if a body is impossible. Sums of a pseudo-inertia's entries can lose the smaller entries by rounding.
fn require_possible(bodies: usize, parameters: &DVector<f64>, iterations: usize) -> Result<()> {
    for (b, pi) in parameters.as_slice().chunks_exact(PER_BODY).take(bodies).enumerate() {
        let possible = margin(&std::array::from_fn(|k| pi[k])) > 0.0;
        if !possible || !pi.iter().all(|x| x.is_finite()) {
            return Err(IdentificationError::NotConverged {
                what: "the physically consistent estimate".into(),
                iterations,
                detail: format!(
                    "rounding makes the inertial parameters of body {b} unphysical, because their sizes differ too much: {pi:?}"
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
            "the relative duality gap is {:.1e} and the residual is {:.1e}, but both must be below {TOLERANCE:.0e}",
            point.gap, point.residual
        ),
    })
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

    fn objective(problem: &ConsistentProblem, x: &DVector<f64>) -> f64 {
        0.5 * x.dot(&(&problem.hessian * x)) - problem.linear.dot(x)
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
            assert!(x >= 0.0, "{i} {x}");
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
            let (least, point) = minimum(&problem).unwrap();
            let least = objective(&problem, &least);
            assert!(least < value + 1e-8 * scale && least > bound - 1e-8 * scale, "{least} {value} {bound}");
            assert!(point.gap < 1e-10 && point.residual < 1e-10 && point.iterations < 25);
            let difference = &solution.parameters - DVector::from_column_slice(&numbers[6..]);
            let largest = difference.component_div(&sizes).amax();
            println!("{seed}: {} iterations, gap {:.1e}, {largest:e}", point.iterations, point.gap);
            assert!(largest < 5e-5, "{seed}: {largest:e}");
        }
    }

    #[test]
    fn no_possible_point_is_better() {
        let (problem, _) = drawn(17, 3, 6, 50);
        let solution = solve(&problem).unwrap();
        let least = objective(&problem, &minimum(&problem).unwrap().0);
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
                assert!(objective(&problem, &moved) >= least - 1e-9, "{length}");
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
        assert!(solution.on_boundary.is_empty());
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
    fn directions_without_data_are_possible() {
        let (problem, _) = drawn(8, 3, 4, 20);
        require_feasible(&problem, &solve(&problem).unwrap());
        // The mass of the first body is not seen at all, nor is a free entry, nor one that is not negative.
        let (mut problem, _) = drawn(9, 2, 4, 60);
        for i in [0, 21, 23] {
            problem.hessian.row_mut(i).fill(0.0);
            problem.hessian.column_mut(i).fill(0.0);
            problem.linear[i] = 0.0;
        }
        require_feasible(&problem, &solve(&problem).unwrap());
    }

    /// Data that see few directions and ask for impossible values of them: the multipliers are singular, too.
    #[test]
    fn few_directions_with_impossible_values_converge() {
        let mut random = SplitMix64::new(21);
        let described = body(&mut random, 1.0, 0.5);
        for case in 0..60 {
            let rank = 1 + case % 6;
            let w = DMatrix::from_fn(rank, 20, |r, k| match case {
                // One parameter alone, then the same of both bodies, then any.
                0..20 => f64::from(u8::from(k == case)),
                20..30 => f64::from(u8::from(k % 10 == (case + r) % 10)),
                _ => random.normal(),
            });
            let tau = DVector::from_fn(rank, |_, _| 10.0 * random.normal() - 5.0);
            let near = DVector::from_fn(20, |i, _| described[i % PER_BODY]);
            let (hessian, linear) =
                (w.tr_mul(&w) + DMatrix::identity(20, 20) * 1e-6, w.tr_mul(&tau) + near * 1e-6);
            let problem = ConsistentProblem { hessian, linear, bodies: 2, nonnegative: vec![] };
            let solution = solve(&problem).unwrap_or_else(|error| panic!("{case}: {error}"));
            require_feasible(&problem, &solution);
        }
    }

    #[test]
    fn thin_bodies_keep_their_mass_and_become_possible() {
        // Ixx = Iyy = 10¹⁷ swallow Σxx and Σyy of Izz = 1.
        let mut lost = DVector::from_vec(vec![1.0, 0.0, 0.0, 0.0, 1e17, 0.0, 1e17, 0.0, 0.0, 1.0]);
        assert_eq!(keep_margin(1, &mut lost), [0]);
        require_possible(1, &lost, 9).unwrap();
        assert_eq!(lost[0], 1.0);
        lost[4] = f64::INFINITY;
        assert!(require_possible(1, &lost, 9).is_err());
    }

    /// The equations of a simulated log: gaps of steps as long as the cones allow rose and fell for ever at 2e-6.
    #[test]
    fn steps_that_would_go_around_the_solution_are_shortened() {
        let mut numbers = include_str!("cycling.txt").split_whitespace().map(|x| x.parse::<f64>().unwrap());
        let mut take = |count: usize| numbers.by_ref().take(count).collect::<Vec<f64>>();
        let (n, bodies, scalars) = (51, 4, [46, 49]);
        let linear = DVector::from_vec(take(n));
        let lower: Vec<Vec<f64>> = (0..n).map(|row| take(row + 1)).collect();
        let hessian = DMatrix::from_fn(n, n, |i, k| lower[i.max(k)][i.min(k)]);
        let point = Cone { hessian: &hessian, linear: &linear, blocks: bodies, scalars: &scalars }.minimize();
        assert!(point.gap < 1e-12 && point.residual < 1e-12 && point.iterations < 25, "{point:?}");
    }
}
