//! Report of the preparation.

use super::super::methods::filter::Filter;
use gelenk_findings::Finding;

/// Results and choices of the preparation for all runs together.
#[derive(Debug, Clone, PartialEq)]
pub struct PreparationReport {
    /// Results for each joint of the robot.
    pub joints: Vec<JointPreparation>,
    /// Delay of each effort.
    pub(crate) delays: Vec<Delay>,
    /// The filter that positions and efforts passed. Columns of the regressor pass it by `Filter::apply`.
    pub filter: Filter,
    /// Sample rate of the prepared runs \[Hz\].
    pub sample_rate: f64,
    /// Findings about changes of the signals: gaps, dropped pieces, spikes, delays.
    pub findings: Vec<Finding>,
}

/// A delay of an effort relative to the positions. Positive if the effort is late.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Delay {
    /// Removed delay \[s\]. The preparation removes a given delay, or a found one that exceeds 10 ms by two standard errors.
    /// The common estimate adds the rest of a found delay.
    pub removed: f64,
    /// Delay found for this effort in the preparation \[s\], shrunk towards the common one; NaN if the delay was given or if
    /// the effort does not show one.
    pub estimated: f64,
    /// Standard error of the delay \[s\] for correlated residuals, from the common estimate if that refined the delay,
    /// otherwise from the preparation; NaN if no delay was estimated.
    pub error: f64,
    /// Whether the effort's own delay differs significantly from the common one.
    pub own: bool,
}

/// Results and choices of the preparation for one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointPreparation {
    /// Name of the joint in the description, or `joint 1`, `joint 2`, ... without a robot.
    pub name: String,
    /// Standard deviation σ of the noise of a measured position, including rounding \[rad or m\].
    pub noise: f64,
    /// Smallest change between two measured positions \[rad or m\]. It is the resolution of the encoder if that is coarse.
    pub resolution: f64,
    /// Mean number of log rows for each new position, in the run with the largest number; 1 if each row has a new position.
    pub hold: f64,
    /// Whether the joint moves by more than ten times its noise.
    pub moves: bool,
    /// Half-amplitude frequency of the filter \[Hz\]. It is the same for all joints.
    pub bandwidth: f64,
    /// Estimated share of noise in the power of the filtered ÿ.
    pub acceleration_noise: f64,
    /// Delay that was removed from the effort with the index of this joint \[s\]. It is the given delay, or else the
    /// effort's own delay if this differs significantly from the common one, otherwise the common delay. The preparation
    /// removes a found delay only if it exceeds 10 ms by two standard errors. Otherwise the value is 0 until
    /// [`crate::identify::identify`] adds the delay of its common estimate.
    pub delay: f64,
    /// The reason for which the effort with the index of this joint cannot be used; `None` if it can be used. The columns of
    /// an unusable effort hold NaN, so that no fit uses them.
    pub fault: Option<Finding>,
}
