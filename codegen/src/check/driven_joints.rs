//! Keys of joints whose motion is prescribed.

use super::couplings::Row;
use super::tree::Tree;
use crate::description::{DriveChoice, JointDescription, Name, RobotDescription};
use crate::diagnostic::{Report, Span};
use crate::model::{Joint, Link, Motion};

const CODE: &str = "driven-joint";

/// Reports keys without meaning at a joint whose motion is prescribed, and in robots that have one.
pub(super) fn check(robot: &RobotDescription, report: &mut Report) {
    for joint in &robot.joints {
        // The velocities of one joint are told once.
        let is_told = joint.part_of.as_ref().is_some_and(|part| part.index > 0);
        if let Some(driven) = joint.driven.as_ref().filter(|driven| driven.value && !is_told) {
            check_joint(joint, driven.span, report);
        }
    }
    let Some(first) = robot.joints.iter().find(|joint| joint.is_driven()) else { return };
    let first = &first.name.value;
    for joint in &robot.joints {
        if let Some(part) = &joint.part_of {
            let message =
                format!("`{}` is {}, and joint `{first}` is driven", part.joint.value, part.kind.name());
            report.error(joint.name.span, CODE, message);
            report.help("driven joints and quaternions in one robot are not supported: describe the motion by joints of one coordinate");
            break;
        }
    }
    for joint in &robot.joints {
        let load = joint.friction.as_ref().and_then(|friction| friction.value.load.as_ref());
        if let Some(load) = load {
            let message = format!(
                "joint `{}` has friction that grows with its load, and joint `{first}` is driven",
                joint.name.value
            );
            report.error(load.span, CODE, message);
            report.help(
                "a joint's load is known only if every joint has an input of its own: leave `load` out",
            );
        }
    }
}

fn check_joint(joint: &JointDescription, span: Span, report: &mut Report) {
    let name = &joint.name.value;
    let (what, help) = if joint.part_of.is_some() {
        (
            "has a quaternion",
            "only joints with one position are driven: describe the motion by several of them",
        )
    } else if joint.held.is_some() {
        ("is held", "keep one of `held` and `motion = \"driven\"`")
    } else if joint.follows.is_some() {
        ("follows others", "drive the joints that it follows, or remove `follows`")
    } else if !joint.moves() {
        ("is fixed", "give it a type that moves, or remove `motion`")
    } else {
        return check_drive(joint, report);
    };
    report.error(span, CODE, format!("joint `{name}` is driven and {what}")).help(help);
}

fn check_drive(joint: &JointDescription, report: &mut Report) {
    let name = &joint.name.value;
    if let Some(drive) = joint.drive.as_ref().filter(|drive| !matches!(drive.value, DriveChoice::Passive)) {
        report.error(drive.span, CODE, format!("joint `{name}` is driven and has a drive"));
        report.help(
            "its motion is an argument, no input changes it: leave `drive` out. The force that the motion needs is \
             `driving_forces`, and a rotor is a body that follows the joint",
        );
    }
    let mut limits = joint.limits.amounts().into_iter().filter_map(|(_, limit)| limit.as_ref());
    if let Some(limit) = limits.next() {
        report.note(
            Some(limit.span),
            CODE,
            format!("nothing limits the motion and effort of joint `{name}`, which is driven"),
        );
        report.help(
            "only its position limits have an effect: the seeded states of checks and self-tests keep them",
        );
    }
}

/// Link indices of the joints whose motion is prescribed, in the order of the tree.
pub(super) fn links(robot: &RobotDescription, tree: &Tree) -> Vec<usize> {
    let joints = tree.joints.iter().enumerate();
    let driven = joints.filter(|(_, joint)| joint.is_some_and(|joint| robot.joints[joint].is_driven()));
    driven.map(|(link, _)| link).collect()
}

/// Reports a drive on driven joints alone, which would be an input without effect.
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
        report.error(name.span, CODE, format!("drive `{}` acts on driven joints alone", name.value));
        report.help(
            "their motion is an argument, no input changes it: leave the drive out, or name a joint that is free",
        );
    }
}
