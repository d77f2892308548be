//! Identification of a load at a robot's hand from logs without and with the load.

use super::{Payload, PayloadSettings, estimate};
use crate::error::Result;
use crate::estimation::described_ratio;
use crate::identify::{IdentificationSettings, beyond_limits, read_and_prepare};
use crate::log::Recording;
use crate::robot::Robot;
use crate::run::PreparedRun;
use gelenk_findings::{Finding, distinct};
use std::path::PathBuf;

/// A load, and the logs from which it was identified.
#[derive(Debug, Clone)]
pub struct CarriedLoad {
    /// The identified load.
    pub payload: Payload,
    /// The logs without the load, and the logs with the load.
    pub recordings: [Recording; 2],
    /// Findings about the logs without the load and with the load.
    pub findings: Vec<Finding>,
}

/// Reads logs without and with a load, prepares them in the same way, and estimates the load.
///
/// The logs with the load pass the filter of the logs without the load, and the same delay is removed.
///
/// - `without`, `with`: logs without the load, and logs with the load
/// - `progress`: receives a sentence at each step
///
/// # Errors
/// The call fails if
/// - logs cannot be read or do not match the robot's joints,
/// - there are no runs with the load or no runs without it, or signals are too short,
/// - efforts are currents without described motor constants,
/// - a setting is out of its range, or
/// - no minimum is found.
///
/// Unless poor results are accepted, the call also fails in two cases: values are far beyond the described
/// limits, or the forces in the efforts differ from those of the described bodies by more than a factor of
/// ten.
pub fn identify_load(
    robot: &dyn Robot,
    without: &[PathBuf],
    with: &[PathBuf],
    settings: &IdentificationSettings,
    load: &PayloadSettings,
    progress: &mut dyn FnMut(&str),
) -> Result<CarriedLoad> {
    let mut noted = Vec::new();
    match compared(robot, without, with, settings, load, &mut noted, progress) {
        Ok((payload, recordings)) => Ok(CarriedLoad { payload, recordings, findings: distinct(noted) }),
        Err(error) => Err(error.after(noted)),
    }
}

/// Identifies the load as [`identify_load`] does, but without adding the earlier findings to errors.
///
/// - `noted`: receives the findings
fn compared(
    robot: &dyn Robot,
    without: &[PathBuf],
    with: &[PathBuf],
    settings: &IdentificationSettings,
    load: &PayloadSettings,
    noted: &mut Vec<Finding>,
    progress: &mut dyn FnMut(&str),
) -> Result<(Payload, [Recording; 2])> {
    let (empty, runs_without, report) = read_and_prepare(robot, without, settings, noted, progress)?;
    let preparation = report.settings_alike(&settings.preparation);
    let alike = IdentificationSettings { preparation, ..settings.clone() };
    let (loaded, runs_with, _) = read_and_prepare(robot, with, &alike, noted, progress)?;
    noted.extend(beyond_limits(robot, &empty, &runs_without, settings.accept_poor)?);
    noted.extend(beyond_limits(robot, &loaded, &runs_with, settings.accept_poor)?);
    noted.extend(unit_doubts(robot, [&runs_without, &runs_with], settings.accept_poor)?);
    progress("comparing the logs without and with the load");
    let payload = estimate(robot, &runs_without, &runs_with, load)?;
    noted.extend(payload.findings.iter().cloned());
    Ok((payload, [empty, loaded]))
}

/// The doubt about the unit of the efforts in the logs without the load. The logs with the load can only be refused: they
/// give no warning, because a load also changes the forces, although less than another unit does.
fn unit_doubts(
    robot: &dyn Robot,
    [without, with]: [&[PreparedRun]; 2],
    accept_poor: bool,
) -> Result<Option<Finding>> {
    let judged = |runs: &[PreparedRun]| {
        let ratio = described_ratio(robot, runs);
        ratio.map(|ratio| ratio.judged(accept_poor, || Ok(None))).transpose().map(Option::flatten)
    };
    let doubt = judged(without)?;
    judged(with)?;
    Ok(doubt)
}
