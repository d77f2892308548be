//! Least squares with linear inequalities, for example nonnegative viscous friction, or passivity τ·v ≥ 0 of
//! a friction torque τ at a velocity v.
//!
//! The problem `min ‖y − Θ ξ‖²` subject to `A ξ ≥ 0` has the target y, the columns Θ of the terms and the
//! coefficients ξ. It is transformed to a least-distance problem, which is transformed to a nonnegative
//! least-squares problem (Lawson and Hanson 1974, ch. 23). ξ = 0 is always feasible.

use super::super::error::{IdentificationError, Result, require_length};
use super::super::numeric::spectrum;
use super::least_squares::Reduced;
use super::library::Library;
use super::moments::Moments;
use nalgebra::{DMatrix, DVector};

/// Returns the matrix A of the constraints `A ξ ≥ 0` for which the coefficients ξ of `terms` are nonnegative.
///
/// - `count`: number of all terms
pub(crate) fn nonnegative_rows(terms: &[usize], count: usize) -> DMatrix<f64> {
    DMatrix::from_fn(terms.len(), count, |i, j| if terms[i] == j { 1.0 } else { 0.0 })
}

/// Returns the matrix A of the constraints `A ξ ≥ 0` for which friction dissipates at the given velocities
/// vₖ: `sign(vₖ) θ(vₖ) ξ ≥ 0` with the terms θ and their coefficients ξ.
///
/// Between these velocities the law may still drive the joint. Therefore their distance must be small enough for the
/// steepest term.
///
/// # Errors
/// [`IdentificationError::Shape`] if the library has other channels than one velocity.
pub(crate) fn passivity_rows(library: &Library, velocities: &[f64]) -> Result<DMatrix<f64>> {
    require_length("channels of a friction library (the velocity alone)", 1, library.channels().len())?;
    let mut theta = library.matrix(&[velocities])?;
    for (mut row, v) in theta.row_iter_mut().zip(velocities) {
        // Rows that are scaled by |v| would be almost zero at small velocities, but the sign of the friction matters there,
        // too.
        row *= super::expression::sign(*v);
    }
    Ok(theta)
}

/// Solves least squares on the terms `active` subject to `A ξ ≥ 0`. Returns the coefficients ξ of all terms.
///
/// - `rows`: matrix A, one row for each inequality and one column for each term
///
/// # Errors
/// - [`IdentificationError::Shape`]: A has the wrong number of columns
/// - [`IdentificationError::Collinear`]: terms are collinear
/// - [`IdentificationError::NotConverged`]: the iteration does not end
pub(crate) fn constrained_fit(
    reduced: &Reduced,
    target: usize,
    active: &[usize],
    rows: &DMatrix<f64>,
) -> Result<DVector<f64>> {
    require_length("columns of the constraints", reduced.moments().terms(), rows.ncols())?;
    constrained(reduced.moments(), reduced.solve(target, active, 0.0)?, active, rows)
}

/// Largest violation of the constraints `A ξ ≥ 0` that counts as rounding, as a share of the largest
/// coefficient ξ.
const ROUNDING: f64 = 1e-9;

/// Returns whether coefficients ξ violate the constraints `A ξ ≥ 0`.
pub(crate) fn breaks(rows: &DMatrix<f64>, coefficients: &DVector<f64>) -> bool {
    (rows * coefficients).min() < -ROUNDING * coefficients.amax()
}

/// Computes the constrained solution from the unconstrained one. The result is the feasible point that is
/// nearest to the unconstrained solution in the metric `ΘᵀΘ` of the terms' columns Θ.
///
/// # Errors
/// [`IdentificationError::Collinear`] if terms are collinear, [`IdentificationError::NotConverged`] if the iteration does
/// not end.
pub(crate) fn constrained(
    moments: &Moments,
    free: DVector<f64>,
    active: &[usize],
    rows: &DMatrix<f64>,
) -> Result<DVector<f64>> {
    let gram = moments.gram().select_rows(active).select_columns(active);
    let collinear = || moments.collinear(active);
    let factor = gram.cholesky().ok_or_else(collinear)?.l();
    // With z = Lᵀ(ξ − ξ_free), E = A L⁻ᵀ and f = −A ξ_free: minimize ‖z‖ subject to E z ≥ f.
    let a = rows.select_columns(active);
    let e = factor.solve_lower_triangular(&a.transpose()).ok_or_else(collinear)?.transpose();
    let f = -rows * &free;
    let z = least_distance(&e, &f)?;
    let change = factor.tr_solve_lower_triangular(&z).ok_or_else(collinear)?;
    let mut coefficients = free;
    for (&i, d) in active.iter().zip(change.iter()) {
        coefficients[i] += d;
    }
    Ok(coefficients)
}

/// Returns the rows of the constraints `A ξ ≥ 0` that are active at the coefficients ξ: `aᵢ ξ = 0` up to
/// rounding.
pub(crate) fn face(rows: &DMatrix<f64>, coefficients: &DVector<f64>) -> DMatrix<f64> {
    let binds = |i: &usize| {
        let terms = rows.row(*i).transpose().component_mul(coefficients);
        terms.sum().abs() <= 1e-8 * terms.lp_norm(1).max(f64::MIN_POSITIVE)
    };
    let all_zero = |i: &usize| rows.row(*i).amax() == 0.0;
    rows.select_rows(&(0..rows.nrows()).filter(|i| binds(i) && !all_zero(i)).collect::<Vec<_>>())
}

/// Minimizes `‖z‖` over vectors z with `E z ≥ f`. The problem must be feasible.
fn least_distance(e: &DMatrix<f64>, f: &DVector<f64>) -> Result<DVector<f64>> {
    let (rows, n) = e.shape();
    if f.iter().all(|f| *f <= 0.0) {
        return Ok(DVector::zeros(n));
    }
    // The rows are scaled to unit length, and f to a largest entry of 1, so that the values of the inner problem are near
    // one.
    let scale = f.amax();
    let norms: Vec<f64> = (0..rows).map(|i| e.row(i).norm().max(f64::MIN_POSITIVE)).collect();
    let matrix =
        DMatrix::from_fn(n + 1, rows, |i, j| (if i < n { e[(j, i)] } else { f[j] / scale }) / norms[j]);
    let mut right = DVector::zeros(n + 1);
    right[n] = 1.0;
    let u = nonnegative_least_squares(&matrix, &right)?;
    let r = &matrix * u - right;
    Ok(DVector::from_fn(n, |i, _| -r[i] / r[n] * scale))
}

/// Minimizes `‖M u − b‖` subject to `u ≥ 0` (Lawson and Hanson 1974, ch. 23, algorithm NNLS).
///
/// # Errors
/// [`IdentificationError::NotConverged`] after 10 exchanges per column
pub(crate) fn nonnegative_least_squares(matrix: &DMatrix<f64>, b: &DVector<f64>) -> Result<DVector<f64>> {
    let n = matrix.ncols();
    let mut u = DVector::<f64>::zeros(n);
    let mut passive: Vec<usize> = Vec::new();
    let tolerance = 1e-13 * matrix.amax() * b.amax();
    let limit = 10 * n.max(10);
    for _ in 0..limit {
        let gradient = matrix.tr_mul(&(b - matrix * &u));
        let candidate =
            (0..n).filter(|j| !passive.contains(j)).max_by(|&i, &j| gradient[i].total_cmp(&gradient[j]));
        let Some(j) = candidate.filter(|&j| gradient[j] > tolerance) else {
            return Ok(u);
        };
        passive.push(j);
        loop {
            let Some(s) = subset_solution(matrix, b, &passive) else {
                passive.pop();
                return Ok(u);
            };
            if s.iter().all(|s| *s > 0.0) {
                u.fill(0.0);
                for (&i, s) in passive.iter().zip(s.iter()) {
                    u[i] = *s;
                }
                break;
            }
            step_to_boundary(&mut u, &mut passive, &s);
        }
    }
    Err(IdentificationError::NotConverged {
        what: "non-negative least squares".into(),
        iterations: limit,
        detail: format!("{} of {n} columns are in the solution", passive.len()),
    })
}

/// Moves from u towards s until the first component becomes zero, and removes the components that are zero from the passive
/// set.
fn step_to_boundary(u: &mut DVector<f64>, passive: &mut Vec<usize>, s: &DVector<f64>) {
    let mut fraction = 1.0_f64;
    for (&i, &s) in passive.iter().zip(s.iter()) {
        if s <= 0.0 {
            fraction = fraction.min(u[i] / (u[i] - s).max(f64::MIN_POSITIVE));
        }
    }
    let mut kept = Vec::with_capacity(passive.len());
    for (&i, &s) in passive.iter().zip(s.iter()) {
        let blocking = s <= 0.0 && u[i] / (u[i] - s).max(f64::MIN_POSITIVE) <= fraction;
        u[i] += fraction * (s - u[i]);
        if blocking || u[i] <= 0.0 {
            u[i] = 0.0;
        } else {
            kept.push(i);
        }
    }
    *passive = kept;
}

fn subset_solution(matrix: &DMatrix<f64>, b: &DVector<f64>, columns: &[usize]) -> Option<DVector<f64>> {
    if columns.is_empty() {
        return Some(DVector::zeros(0));
    }
    let svd = spectrum::svd(matrix.select_columns(columns));
    svd.solve(b, 1e-14 * svd.singular_values.max()).ok()
}

#[cfg(test)]
mod tests {
    use super::super::moments::Samples;
    use super::*;
    use crate::numeric::random::SplitMix64;
    use clarabel::algebra::CscMatrix;
    use clarabel::solver::{
        DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SupportedConeT,
    };

    fn by_interior_points(reduced: &Reduced, rows: &DMatrix<f64>) -> DVector<f64> {
        let p = reduced.moments().terms();
        let (g, b) = (reduced.moments().gram(), reduced.moments().projection(0));
        let upper: Vec<Vec<f64>> =
            (0..p).map(|i| (0..p).map(|j| if i <= j { g[(i, j)] } else { 0.0 }).collect()).collect();
        let a: Vec<Vec<f64>> = rows.row_iter().map(|r| r.iter().map(|x| -x).collect()).collect();
        let q: Vec<f64> = b.iter().map(|b| -b).collect();
        let zeros = vec![0.0; a.len()];
        let cones: [SupportedConeT<f64>; 1] = [NonnegativeConeT(a.len())];
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .tol_gap_abs(1e-12)
            .tol_gap_rel(1e-12)
            .tol_feas(1e-12)
            .build()
            .unwrap();
        let mut solver =
            DefaultSolver::new(&CscMatrix::from(&upper), &q, &CscMatrix::from(&a), &zeros, &cones, settings)
                .unwrap();
        solver.solve();
        DVector::from_column_slice(&solver.solution.x)
    }

    #[test]
    fn agrees_with_clarabel_on_random_constraints() {
        let mut random = SplitMix64::new(4);
        for _ in 0..30 {
            let theta = DMatrix::from_fn(40, 5, |_, _| random.normal());
            let y: Vec<f64> = (0..40).map(|_| random.normal()).collect();
            let rows = DMatrix::from_fn(8, 5, |_, _| random.normal());
            let names: Vec<String> = (0..5).map(|i| format!("t{i}")).collect();
            let reduced = Reduced::new(&Samples::from_matrix(&names, &theta, vec![&y]).unwrap()).unwrap();
            let fit = constrained_fit(&reduced, 0, &[0, 1, 2, 3, 4], &rows).unwrap();
            let reference = by_interior_points(&reduced, &rows);
            assert!((&fit - &reference).amax() < 1e-6, "{fit} {reference}");
            assert!((&rows * fit).min() > -1e-9);
        }
    }

    #[test]
    fn friction_dissipates_where_the_free_fit_would_not() {
        // Data with an offset: the free constant term drives the joint at small velocities.
        let library = Library::new(&["1", "v", "tanh(20*v)"], &["v"]).unwrap();
        let v: Vec<f64> = (0..500).map(|i| (0.05 * f64::from(i)).sin()).collect();
        let y: Vec<f64> = v.iter().map(|v| 0.5 - 0.2 * v + 0.8 * (20.0 * v).tanh()).collect();
        let reduced = Reduced::new(&Samples::from_library(&library, vec![&v], vec![&y]).unwrap()).unwrap();
        let grid: Vec<f64> = (-100..=100).map(|i| f64::from(i) * 0.01).collect();
        let viscous = nonnegative_rows(&[1], 3);
        let passive = passivity_rows(&library, &grid).unwrap();
        let rows = DMatrix::from_rows(&viscous.row_iter().chain(passive.row_iter()).collect::<Vec<_>>());
        let free = reduced.solve(0, &[0, 1, 2], 0.0).unwrap();
        assert!((&rows * &free).min() < -0.1);
        let fit = constrained_fit(&reduced, 0, &[0, 1, 2], &rows).unwrap();
        assert!((&rows * &fit).min() > -1e-10);
        assert!(fit[1].abs() < 1e-10 && (fit[0] - fit[2] * 0.2_f64.tanh()).abs() < 1e-9, "{fit}");
    }
}
