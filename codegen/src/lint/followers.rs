//! Joints that follow the joint carrying them and cancel its motion.

use nalgebra::Vector3;

use super::levers::ROUNDING;
use crate::description::RobotDescription;
use crate::diagnostic::Report;
use crate::model::pose::rotate_numbers;
use crate::model::{Follower, Joint, JointKind, Model, Motion};
use gelenk_findings::Rule;

/// Sees: a joint that follows its parent joint with the factor −1 along the same axis.
/// Matters: its link does not move relative to the link that carries the parent joint.
/// Example: the second finger of a gripper without its `parent`.
/// Fixture: `a_joint_that_undoes_the_motion_below_it_is_noted` in `codegen/tests/meaning.rs`.
const STANDS_STILL: Rule = Rule::note("follower-stands-still");

/// Adds a note about each joint that follows others and whose link does not move relative to the previous
/// link.
pub(super) fn note(robot: &RobotDescription, model: &Model, report: &mut Report) {
    let described = model.described_parameters();
    for follower in &model.followers {
        note_stillness(robot, model, follower, &described, report);
    }
}

/// Adds a note if a joint that follows others cancels the motion of the joint that carries it. Fingers of a
/// gripper do this if they have no `parent`.
fn note_stillness(
    robot: &RobotDescription,
    model: &Model,
    follower: &Follower,
    described: &[f64],
    report: &mut Report,
) {
    let (Some(joint), [term]) = (&model.links[follower.link].joint, &follower.follows[..]) else { return };
    let Some(carrying) = model.links[joint.parent].joint.as_ref() else { return };
    let ratio = term.ratio.evaluate(described, 0.0, 0.0);
    let is_followed = carrying.motion == Motion::Coordinate(term.coordinate);
    if !is_followed || !undoes(carrying, joint, ratio, described) {
        return;
    }
    let (name, carrying) = (&joint.name, &carrying.name);
    let message = format!(
        "joint `{name}` cancels the motion of `{carrying}`, which carries `{name}`. The link of `{name}` does not move relative to \
         the link that carries `{carrying}`"
    );
    let Some(described) = robot.joints.iter().find(|described| described.name.value == *name) else { return };
    report.push(Some(described.name.span), STANDS_STILL.found(message));
    report.help(
        "a joint without `parent` is carried by the previous joint. Give the second finger of a gripper the `parent` of the first",
    );
}

/// Whether the motions of two joints cancel. Both follow one coordinate: `carrying` with the ratio 1, `joint`
/// with `ratio`.
fn undoes(carrying: &Joint, joint: &Joint, ratio: f64, described: &[f64]) -> bool {
    let slides = |joint: &Joint| joint.kind == JointKind::Prismatic;
    let turns = |joint: &Joint| matches!(joint.kind, JointKind::Revolute | JointKind::Continuous);
    let axis = Vector3::from(rotate_numbers(&joint.origin.rotation, &joint.axis));
    let carrying_axis = Vector3::from(carrying.axis);
    if (carrying_axis + axis * ratio).norm() > ROUNDING {
        return false;
    }
    let arm = Vector3::from(joint.origin.translation.each_ref().map(|x| x.evaluate(described, 0.0, 0.0)));
    slides(carrying) && slides(joint)
        || turns(carrying) && turns(joint) && arm.cross(&carrying_axis).norm() <= ROUNDING
}
