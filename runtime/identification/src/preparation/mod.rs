//! Preparation of recorded runs for the regression: one even grid, one filter, no delay.
//!
//! A log comes with jitter, repeats, gaps, coarse encoders and efforts that are late. Here each signal is
//! reduced to its informative samples, put onto an even grid by cubic interpolation, and passed
//! through one linear zero-phase filter ([`Filter`]), whose derivatives give ẏ and ÿ. Efforts pass through the same
//! filter. Its bandwidth is the least that keeps what the positions show above their noise and what helps to
//! explain the efforts; the delay of the efforts is the one at which the motion explains them best.

mod bandwidth;
mod channel;
mod check;
mod choice;
mod delay;
mod filter;
mod grid;
mod poses;
mod regression;
mod report;
mod signals;
mod spectrum;
#[cfg(test)]
mod study;

pub use filter::Filter;

use super::error::{IdentificationError, Result};
use super::robot::Robot;
use super::run::{PreparedRun, Run};

/// Choices of the preparation; each is found from the data where it is `None`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PreparationSettings {
    /// Half-amplitude frequency of the filter \[Hz\].
    pub bandwidth: Option<f64>,
    /// Sample rate of the prepared runs \[Hz\]; by itself ten times the bandwidth, at most that of the log.
    pub rate: Option<f64>,
    /// Longest pause between samples that is interpolated \[s\]; a longer one splits the run. By itself a
    /// fifth of the bandwidth's period, at least three steps of the log.
    pub largest_gap: Option<f64>,
    /// How much later efforts are than positions \[s\]; 0 leaves them as they are.
    pub delay: Option<f64>,
    /// Time cut off at either end of a piece \[s\], where the filter sees one side only; by itself one period of
    /// the bandwidth.
    pub cut: Option<f64>,
}

/// A single prepared run.
#[derive(Debug, Clone, PartialEq)]
pub struct Prepared {
    /// The run on an even grid, smoothed.
    pub run: PreparedRun,
    /// What was found and chosen, for each joint.
    pub joints: Vec<JointPreparation>,
    /// The filter that everything passed.
    pub filter: Filter,
}

/// What was found and chosen for all runs together.
#[derive(Debug, Clone, PartialEq)]
pub struct PreparationReport {
    /// For each joint.
    pub joints: Vec<JointPreparation>,
    /// Delay of each effort that was removed \[s\], and its standard error.
    pub delays: Vec<Delay>,
    /// The filter that positions and efforts passed; regressor columns pass it by [`Filter::apply`].
    pub filter: Filter,
    /// Sample rate of the prepared runs \[Hz\].
    pub sample_rate: f64,
    /// Sentences on what was done: gaps, dropped pieces, spikes, delays.
    pub notes: Vec<String>,
}

/// A delay of an effort after the positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delay {
    /// Removed delay \[s\]; 0 where none is significant.
    pub removed: f64,
    /// Delay as estimated for this effort alone \[s\]; NaN if it was given or cannot be seen.
    pub estimated: f64,
    /// Standard error of the estimate \[s\], for correlated residuals; NaN if there is no estimate.
    pub error: f64,
    /// Whether the effort has a delay of its own, which differs from the common one significantly.
    pub own: bool,
}

/// What was found and chosen for a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointPreparation {
    /// Name as described, or `joint 1` and so on.
    pub name: String,
    /// Standard deviation of a position's noise σ, rounding included \[rad or m\].
    pub noise: f64,
    /// Smallest change between two positions \[rad or m\]: the encoder's resolution where it is coarse.
    pub resolution: f64,
    /// Rows of the log for each new position; 1 where each is new.
    pub hold: f64,
    /// Whether the joint moves by more than its noise.
    pub moves: bool,
    /// Half-amplitude frequency of the filter \[Hz\], the same for all joints.
    pub bandwidth: f64,
    /// The bandwidth that this joint's positions alone ask for \[Hz\]; `None` at rest.
    pub own_bandwidth: Option<f64>,
    /// Estimated share of noise in the power of ÿ.
    pub acceleration_noise: f64,
    /// Removed delay of the effort with the joint's number \[s\]; the common one if there is none.
    pub delay: f64,
    /// Sample rate \[Hz\].
    pub sample_rate: f64,
    /// Comparison with measured velocities, where the log has them.
    pub velocity: Option<VelocityCheck>,
    /// Why the effort with the joint's number is not usable: its columns hold NaN, so that no fit takes it for
    /// measured. `None` if all is well.
    pub fault: Option<String>,
}

/// Measured velocities against the derivative of the positions, through the same filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityCheck {
    /// Factor between them, near 1: measured = gain · derived.
    pub gain: f64,
    /// Share of the measured velocity's variance that the derived one explains.
    pub r_squared: f64,
}

/// Prepares one run without gaps, without a robot's regressor.
///
/// # Errors
/// As [`prepare_all`], and a run that a gap splits.
pub fn prepare(run: &Run, settings: &PreparationSettings) -> Result<Prepared> {
    let (mut runs, report) = prepare_all(std::slice::from_ref(run), None, settings)?;
    match (runs.pop(), runs.is_empty()) {
        (Some(run), true) => Ok(Prepared { run, joints: report.joints, filter: report.filter }),
        _ => Err(IdentificationError::Shape {
            what: format!("pieces of run {} without a gap (`prepare_all` returns all of them)", run.name),
            expected: 1,
            got: runs.len() + 1,
        }),
    }
}

/// Prepares runs of one robot by one filter and one set of delays; gaps split runs.
///
/// - `robot`: its regressor judges delay and bandwidth; without it no delay is estimated, and the bandwidth is
///   the widest that the positions' noise allows
/// - returns runs with one common time step, in the order of `runs` and of time
///
/// # Errors
/// No runs, lengths that differ, times that do not increase, a joint without measured positions, settings out of
/// range, or runs that are all too short for the filter.
pub fn prepare_all(
    runs: &[Run],
    robot: Option<&dyn Robot>,
    settings: &PreparationSettings,
) -> Result<(Vec<PreparedRun>, PreparationReport)> {
    choice::prepare_all(runs, robot, settings)
}
