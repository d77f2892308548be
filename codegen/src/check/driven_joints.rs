//! Checks of driven joints, whose motion is prescribed.

use super::couplings::Row;
use super::tree::Tree;
use crate::description::{DriveChoice, JointDescription, Name, RobotDescription};
use crate::diagnostic::{Report, Span};
use crate::model::{Joint, Link, Motion};

const CODE: &str = "driven-joint";

/// Reports keys that a driven joint (with a prescribed motion) must not have. Also reports joints and
/// friction that a robot with driven joints must not have.
pub(super) fn check(robot: &RobotDescription, report: &mut Report) {
    for joint in &robot.joints {
        // A joint with several velocities is reported once.
        let is_told = joint.part_of.as_ref().is_some_and(|part| part.index > 0);
        if let Some(driven) = joint.driven.as_ref().filter(|driven| driven.value && !is_told) {
            check_joint(joint, driven.span, report);
        }
    }
    let Some(first) = robot.joints.iter().find(|joint| joint.is_driven()) else { return };
    let first = &first.name.value;
    for joint in &robot.joints {
        if let Some(part) = &joint.part_of {
            let message = format!(
                "joint `{}` is {}, but joint `{first}` has `motion = \"driven\"`",
                part.joint.value,
                part.kind.name()
            );
            report.error(joint.name.span, CODE, message);
            report.help(
                "a robot cannot have both driven joints and quaternions. Describe the motion with joints of one coordinate",
            );
            break;
        }
    }
    for joint in &robot.joints {
        let load = joint.friction.as_ref().and_then(|friction| friction.value.load.as_ref());
        if let Some(load) = load {
            let message = format!(
                "joint `{}` has load-dependent friction, but joint `{first}` has `motion = \"driven\"`",
                joint.name.value
            );
            report.error(load.span, CODE, message);
            report.help("load-dependent friction requires one input per joint: remove `load`");
        }
    }
}

fn check_joint(joint: &JointDescription, span: Span, report: &mut Report) {
    let name = &joint.name.value;
    let (what, help) = if joint.part_of.is_some() {
        (
            "has a quaternion",
            "only a joint with one position can be driven. Describe the motion with several such joints",
        )
    } else if joint.held.is_some() {
        ("is held", "remove `held` or `motion = \"driven\"`")
    } else if joint.follows.is_some() {
        ("follows others", "drive the followed joints, or remove `follows`")
    } else if !joint.moves() {
        ("is fixed", "give the joint a type that moves, or remove `motion`")
    } else {
        return check_drive(joint, report);
    };
    report.error(span, CODE, format!("joint `{name}` has `motion = \"driven\"`, but {what}")).help(help);
}

fn check_drive(joint: &JointDescription, report: &mut Report) {
    let name = &joint.name.value;
    if let Some(drive) = joint.drive.as_ref().filter(|drive| !matches!(drive.value, DriveChoice::Passive)) {
        report.error(
            drive.span,
            CODE,
            format!("joint `{name}` has `motion = \"driven\"`, so it cannot have a drive"),
        );
        report.help(
            "remove `drive`, because the motion of this joint is prescribed. `driving_forces` computes the required force. \
             To keep the inertia of a rotor, add a joint that follows this joint (`follows`), and give its link this inertia",
        );
    }
    let mut limits = joint.limits.amounts().into_iter().filter_map(|(_, limit)| limit.as_ref());
    if let Some(limit) = limits.next() {
        report.note(
            Some(limit.span),
            CODE,
            format!("the motion and effort limits of driven joint `{name}` have no effect"),
        );
        report.help(
            "remove these limits. Only position limits have an effect: checks and self-tests use states within them",
        );
    }
}

/// Indices of the links that driven joints (with a prescribed motion) carry, in the order of the tree.
pub(super) fn links(robot: &RobotDescription, tree: &Tree) -> Vec<usize> {
    let joints = tree.joints.iter().enumerate();
    let driven = joints.filter(|(_, joint)| joint.is_some_and(|joint| robot.joints[joint].is_driven()));
    driven.map(|(link, _)| link).collect()
}

/// Reports a drive in `[[drives]]` that acts only on joints with prescribed motion. Its input would have no
/// effect.
pub(super) fn check_shared_drive(
    robot: &RobotDescription,
    tree: &Tree,
    name: &Name,
    row: &Row,
    links: &[Link],
    report: &mut Report,
) {
    let driven = self::links(robot, tree);
    let is_driven = |coordinate: usize| {
        let moves = |joint: &Joint| joint.motion == Motion::Coordinate(coordinate);
        driven.iter().any(|&link| links[link].joint.as_ref().is_some_and(moves))
    };
    if row.terms.iter().all(|term| is_driven(term.coordinate)) {
        report.error(name.span, CODE, format!("drive `{}` acts only on driven joints", name.value));
        report.help(
            "the motion of a driven joint is prescribed, and no input changes it. Remove the drive, or name a joint that is not driven",
        );
    }
}
