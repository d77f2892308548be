//! Checks spherical and floating joints: the keys of their velocities, and the order of the velocities among
//! the coordinates.

use super::inner_links;
use super::tree::Tree;
use crate::description::{DriveChoice, JointDescription, Name, PartOf, RobotDescription};
use crate::diagnostic::{Report, Span};
use crate::model::quaternion_joint::{NO_LAW_OF_POSITION, NO_ROTOR};
use crate::model::{QuaternionJoint, QuaternionKind};
use gelenk_formula::Formula;

/// Reports keys that are not valid for a velocity of a joint with a quaternion.
pub(super) fn check(robot: &RobotDescription, report: &mut Report) {
    for joint in &robot.joints {
        if let Some(part) = &joint.part_of {
            Velocity { joint, part }.check(report);
        }
    }
    for joint in &robot.joints {
        for followed in joint.follows.iter().flat_map(|follows| &follows.value) {
            let help = "a joint can only follow joints with one position";
            refuse_following(robot, &followed.joint, &joint.name, help, report);
        }
    }
    for drive in &robot.drives {
        for followed in &drive.on {
            let help = "`on` accepts only joints with one position. For a torque on this joint, use `drive = \"ideal\"` at the \
                        joint";
            refuse_following(robot, &followed.joint, &drive.name, help, report);
        }
    }
    refuse_second_floating(robot, report);
    inner_links::refuse(robot, report);
}

/// One velocity of a joint with a quaternion, as an entry of the description.
struct Velocity<'d> {
    joint: &'d JointDescription,
    part: &'d PartOf,
}

impl Velocity<'_> {
    fn check(&self, report: &mut Report) {
        let JointDescription { name, limits, springs, friction, follows, drive, .. } = self.joint;
        if self.joint.held.is_some() {
            self.refuse(name.span, "`held`", self.part.kind.how_to_hold(), report);
        }
        if let Some(position) = &limits.position {
            self.refuse(
                position.span,
                "position limits",
                self.part.kind.why_unlimited(self.part.index),
                report,
            );
        }
        if let Some(follows) = follows {
            let help = "a joint with a quaternion cannot follow a coordinate. Describe it with revolute joints, for example type \
                        \"universal\"";
            self.refuse(follows.span, "`follows`", help, report);
        }
        if let Some(springs) = springs
            && springs.value.iter().any(Formula::depends_on_position)
        {
            self.refuse(springs.span, "a spring that depends on the position", NO_LAW_OF_POSITION, report);
        }
        if let Some(friction) = friction {
            if friction.value.terms.iter().any(|term| term.basis.depends_on_position()) {
                self.refuse(
                    friction.span,
                    "friction that depends on the position",
                    NO_LAW_OF_POSITION,
                    report,
                );
            }
            if let Some(load) = &friction.value.load {
                let help = "load-dependent friction requires a joint with one velocity";
                self.refuse(load.span, "load-dependent friction", help, report);
            }
        }
        if let Some(drive) = drive
            && let DriveChoice::Motor(motor) = &drive.value
            && !motor.rotor_inertia.value.is_zero()
        {
            self.refuse(drive.span, "a rotor", NO_ROTOR, report);
        }
    }

    fn refuse(&self, span: Span, what: &str, help: &str, report: &mut Report) {
        let (kind, joint) = (self.part.kind.name(), &self.part.joint.value);
        let message =
            format!("{kind} joint `{joint}` cannot have {what} (velocity `{}`)", self.joint.name.value);
        report.error(span, "quaternion-joint", message).help(help);
    }
}

fn refuse_following(robot: &RobotDescription, followed: &Name, by: &Name, help: &str, report: &mut Report) {
    let joint = robot.joints.iter().find(|joint| joint.name.value == followed.value);
    if let Some(part) = joint.and_then(|joint| joint.part_of.as_ref()) {
        let (kind, joint) = (part.kind.name(), &part.joint.value);
        let message = format!(
            "`{}` refers to `{}`, which is a velocity of {kind} joint `{joint}`",
            by.value, followed.value
        );
        report.error(followed.span, "quaternion-joint", message);
        report.help(help);
    }
}

fn refuse_second_floating(robot: &RobotDescription, report: &mut Report) {
    let firsts = robot.joints.iter().filter_map(|joint| joint.part_of.as_ref());
    let mut floating = firsts.filter(|part| part.index == 0 && part.kind == QuaternionKind::Floating);
    let first = floating.next();
    for (second, first) in floating.filter_map(|second| Some((second, first?))) {
        let message = format!(
            "joint `{}` is a second floating joint. The first is `{}`",
            second.joint.value, first.joint.value
        );
        report.error(second.joint.span, "second-floating-joint", message);
        report.help("a model has at most one free body: generate one module per robot");
    }
}

/// Returns the joints with quaternions in the order of the coordinates. Reports an error if the velocities of
/// a joint are not adjacent.
///
/// - `coordinates`: links of the coordinates
pub(super) fn find(
    robot: &RobotDescription,
    tree: &Tree,
    coordinates: &[usize],
    report: &mut Report,
) -> Vec<QuaternionJoint> {
    let part = |coordinate: usize| {
        let joint = tree.joints[*coordinates.get(coordinate)?]?;
        robot.joints[joint].part_of.as_ref()
    };
    let mut joints: Vec<QuaternionJoint> = Vec::new();
    let mut next = 0;
    while next < coordinates.len() {
        let Some(first) = part(next) else {
            next += 1;
            continue;
        };
        let count = first.kind.velocities();
        let stands = |k: usize| {
            part(next + k).is_some_and(|other| other.index == k && other.joint.value == first.joint.value)
        };
        if !(0..count).all(stands) {
            if report.has_errors() && robot.coordinates.is_none() {
                // A held velocity of this joint was already reported.
                return joints;
            }
            let span = robot.coordinates.as_ref().and_then(|listed| listed.get(next));
            let span = span.map_or(first.joint.span, |name| name.span);
            let message = format!("the velocities of joint `{}` are not adjacent", first.joint.value);
            report.error(span, "quaternion-joint", message);
            report.help("list the velocities of each joint together and in their order in `coordinates`");
            return joints;
        }
        joints.push(QuaternionJoint { name: first.joint.value.clone(), kind: first.kind, first: next });
        next += count;
    }
    joints
}
