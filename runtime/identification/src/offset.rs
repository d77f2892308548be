//! A constant torque in measurements.

use std::ops::Range;

/// A constant torque beside the law.
#[derive(Debug, Clone, PartialEq)]
pub struct Offset {
    /// The run's samples.
    pub samples: Range<usize>,
    /// Mean of torque minus law [N·m or N].
    pub value: f64,
    /// Standard error for correlated residuals; `None` where the run is too short to tell.
    pub standard_error: Option<f64>,
}
