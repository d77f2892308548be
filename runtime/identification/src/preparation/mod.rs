//! Preparation of recorded runs for the regression: one even grid, one filter, no delay.
//!
//! A log has jitter, repeats, gaps, coarse encoders and late efforts. Here each signal is reduced to its informative samples
//! and put onto an even grid by cubic interpolation. It then passes one linear zero-phase filter ([`Filter`]), whose
//! derivatives give ẏ and ÿ. Efforts pass the same filter.
//!
//! The bandwidth of the filter is a compromise. It keeps the motion that the positions show above their noise, and it is
//! lower if one set of parameters then explains all efforts better. The delay of the efforts is the one at which the motion
//! explains them best.

mod band;
mod bandwidth;
mod channel;
mod check;
mod choice;
mod confirmation;
mod delay;
mod grid;
pub(crate) mod levels;
mod poses;
mod regression;
mod report;
mod rest;
mod result;
mod settings;
mod signals;
mod spectrum;
#[cfg(test)]
mod tests;
mod together;

pub use super::methods::filter::Filter;
pub(crate) use result::Delay;
pub use result::{JointPreparation, PreparationReport};
pub use settings::PreparationSettings;

use super::error::Result;
use super::robot::Robot;
use super::run::{PreparedRun, Run};

/// Prepares the runs of one robot with one filter and one set of delays. Gaps split runs.
///
/// - `robot`: the robot whose regressor is the reference for the choice of delay and bandwidth. Without a robot no delay is
///   estimated, and the bandwidth is the widest that the noise of the positions allows.
/// - returns runs with one common time step, in the order of `runs` and of time
///
/// # Errors
/// - [`Empty`](crate::IdentificationError::Empty) without runs
/// - [`Shape`](crate::IdentificationError::Shape) if lengths differ
/// - [`File`](crate::IdentificationError::File) if times do not increase
/// - [`NotFinite`](crate::IdentificationError::NotFinite) if a time is not finite
/// - [`Setting`](crate::IdentificationError::Setting) if a setting is out of its range
/// - [`Constant`](crate::IdentificationError::Constant) if no joint moves by more than its noise
/// - [`TooFewSamples`](crate::IdentificationError::TooFewSamples) if a joint has too few measured positions, or if all runs
///   are too short for the filter
pub fn prepare_all(
    runs: &[Run],
    robot: Option<&dyn Robot>,
    settings: &PreparationSettings,
) -> Result<(Vec<PreparedRun>, PreparationReport)> {
    choice::prepare_all(runs, robot, settings, None)
}

/// Prepares runs with the low-pass filter of the efforts that was found in other runs.
///
/// - `filter`: filter of the other runs
///
/// # Errors
/// The errors are those of [`prepare_all`].
pub(crate) fn prepare_as(
    runs: &[Run],
    robot: &dyn Robot,
    settings: &PreparationSettings,
    filter: &Filter,
) -> Result<(Vec<PreparedRun>, PreparationReport)> {
    choice::prepare_all(runs, Some(robot), settings, Some(filter))
}
