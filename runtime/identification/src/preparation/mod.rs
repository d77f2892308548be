//! Preparation of recorded runs for the regression: one even grid, one filter, no delay.
//!
//! A log comes with jitter, repeats, gaps, coarse encoders and efforts that are late. Here each signal is
//! reduced to its informative samples, put onto an even grid by cubic interpolation, and passed
//! through one linear zero-phase filter ([`Filter`]), whose derivatives give ẏ and ÿ. Efforts pass through the same
//! filter. Its bandwidth is the least that keeps what the positions show above their noise and what helps to
//! explain the efforts, all of them by one set of parameters; the delay of the efforts is the one at which the motion
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
    choice::prepare_all(runs, robot, settings, None)
}

/// Prepares runs with the filters of the efforts of other runs.
///
/// - `filter`: of the other runs
///
/// # Errors
/// As [`prepare_all`].
pub(crate) fn prepare_as(
    runs: &[Run],
    robot: &dyn Robot,
    settings: &PreparationSettings,
    filter: &Filter,
) -> Result<(Vec<PreparedRun>, PreparationReport)> {
    choice::prepare_all(runs, Some(robot), settings, Some(filter))
}
