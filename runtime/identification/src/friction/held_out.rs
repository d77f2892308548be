//! R² on data that were left out: the choice of terms and the fit are repeated without each fold in turn.

use super::super::error::Result;
use super::super::methods::constrained::{breaks, constrained_fit};
use super::super::methods::least_squares::Reduced;
use super::super::methods::moments::{Moments, splits};
use super::super::methods::offset::{centre, mean};
use super::design::offset_ranges;
use super::findings::Findings;
use super::selection::Selection;
use super::task::FrictionData;
use gelenk_findings::Rule;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Sees: folds without which a law cannot be fitted.
/// Matters: no error on left-out data is known.
/// Example: a log in which one fold has the only motion.
/// Fixture: `friction/tests.rs`.
const NO_HELD_OUT: Rule = Rule::warning("no-held-out-error");

/// Sums over folds that were left out.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Unseen {
    pub(super) residual: f64,
    pub(super) total: f64,
}

impl Unseen {
    /// `1 − RSS / Σ w (τ − τ̄)²`; `None` where the torque never changes.
    pub(super) fn r_squared(&self) -> Option<f64> {
        (self.total > 0.0).then(|| 1.0 - self.residual / self.total)
    }
}

/// Errors of laws of terms on the folds that they were not fitted to; `None`, with a warning, where a fold leaves
/// too little to fit.
///
/// Each run keeps the offset that it has on all of its samples, also where a part of it is left out: an offset
/// belongs to a run, and no law can foretell it.
///
/// - `total`: `Σ w (τ − τ̄)²` over the folds; `selection`, `rows`: how a law is chosen and constrained
pub(super) fn held_out(
    folds: Result<Vec<Moments>>,
    total: f64,
    (selection, rows): (&Selection, Option<&DMatrix<f64>>),
    findings: &mut Findings,
) -> Option<Unseen> {
    match folds.and_then(|folds| by_folds(&folds, selection, rows)) {
        Ok(residual) => Some(Unseen { residual, total }),
        Err(reason) => {
            findings.add(NO_HELD_OUT.found(format!("no R² on left-out data: {reason}")));
            None
        }
    }
}

/// Σ r² over folds of laws that were chosen and fitted without them.
pub(super) fn by_folds(folds: &[Moments], selection: &Selection, rows: Option<&DMatrix<f64>>) -> Result<f64> {
    let mut sum = 0.0;
    for split in splits(folds) {
        let (training, fold) = split?;
        sum += fold.residual(0, &fit(&Reduced::from_moments(training)?, selection, rows)?);
    }
    Ok(sum)
}

fn fit(training: &Reduced, selection: &Selection, rows: Option<&DMatrix<f64>>) -> Result<DVector<f64>> {
    let free = selection.fit(training)?;
    match rows {
        Some(rows) if breaks(rows, &free.coefficients) => constrained_fit(training, 0, &free.active, rows),
        _ => Ok(free.coefficients),
    }
}

/// `Σ w (τ − τ̄)²` over the rows of `ranges`, τ̄ by run where offsets are separate.
pub(super) fn variation(data: &FrictionData, separate: bool, ranges: &[Range<usize>]) -> f64 {
    let mut torque = data.torques.to_vec();
    if separate {
        centre(&mut torque, &offset_ranges(data), data.weights);
    } else {
        let mean = mean(&torque, data.weights);
        torque.iter_mut().for_each(|t| *t -= mean);
    }
    let weight = |i: usize| data.weights.map_or(1.0, |w| w[i]);
    // A row that stands in two folds is judged twice.
    ranges.iter().cloned().flatten().map(|i| weight(i) * torque[i] * torque[i]).sum()
}
