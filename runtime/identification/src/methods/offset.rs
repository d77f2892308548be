//! Constant torques in measurements, and their elimination from columns.

use std::ops::Range;

/// Constant torque of one run (offset of the sensor or error of the modelled gravity), in addition to the friction law.
#[derive(Debug, Clone, PartialEq)]
pub struct Offset {
    /// Indices of the run's samples among the samples of all runs.
    pub samples: Range<usize>,
    /// Mean of the difference between torque and law, in N·m or N.
    pub value: f64,
    /// Standard error for correlated residuals, in N·m or N; `None` if the run is too short for an estimate.
    pub standard_error: Option<f64>,
}

/// Subtracts from each run of a column the mean of the run.
pub(crate) fn centre(column: &mut [f64], runs: &[Range<usize>]) {
    for rows in runs {
        let mean = mean(&column[rows.clone()]);
        column[rows.clone()].iter_mut().for_each(|x| *x -= mean);
    }
}

pub(crate) fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}
