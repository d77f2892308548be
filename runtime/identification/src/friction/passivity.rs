//! Least squares for the chosen terms: passivity, and what is said of terms that resemble each other.

use super::super::constrained::{constrained_fit, face, nonnegative_rows, passivity_rows};
use super::super::digits::plain;
use super::super::error::Result;
use super::super::least_squares::{Reduced, Solution};
use super::super::library::Library;
use super::super::moments::Moments;
use super::findings::Findings;
use nalgebra::{DMatrix, DVector};

/// Condition number of the chosen terms above which coefficients are doubted (the curve need not be).
const DOUBTFUL_CONDITION: f64 = 100.0;

/// Coefficients that contribute less than this share of the torque's rms are what rounding leaves of zero.
const NOTHING: f64 = 1e-12;

/// Rows of `A ξ ≥ 0`: the law dissipates over the speeds in the data, and viscous friction is not negative.
pub(super) fn passive(library: &Library, velocities: [f64; 2]) -> Result<DMatrix<f64>> {
    let fastest = velocities.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
    let grid: Vec<f64> = (-200..=200).map(|i| fastest * f64::from(i) / 200.0).collect();
    let viscous: Vec<usize> = (0..library.len()).filter(|&i| library.terms()[i] == "v").collect();
    let (signs, slope) = (passivity_rows(library, &grid)?, nonnegative_rows(&viscous, library.len()));
    let all: Vec<_> = signs.row_iter().chain(slope.row_iter()).collect();
    Ok(DMatrix::from_rows(&all))
}

/// Least squares under the constraints, where the free solution breaks them, and the rows that bind.
pub(super) fn restrict(
    reduced: &Reduced,
    free: Solution,
    rows: Option<&DMatrix<f64>>,
    samples: usize,
    findings: &mut Findings,
) -> Result<(Solution, DMatrix<f64>)> {
    let none = DMatrix::zeros(0, free.coefficients.len());
    let Some(rows) = rows else { return Ok((free, none)) };
    let worst = (rows * &free.coefficients).min();
    if worst >= -1e-9 * free.coefficients.amax() {
        return Ok((free, none));
    }
    findings.warn(format!(
        "least squares would give a law that drives the joint (by up to {} {}); it was refitted under τ v ≥ 0 and \
         viscous friction ≥ 0, and the standard errors take what this fixes for exact",
        plain(-worst, 3),
        findings.unit
    ));
    let mut coefficients = constrained_fit(reduced, 0, &free.active, rows)?;
    remove_rounding(&mut coefficients, reduced.moments(), samples);
    let binding = face(rows, &coefficients);
    Ok((Solution { coefficients, ..free }, binding))
}

fn remove_rounding(coefficients: &mut DVector<f64>, moments: &Moments, samples: usize) {
    let limit = NOTHING * (moments.energy(0) / samples as f64).sqrt();
    for (i, x) in coefficients.iter_mut().enumerate() {
        let rms = (moments.gram()[(i, i)] / samples as f64).sqrt();
        if x.abs() * rms < limit {
            *x = 0.0;
        }
    }
}

/// Doubts coefficients of chosen terms that resemble each other.
pub(super) fn doubt(reduced: &Reduced, active: &[usize], findings: &mut Findings) {
    let chosen = reduced.moments().correlation().select_rows(active).select_columns(active);
    let eigenvalues = chosen.symmetric_eigenvalues();
    let condition = (eigenvalues.max() / eigenvalues.min().max(f64::MIN_POSITIVE)).sqrt();
    if condition > DOUBTFUL_CONDITION {
        findings.warn(format!(
            "the chosen terms are nearly collinear on these velocities (condition number {}): trust the \
             curve, not the single coefficients",
            plain(condition, 3)
        ));
    }
}
