//! Checks of runs and settings before the preparation.

use super::super::error::{Result, at, require_finite, require_length, require_samples, require_setting};
use super::super::robot::Robot;
use super::super::run::{Effort, FEWEST_SAMPLES, Run};
use super::settings::PreparationSettings;
use gelenk_findings::{Finding, Rule};

/// Sees: an effort that has no values in more than half of the rows, or the same value in all rows.
/// Matters: the effort is not used, and the joint stays as described.
/// Example: a column of zeros.
/// Fixture: `dead` in `codegen/tests/findings/arm.rs`.
const UNUSABLE_EFFORT: Rule = Rule::warning("unusable-effort");

/// Returns the reason why an effort cannot be used; `None` if it can be used.
///
/// - `m`: index of the effort
/// - `exact`: whether the effort is a force that is known without a sensor. Such a force is zero if nothing acts.
pub(super) fn effort_fault(runs: &[Run], m: usize, exact: bool) -> Option<Finding> {
    let fault = |message| UNUSABLE_EFFORT.found(message).help("name other columns with --columns 'torque=…'");
    let values = || runs.iter().flat_map(|r| r.efforts[m].iter().zip(&r.rows));
    let finite = values().filter(|(u, _)| u.is_finite()).count();
    let row = runs.first().and_then(|r| r.rows.first()).copied().unwrap_or(0);
    if 2 * finite < values().count() {
        let first = values().find(|(u, _)| !u.is_finite()).map_or(row, |(_, row)| *row);
        return Some(fault(format!(
            "more than half of its efforts are missing. The first missing one is in row {first}"
        )));
    }
    let mut all = values().filter(|(u, _)| u.is_finite()).map(|(u, _)| *u);
    let first = all.next().filter(|_| !exact)?;
    all.all(|u| u == first).then(|| fault(format!("its effort is {first} in every row from row {row} on")))
}

/// Checks that the lengths of columns agree, that times increase, and that settings are within their ranges.
pub(super) fn check(runs: &[Run], robot: Option<&dyn Robot>, settings: &PreparationSettings) -> Result<()> {
    require_samples("the list of runs", 1, runs.len())?;
    let settings_delay = settings.delay;
    let settings = [
        ("bandwidth", settings.bandwidth, false),
        ("rate", settings.rate, false),
        ("largest_gap", settings.largest_gap, false),
        ("cut", settings.cut, true),
    ];
    for (name, value, zero) in settings {
        let holds = value.is_none_or(|x| x > 0.0 || zero && x == 0.0);
        require_setting(name, value.unwrap_or(0.0), holds, "it must be positive")?;
    }
    let delay = settings_delay.unwrap_or(0.0);
    require_setting("delay", delay, delay.abs() <= 1.0, "it must lie between -1 s and 1 s")?;
    let (joints, efforts) = (runs[0].positions.len(), runs[0].efforts.len());
    if let Some(robot) = robot {
        require_length("joints of the log and the robot", robot.joint_names().len(), joints)?;
        let quaternions = robot.quaternion_joints().len();
        let entries = if quaternions > 0 { joints + quaternions } else { 0 };
        for run in runs {
            require_length(&format!("columns of poses of run {}", run.name), entries, run.poses.len())?;
        }
        let expected = if runs[0].effort == Effort::Joint { joints } else { robot.input_names().len() };
        require_length("efforts of the log and the robot", expected, efforts)?;
    }
    runs.iter().try_for_each(|run| check_run(run, joints, efforts))
}

fn check_run(run: &Run, joints: usize, efforts: usize) -> Result<()> {
    let m = run.times.len();
    require_samples(&format!("run {}", run.name), FEWEST_SAMPLES, m)?;
    require_length(&format!("joints of run {}", run.name), joints, run.positions.len())?;
    require_length(&format!("velocities of run {}", run.name), joints, run.velocities.len())?;
    require_length(&format!("efforts of run {}", run.name), efforts, run.efforts.len())?;
    require_length(&format!("rows of run {}", run.name), m, run.rows.len())?;
    require_finite(&format!("the time of run {}", run.name), &run.times)?;
    if let Some(i) = run.times.windows(2).position(|t| t[1] <= t[0]) {
        let (before, after) = (run.times[i], run.times[i + 1]);
        return Err(at(&run.name).row(run.rows[i + 1]).fault(format!(
            "the time does not increase: {before} s is followed by {after} s. Sort the rows"
        )));
    }
    for (j, column) in run.positions.iter().enumerate() {
        require_length(&format!("positions of joint {} in run {}", j + 1, run.name), m, column.len())?;
        let finite = column.iter().filter(|y| y.is_finite()).count();
        require_samples(
            &format!("the measured position of joint {} in run {}", j + 1, run.name),
            FEWEST_SAMPLES,
            finite,
        )?;
    }
    let others = run.velocities.iter().flatten().chain(&run.efforts).chain(&run.poses);
    for column in others {
        require_length(&format!("samples of run {}", run.name), m, column.len())?;
    }
    Ok(())
}
