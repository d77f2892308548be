//! Results of the preparation.

use super::super::methods::filter::Filter;
use gelenk_findings::Finding;

/// Results and choices of the preparation for all runs.
#[derive(Debug, Clone, PartialEq)]
pub struct PreparationReport {
    /// Results for each joint of the robot.
    pub joints: Vec<JointPreparation>,
    /// Delay of each effort relative to the positions.
    pub(crate) delays: Vec<Delay>,
    /// Filter that positions and efforts passed. In a regression, the columns of friction must pass this filter, too
    /// (`Filter::apply`).
    pub filter: Filter,
    /// Sample rate of the prepared runs in Hz.
    pub sample_rate: f64,
    /// Findings about the signals, for example about gaps, removed samples, removed delays and noise.
    pub findings: Vec<Finding>,
}

/// Delay of an effort relative to the positions. It is positive if the effort is late.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Delay {
    /// Removed delay in s. The preparation removes a given delay, or an estimated delay that exceeds 10 ms by two standard
    /// errors. The common estimate adds the rest of an estimated delay.
    pub removed: f64,
    /// Standard error of the delay in s for correlated residuals. It comes from the common estimate if this refined the
    /// delay, otherwise from the preparation. NaN if no delay was estimated.
    pub error: f64,
    /// Whether the delay of this effort differs significantly from the common delay.
    pub own: bool,
}

/// Results and choices of the preparation for one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointPreparation {
    /// Name of the joint in the description. Without a robot it is `joint 1`, `joint 2`, …
    pub name: String,
    /// Standard deviation σ of the noise of a measured position in rad or m, including rounding.
    pub noise: f64,
    /// Smallest change between two measured positions in rad or m. For a coarse encoder it is the resolution.
    pub resolution: f64,
    /// Whether the joint moves by more than ten times its noise.
    pub moves: bool,
    /// Half-amplitude frequency of the filter in Hz. It is the same for all joints.
    pub bandwidth: f64,
    /// Estimated share of noise in the power (mean square) of the filtered acceleration ÿ.
    pub acceleration_noise: f64,
    /// Removed delay in s of the effort whose index is that of this joint. It is the first of these delays that applies:
    ///
    /// - the given delay
    /// - the delay of this effort, if it differs significantly from the common delay
    /// - the common delay
    ///
    /// The preparation removes an estimated delay only if it exceeds 10 ms by two standard errors. Otherwise the value is 0
    /// until [`crate::identify::identify`] adds the delay of its common estimate.
    pub delay: f64,
    /// Reason why the effort whose index is that of this joint cannot be used; `None` if it can be used. The columns of an
    /// unusable effort contain NaN, so that no fit uses them.
    pub fault: Option<Finding>,
}
