//! Constant torques in measurements, and columns without them.

use std::ops::Range;

/// A constant torque in addition to the law.
#[derive(Debug, Clone, PartialEq)]
pub struct Offset {
    /// The run's samples.
    pub samples: Range<usize>,
    /// Mean of torque minus law [N·m or N].
    pub value: f64,
    /// Standard error for correlated residuals; `None` if the run is too short to tell.
    pub standard_error: Option<f64>,
}

/// Takes its (weighted) mean off each run of a column.
pub(crate) fn centre(column: &mut [f64], runs: &[Range<usize>], weights: Option<&[f64]>) {
    for rows in runs {
        let mean = mean(&column[rows.clone()], weights.map(|w| &w[rows.clone()]));
        column[rows.clone()].iter_mut().for_each(|x| *x -= mean);
    }
}

/// The (weighted) mean; zero if all weights are.
pub(crate) fn mean(x: &[f64], weights: Option<&[f64]>) -> f64 {
    let Some(weights) = weights else {
        return x.iter().sum::<f64>() / x.len() as f64;
    };
    let total: f64 = weights.iter().sum();
    let sum: f64 = x.iter().zip(weights).map(|(x, w)| x * w).sum();
    if total > 0.0 { sum / total } else { 0.0 }
}
