//! R² on data that were left out: the choice of terms and the fit are repeated without each fold in turn.

use super::super::error::Result;
use super::super::methods::constrained::{breaks, constrained_fit};
use super::super::methods::least_squares::Reduced;
use super::super::methods::moments::{Moments, splits};
use super::super::methods::offset::{centre, mean};
use super::super::numeric::statistics::mean_with_error;
use super::design::runs;
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

/// Errors on folds that were left out.
#[derive(Debug, Clone)]
pub(super) struct HeldOutErrors {
    /// `Σ r²` of each fold and its number of samples.
    pub(super) folds: Vec<[f64; 2]>,
    /// `Σ (τ − τ̄)²` over the folds.
    pub(super) total: f64,
}

impl HeldOutErrors {
    /// `1 − RSS / Σ (τ − τ̄)²` with more of both sums; `None` if the torque never changes.
    pub(super) fn r_squared(&self, more: f64) -> Option<f64> {
        let residual: f64 = self.folds.iter().map(|[residual, _]| residual).sum();
        let total = self.total + more;
        (total > 0.0).then(|| 1.0 - (residual + more) / total)
    }

    /// Mean over the folds of their mean squared errors, with its standard error.
    pub(super) fn error(&self) -> [f64; 2] {
        let errors = self.folds.iter().map(|[residual, samples]| residual / samples.max(1.0));
        mean_with_error(&errors.collect::<Vec<_>>())
    }
}

/// Errors of laws of terms on the folds that they were not fitted to; `None`, with a warning, if a fold leaves too little to fit.
///
/// Each run keeps the offset that it has on all of its samples, also where a part of it is left out: an offset
/// belongs to a run, and no law can foretell it.
///
/// - `total`: `Σ (τ − τ̄)²` over the folds; `selection`, `rows`: how a law is chosen and constrained
pub(super) fn held_out(
    folds: Result<Vec<Moments>>,
    total: f64,
    (selection, rows): (&Selection, Option<&DMatrix<f64>>),
    findings: &mut Findings,
) -> Option<HeldOutErrors> {
    match folds.and_then(|folds| by_folds(&folds, selection, rows)) {
        Ok(folds) => Some(HeldOutErrors { folds, total }),
        Err(reason) => {
            findings.add(NO_HELD_OUT.found(format!("no R² on left-out data: {reason}")));
            None
        }
    }
}

/// Σ r² and number of samples of each fold, for laws that were chosen and fitted without it.
fn by_folds(folds: &[Moments], selection: &Selection, rows: Option<&DMatrix<f64>>) -> Result<Vec<[f64; 2]>> {
    let of_split = |split: Result<(Moments, &Moments)>| {
        let (training, fold) = split?;
        let law = fit(&Reduced::from_moments(training)?, selection, rows)?;
        Ok([fold.residual(0, &law), fold.samples() as f64])
    };
    splits(folds).map(of_split).collect()
}

fn fit(training: &Reduced, selection: &Selection, rows: Option<&DMatrix<f64>>) -> Result<DVector<f64>> {
    let free = selection.fit(training)?;
    match rows {
        Some(rows) if breaks(rows, &free.coefficients) => constrained_fit(training, 0, &free.active, rows),
        _ => Ok(free.coefficients),
    }
}

/// `Σ (τ − τ̄)²` over the rows of `ranges`, τ̄ by run where offsets are separate.
pub(super) fn variation(data: &FrictionData, separate: bool, ranges: &[Range<usize>]) -> f64 {
    let mut torque = data.torques.to_vec();
    if separate {
        centre(&mut torque, &runs(data));
    } else {
        let mean = mean(&torque);
        torque.iter_mut().for_each(|t| *t -= mean);
    }
    // A row that stands in two folds is judged twice.
    ranges.iter().cloned().flatten().map(|i| torque[i] * torque[i]).sum()
}
