//! A load at a robot's hand, from logs without and logs with it.

use super::error::Result;
use super::identify::{IdentificationSettings, read_and_prepare};
use super::inertial::payload::{Payload, PayloadSettings, estimate};
use super::log::Recording;
use super::preparation::PreparationSettings;
use super::robot::Robot;
use std::path::PathBuf;

/// A load, and the logs that it was found from.
#[derive(Debug, Clone)]
pub struct CarriedLoad {
    /// The load.
    pub payload: Payload,
    /// The logs without and with it.
    pub recordings: [Recording; 2],
    /// What was noticed in the signals, as sentences.
    pub notes: Vec<String>,
}

/// Reads logs without and with a load, prepares them alike, and estimates the load.
///
/// The logs with the load pass the filter of those without it, and lose the same delay.
///
/// - `progress`: takes a sentence at each step
///
/// # Errors
/// Logs that cannot be read or matched with the robot's joints, signals that are too short, and what
/// [`estimate`] refuses.
pub fn identify_load(
    robot: &dyn Robot,
    without: &[PathBuf],
    with: &[PathBuf],
    (settings, load): (&IdentificationSettings, &PayloadSettings),
    progress: &mut dyn FnMut(&str),
) -> Result<CarriedLoad> {
    let (empty, runs_without, report) = read_and_prepare(robot, without, settings, progress)?;
    let joint = report.joints.first();
    let preparation = PreparationSettings {
        bandwidth: joint.map(|joint| joint.bandwidth),
        rate: joint.map(|joint| joint.sample_rate),
        delay: joint.map(|joint| joint.delay),
        ..settings.preparation.clone()
    };
    let alike = IdentificationSettings { preparation, ..settings.clone() };
    let (loaded, runs_with, _) = read_and_prepare(robot, with, &alike, progress)?;
    progress("comparing the logs without and with the load");
    let payload = estimate(robot, &runs_without, &runs_with, load)?;
    Ok(CarriedLoad { payload, recordings: [empty, loaded], notes: report.notes })
}
