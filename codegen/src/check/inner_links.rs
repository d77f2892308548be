//! Checks the links between the velocities of a joint with a quaternion. These links only define the order of
//! the velocities, so no body, frame or joint may be attached to them.

use crate::description::{DriveChoice, JointDescription, Name, RobotDescription};
use crate::diagnostic::Report;
use std::collections::BTreeMap;

/// Reports bodies, frames, joints, motors and forces at a link between two velocities of a joint.
pub(super) fn refuse(robot: &RobotDescription, report: &mut Report) {
    let inner: BTreeMap<&str, &str> = robot.joints.iter().filter_map(inner_link).collect();
    for name in named_links(robot) {
        if let Some(joint) = inner.get(name.value.as_str()) {
            let message = format!("`{}` is a velocity of joint `{joint}`, not a link", name.value);
            report.error(name.span, "quaternion-joint", message).help("name the link that the joint carries");
        }
    }
}

/// Returns the link after a velocity, and the name of the joint with the quaternion; `None` for the last
/// velocity of a joint.
fn inner_link(joint: &JointDescription) -> Option<(&str, &str)> {
    let part = joint.part_of.as_ref().filter(|part| part.index + 1 < part.kind.velocities())?;
    Some((joint.child.as_ref()?.value.as_str(), part.joint.value.as_str()))
}

/// All names of links to which entries of the description refer. The references between the velocities of one
/// joint are left out.
fn named_links(robot: &RobotDescription) -> impl Iterator<Item = &Name> {
    let bodies = robot.bodies.iter().map(|body| &body.link);
    let frames = robot.frames.iter().map(|frame| &frame.link);
    bodies.chain(frames).chain(parents(robot)).chain(carriers(robot)).chain(links_of_forces(robot))
}

fn parents(robot: &RobotDescription) -> impl Iterator<Item = &Name> {
    let first = |joint: &&JointDescription| joint.part_of.as_ref().is_none_or(|part| part.index == 0);
    robot.joints.iter().filter(first).filter_map(|joint| joint.parent.as_ref())
}

/// Links that the description names as carriers of motors.
fn carriers(robot: &RobotDescription) -> impl Iterator<Item = &Name> {
    let of_joints = robot.joints.iter().filter_map(|joint| match &joint.drive.as_ref()?.value {
        DriveChoice::Motor(motor) => motor.carrier.as_ref(),
        DriveChoice::Ideal | DriveChoice::Passive => None,
    });
    of_joints.chain(robot.drives.iter().filter_map(|drive| drive.motor.carrier.as_ref()))
}

/// Links to which forces, wrenches and inputs refer instead of a frame.
fn links_of_forces(robot: &RobotDescription) -> impl Iterator<Item = &Name> {
    let is_frame = |name: &Name| robot.frames.iter().any(|frame| frame.name.value == name.value);
    robot.names_at_frames().filter(move |name| !is_frame(name))
}
