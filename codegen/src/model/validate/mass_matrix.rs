//! Is the mass matrix positive definite?

use super::super::description::RobotDescription;
use super::super::regularity::{Pivots, STATES};
use super::super::{Joint, Model};
use crate::diagnostic::{Report, Span};
use crate::wording::list;

/// A negative pivot is an error, unless the robot is wanted as it is; a zero one is a warning, since only
/// some functions need the inverse.
pub(super) fn check(robot: &RobotDescription, model: &Model, pivots: &Pivots, report: &mut Report) {
    let (negative, zero) = (model.joints_of(&pivots.negative), model.joints_of(&pivots.zero));
    if let Some(first) = negative.first() {
        report_indefinite(robot, place(robot, first), &negative, pivots, report);
    }
    if let Some(first) = zero.first() {
        warn_of_singular(place(robot, first), &zero, report);
    }
}

fn place(robot: &RobotDescription, joint: &Joint) -> Span {
    let mut names = robot.joints.iter().map(|joint| &joint.name);
    let name = names.find(|name| name.value == joint.name);
    name.unwrap_or(&robot.name).span
}

fn report_indefinite(
    robot: &RobotDescription,
    span: Span,
    joints: &[&Joint],
    pivots: &Pivots,
    report: &mut Report,
) {
    const CODE: &str = "mass-matrix-not-positive-definite";
    let message = format!(
        "the mass matrix is not positive definite at {} of {STATES} seeded states: forces can accelerate {} backwards",
        pivots.indefinite_states,
        list(joints.iter().map(|joint| joint.name.as_str())),
    );
    if robot.accept_unphysical {
        report.warning(span, CODE, message);
        return;
    }
    report.error(span, CODE, message);
    report.help(
        "mend the bodies that these joints move, or take the model as it is: `--accept-unphysical`, or \
         `accept_unphysical = true` at the top of a TOML file",
    );
}

fn warn_of_singular(span: Span, joints: &[&Joint], report: &mut Report) {
    let message = format!(
        "the mass matrix is singular: nothing that has inertia moves with {}",
        list(joints.iter().map(|joint| joint.name.as_str()))
    );
    report.warning(span, "joints-without-inertia", message);
    report.help(
        "give the links that move there mass or inertia, give the drives a rotor inertia, or make the joints fixed or held",
    );
}
