//! Test whether the efforts contain the robot's weight.

use super::super::error::Result;
use super::result::Gravity;
use super::trial::{Bodies, Case, Change, Hypothesis};
use gelenk_findings::{Finding, Rule};

/// Sees: efforts that fit better without gravity, or with gravity although the settings say that it is compensated.
/// Matters: the masses are wrong.
/// Example: a driver that reports torques without the weight, as UR's ROS 2 driver does.
/// Fixture: `without_gravity` in `codegen/tests/findings/arm.rs`.
const GRAVITY: Rule = Rule::error("other-gravity");

pub(super) const OTHER_GRAVITY: Hypothesis = Hypothesis {
    bodies: Bodies::Described,
    // If described bodies are too heavy or efforts are in a larger unit, the data are also better explained without gravity.
    rival: |case| case.ratio.map(|ratio| Change::Factor(None, 1.0 / ratio.factor)),
    ..Hypothesis::of(
        GRAVITY,
        |case| Ok(vec![Change::Gravity(Gravity::of(!is_compensated(case)))]),
        other_gravity,
    )
};

/// Whether the robot compensates gravity outside the efforts, as the settings say.
fn is_compensated(case: &Case) -> bool {
    case.checked.is_some_and(|checked| checked.task.settings.gravity_compensated)
}

fn other_gravity(case: &Case, _: &Change, rule: &Rule) -> Result<Option<Finding>> {
    let (what, remedy) = if case.layout().exact.contains(&true) {
        (
            "without",
            "check that the vertical axis of the log is that of the description, and check the order of the quaternion's entries",
        )
    } else if is_compensated(case) {
        ("with", "leave out --gravity-compensated: the efforts seem to contain the weight")
    } else {
        (
            "without",
            "use --gravity-compensated if the robot compensates gravity outside the recorded efforts. If it is not mounted as \
             described, for example on a wall or a ceiling, set `gravity = [x, y, z]`",
        )
    };
    Ok(Some(rule.found(format!("the data are explained better {what} gravity")).help(remedy)))
}
