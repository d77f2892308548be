//! A load at a robot's hand, from logs without and logs with it.

use super::{Payload, PayloadSettings, estimate};
use crate::error::Result;
use crate::estimation::described_ratio;
use crate::identify::{IdentificationSettings, beyond_limits, read_and_prepare};
use crate::log::Recording;
use crate::robot::Robot;
use crate::run::PreparedRun;
use gelenk_findings::{Finding, distinct};
use std::path::PathBuf;

/// A load, and the logs that it was found from.
#[derive(Debug, Clone)]
pub struct CarriedLoad {
    /// The load.
    pub payload: Payload,
    /// The logs without and with it.
    pub recordings: [Recording; 2],
    /// Findings of the logs without the load and with it.
    pub findings: Vec<Finding>,
}

/// Reads logs without and with a load, prepares them alike, and estimates the load.
///
/// The logs with the load pass the filter of those without it, and lose the same delay.
///
/// - `progress`: takes a sentence at each step
///
/// # Errors
/// Logs that cannot be read or matched with the robot's joints, signals that are too short, values far beyond the described
/// limits, efforts by which the described bodies would be more than ten times heavier or lighter (both taken where poor
/// results are accepted), no runs of one kind, currents without described motor constants, settings out of range, or no minimum.
pub fn identify_load(
    robot: &dyn Robot,
    without: &[PathBuf],
    with: &[PathBuf],
    (settings, load): (&IdentificationSettings, &PayloadSettings),
    progress: &mut dyn FnMut(&str),
) -> Result<CarriedLoad> {
    let mut noted = Vec::new();
    match compared(robot, (without, with), (settings, load), &mut noted, progress) {
        Ok((payload, recordings)) => Ok(CarriedLoad { payload, recordings, findings: distinct(noted) }),
        Err(error) => Err(error.after(noted)),
    }
}

/// As [`identify_load`]; `noted` holds the findings.
fn compared(
    robot: &dyn Robot,
    (without, with): (&[PathBuf], &[PathBuf]),
    (settings, load): (&IdentificationSettings, &PayloadSettings),
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

/// A load changes what the bodies need, but not by as much as another unit: the logs with it are refused alone.
fn unit_doubts(
    robot: &dyn Robot,
    [without, with]: [&[PreparedRun]; 2],
    accept_poor: bool,
) -> Result<Option<Finding>> {
    let judged = |runs: &[PreparedRun]| {
        let ratio = described_ratio(robot, runs);
        ratio.map(|ratio| ratio.judged(accept_poor)).transpose().map(Option::flatten)
    };
    let doubt = judged(without)?;
    judged(with)?;
    Ok(doubt)
}
