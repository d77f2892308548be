//! Prepared runs, and findings.

use super::super::methods::filter::Filter;
use gelenk_findings::Finding;

/// Results and choices for all runs together.
#[derive(Debug, Clone, PartialEq)]
pub struct PreparationReport {
    /// For each joint.
    pub joints: Vec<JointPreparation>,
    /// Delay of each effort that was removed \[s\], and its standard error.
    pub(crate) delays: Vec<Delay>,
    /// The filter that positions and efforts passed; regressor columns pass it by `Filter::apply`.
    pub filter: Filter,
    /// Sample rate of the prepared runs \[Hz\].
    pub sample_rate: f64,
    /// Changes to the signals: gaps, dropped pieces, spikes, delays.
    pub findings: Vec<Finding>,
}

/// A delay of an effort after the positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Delay {
    /// Removed delay \[s\]. The preparation removes those of 10 ms or more; the common estimate adds the rest.
    pub removed: f64,
    /// Delay as estimated for this effort alone \[s\]; NaN if it was given or cannot be seen.
    pub estimated: f64,
    /// Standard error of the estimate \[s\], for correlated residuals; of the common one where this made it. NaN if there is no
    /// estimate.
    pub error: f64,
    /// Whether the effort has a delay of its own, which differs from the common one significantly.
    pub own: bool,
}

/// Results and choices for one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointPreparation {
    /// Name as described, or `joint 1` and so on.
    pub name: String,
    /// Standard deviation of a position's noise σ, rounding included \[rad or m\].
    pub noise: f64,
    /// Smallest change between two positions \[rad or m\]: the encoder's resolution where it is coarse.
    pub resolution: f64,
    /// Rows of the log for each new position; 1 if each is new.
    pub hold: f64,
    /// Whether the joint moves by more than its noise.
    pub moves: bool,
    /// Half-amplitude frequency of the filter \[Hz\], the same for all joints.
    pub bandwidth: f64,
    /// Estimated share of noise in the power of ÿ.
    pub acceleration_noise: f64,
    /// Removed delay of the effort with the joint's number \[s\]; the common one if there is none.
    pub delay: f64,
    /// Why the effort with the joint's number is not usable: its columns hold NaN, so that no fit takes it for
    /// measured. `None` if all is well.
    pub fault: Option<Finding>,
}
