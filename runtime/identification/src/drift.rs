//! How friction and offsets change over a log: plain data.

use super::digits::with_error;
use std::ops::Range;

/// Change, as a share of the friction, that is named.
const NAMED_CHANGE: f64 = 0.02;

/// A change from the first to the last sample, linear in the number of the sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trend {
    /// Last minus first value.
    pub change: f64,
    /// Standard error, for correlated residuals.
    pub standard_error: f64,
    /// Whether chance gives such a change in less than one of a hundred logs without a trend.
    pub significant: bool,
}

/// What is left of the torque over the log.
#[derive(Debug, Clone, PartialEq)]
pub struct Drift {
    /// Runs, or parts of equal length of a single one, with the mean of torque minus law.
    pub means: Vec<(Range<usize>, f64)>,
    /// Change of the constant torque [N·m or N].
    pub offset: Trend,
    /// Change of the friction as a share of it: −0.1 where it falls by a tenth.
    pub friction: Trend,
}

impl Drift {
    /// Sentences on trends that matter.
    ///
    /// - `scale`: rms of the friction torque
    pub(crate) fn warnings(&self, unit: &str, scale: f64) -> Vec<String> {
        let mut sentences = Vec::new();
        let friction = self.friction;
        if friction.significant && friction.change.abs() > NAMED_CHANGE {
            let change = with_error(100.0 * friction.change, Some(100.0 * friction.standard_error));
            sentences.push(format!(
                "friction changes by {change} % from the beginning to the end of the log, as while warming up (or the \
                 motions differ in what the model lacks): the law is that of the middle; record after warming up, or \
                 identify the runs apart"
            ));
        }
        if self.offset.significant && self.offset.change.abs() > NAMED_CHANGE * scale {
            let change = with_error(self.offset.change, Some(self.offset.standard_error));
            sentences.push(format!("the constant torque drifts by {change} {unit} over the log"));
        }
        sentences
    }
}
