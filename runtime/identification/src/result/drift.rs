//! Changes of friction and offsets in the course of a log.

use gelenk_findings::digits::with_error;
use gelenk_findings::{Finding, Rule};

/// Sees: an offset that changes from the beginning to the end of the logs.
/// Matters: a constant cannot describe the offset of the sensor.
/// Example: a torque sensor that warms up.
/// Fixture: `warming_up` in `codegen/tests/findings/arm.rs`.
const OFFSET_DRIFTS: Rule = Rule::warning("offset-drifts");

/// Sees: friction that changes from the beginning to the end of the logs.
/// Matters: the law is an average, which is wrong at the beginning and at the end.
/// Example: grease that warms up.
/// Fixture: `drift_is_shown_where_it_is_there` in `friction/tests.rs`.
const FRICTION_DRIFTS: Rule = Rule::warning("friction-drifts");

/// Smallest change of friction that gives a finding, as a share of the friction.
const NAMED_CHANGE: f64 = 0.02;

/// Linear change of a quantity from the first to the last sample, over the index of the sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Trend {
    /// Last minus first value of the linear trend.
    pub(crate) change: f64,
    /// Standard error of the change, which takes the correlation of the residuals into account.
    pub(crate) standard_error: f64,
    /// Whether the change is significant at the 1 % level.
    pub(crate) significant: bool,
}

/// Trends of the residual torque over the log.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Drift {
    /// Change of the constant torque, in N·m or N.
    pub(crate) offset: Trend,
    /// Change of the friction as a share of the friction. For example, −0.1 means that friction falls by a tenth.
    pub(crate) friction: Trend,
}

impl Drift {
    /// Returns findings about trends that are significant and large enough.
    ///
    /// - `unit`: unit of the torque
    /// - `scale`: rms of the friction torque
    pub(crate) fn findings(&self, unit: &str, scale: f64) -> Vec<Finding> {
        let friction = self.friction;
        let is_named = friction.significant && friction.change.abs() > NAMED_CHANGE;
        let of_friction = is_named.then(|| {
            let change = with_error(100.0 * friction.change, Some(100.0 * friction.standard_error));
            let message = format!(
                "friction changes by {change} % over the log, so the law is an average. Friction may fall while the joint warms \
                 up, or the model lacks a term"
            );
            FRICTION_DRIFTS.found(message).help("record after the joint has warmed up, or identify each run separately")
        });
        let is_named = self.offset.significant && self.offset.change.abs() > NAMED_CHANGE * scale;
        let of_offset = is_named.then(|| {
            let change = with_error(self.offset.change, Some(self.offset.standard_error));
            OFFSET_DRIFTS.found(format!("the constant torque drifts by {change} {unit} over the log"))
        });
        of_friction.into_iter().chain(of_offset).collect()
    }
}
