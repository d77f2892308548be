//! Preparation of recorded runs for the regression: signals at equal time steps, smoothed by one filter, without delays.
//!
//! A log has jitter, repeated values, gaps, coarse encoders and late efforts. Here each signal is reduced to its
//! informative samples, which are interpolated by cubics at equal time steps. All signals then pass the same linear
//! zero-phase filter ([`Filter`]). The derivatives of the filter give the velocities ẏ and the accelerations ÿ.
//!
//! The bandwidth of the filter is a compromise. The filter keeps the motion that the positions show above their noise.
//! However, the bandwidth is lower if one set of parameters then explains all efforts better. The delay of the efforts is
//! the delay at which the motion explains the efforts best.

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

/// Prepares the runs of one robot with one filter and one set of delays. Runs are split at gaps. Returns the prepared runs in
/// the order of `runs` and of time, and a report. All prepared runs have the same time step.
///
/// - `robot`: robot whose regressor helps to choose delay and bandwidth. If it is `None`, no delay is estimated, and the
///   bandwidth is the largest bandwidth that the noise of the positions allows.
///
/// # Errors
/// - [`Empty`](crate::IdentificationError::Empty): there are no runs
/// - [`Shape`](crate::IdentificationError::Shape): lengths differ
/// - [`File`](crate::IdentificationError::File): times do not increase
/// - [`NotFinite`](crate::IdentificationError::NotFinite): a time is not finite
/// - [`Setting`](crate::IdentificationError::Setting): a setting is out of its range
/// - [`Constant`](crate::IdentificationError::Constant): no joint moves by more than its noise
/// - [`TooFewSamples`](crate::IdentificationError::TooFewSamples): a joint has too few measured positions, or all runs are
///   too short for the filter
pub fn prepare_all(
    runs: &[Run],
    robot: Option<&dyn Robot>,
    settings: &PreparationSettings,
) -> Result<(Vec<PreparedRun>, PreparationReport)> {
    choice::prepare_all(runs, robot, settings, None)
}

/// Prepares runs with the low-pass filter of the efforts that was found for other runs.
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
