//! R² on held-out data: the choice of terms and the fit are repeated without each fold in turn.

use super::super::error::Result;
use super::super::methods::constrained::{breaks, constrained_fit};
use super::super::methods::least_squares::Reduced;
use super::super::methods::moments::{Moments, splits};
use super::super::methods::offset::mean;
use super::super::numeric::statistics::mean_with_error;
use super::findings::Findings;
use super::selection::Selection;
use super::task::FrictionData;
use gelenk_findings::Rule;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Sees: a fold without which a law cannot be fitted.
/// Matters: the error of the law on held-out data is unknown.
/// Example: a log in which one fold has the only motion.
/// Fixture: `friction/tests.rs`.
const NO_HELD_OUT: Rule = Rule::warning("no-held-out-error");

/// Errors on folds to which the law was not fitted.
#[derive(Debug, Clone)]
pub(super) struct HeldOutErrors {
    /// Sum of squared residuals Σ r² and number of samples of each fold.
    pub(super) folds: Vec<[f64; 2]>,
    /// `Σ (τ − τ̄)²` over the folds, with the torque τ and its mean τ̄.
    pub(super) total: f64,
}

impl HeldOutErrors {
    /// R² of the laws on held-out data, `1 − (RSS + more) / (Σ (τ − τ̄)² + more)`, with the residual sum of
    /// squares RSS and the torque τ with the mean τ̄; `None` if the torque never changes.
    ///
    /// - `more`: sum of squares that outliers add
    pub(super) fn r_squared(&self, more: f64) -> Option<f64> {
        let residual: f64 = self.folds.iter().map(|[residual, _]| residual).sum();
        let total = self.total + more;
        (total > 0.0).then(|| 1.0 - (residual + more) / total)
    }

    /// Mean squared error, averaged over the folds, and the standard error of the average.
    pub(super) fn error(&self) -> [f64; 2] {
        let errors = self.folds.iter().map(|[residual, samples]| residual / samples.max(1.0));
        mean_with_error(&errors.collect::<Vec<_>>())
    }
}

/// Errors of laws of terms on the folds to which the laws were not fitted. If too few data remain without a fold, the result
/// is `None`, and there is a warning.
///
/// Each run keeps the offset of all its samples, even if a part of the run is held out. An offset belongs to a run, and a law
/// cannot predict it.
///
/// - `total`: `Σ (τ − τ̄)²` over the folds, with the torque τ and its mean τ̄
/// - `selection`: method by which the terms of a law are chosen
/// - `rows`: constraints of a law
pub(super) fn held_out(
    folds: Result<Vec<Moments>>,
    total: f64,
    (selection, rows): (&Selection, Option<&DMatrix<f64>>),
    findings: &mut Findings,
) -> Option<HeldOutErrors> {
    match folds.and_then(|folds| by_folds(&folds, selection, rows)) {
        Ok(folds) => Some(HeldOutErrors { folds, total }),
        Err(reason) => {
            findings.add(NO_HELD_OUT.found(format!("R² on held-out data cannot be computed: {reason}")));
            None
        }
    }
}

/// Sum of squared residuals Σ r² and number of samples of each fold, for laws that were chosen and fitted
/// without the fold.
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

/// `Σ (τ − τ̄)²` over the samples of `ranges`, with the torque τ and its mean τ̄ over all samples.
pub(super) fn variation(data: &FrictionData, ranges: &[Range<usize>]) -> f64 {
    let mean = mean(data.torques);
    // A sample in two folds counts twice.
    ranges.iter().cloned().flatten().map(|i| (data.torques[i] - mean).powi(2)).sum()
}
