//! Data of the robot for the 3-D view on its page.

use gelenk_report::{Scene, SceneBody, SceneFrame, SceneJoint, SceneKind, SceneMotion, SceneRod};

use super::robot::Robot;
use crate::model::{Attachment, ForceEffect, Joint, JointKind, Link, Motion};

pub(super) fn scene(robot: &Robot<'_>) -> Scene {
    let model = robot.model;
    let links = model.links.iter().enumerate();
    let joints = links.clone().filter_map(|(_, link)| Some(scene_joint(robot, link, link.joint.as_ref()?)));
    let bodies = links.flat_map(|(index, link)| link.bodies.iter().map(move |body| (index, body)));
    Scene {
        name: model.name.clone(),
        base: model.links.first().map_or_else(String::new, |base| base.name.clone()),
        gravity: robot.vector(&model.gravity),
        joints: joints.collect(),
        symbols: (0..robot.n() + model.driven.len()).map(|coordinate| robot.named(coordinate)).collect(),
        bodies: bodies
            .map(|(link, body)| SceneBody {
                name: body.name.clone(),
                joint: joint_of(link),
                mass: robot.value(&body.mass),
                center: robot.vector(&body.center_of_mass),
            })
            .collect(),
        frames: model
            .frames
            .iter()
            .map(|frame| SceneFrame {
                name: frame.name.clone(),
                joint: joint_of(frame.link),
                translation: robot.vector(&frame.pose.translation),
                rotation: frame.pose.rotation,
            })
            .collect(),
        rods: rods(robot),
    }
}

/// Forces between two frames for the 3-D view. A cylinder that also has a force law is drawn once.
fn rods(robot: &Robot<'_>) -> Vec<SceneRod> {
    let model = robot.model;
    let pulls = model.force_inputs.iter().filter_map(|input| match &input.effect {
        ForceEffect::Pull(between) => Some(between),
        ForceEffect::Wrench { .. } => None,
    });
    let pulls: Vec<&[Attachment; 2]> = pulls.collect();
    let springs =
        model.point_forces.iter().map(|force| &force.between).filter(|between| !pulls.contains(between));
    let end = |at: &Attachment| (joint_of(at.link), robot.vector(&at.pose.translation));
    let rod = |between: &[Attachment; 2], is_input| SceneRod { ends: between.each_ref().map(end), is_input };
    springs.map(|between| rod(between, false)).chain(pulls.iter().map(|between| rod(between, true))).collect()
}

/// Index of the joint of a link; `None` for the base. Every link except the base has one joint.
fn joint_of(link: usize) -> Option<usize> {
    link.checked_sub(1)
}

/// The coordinates that a joint follows, with the values of the free parameters on the page.
fn follower(robot: &Robot<'_>, index: usize) -> SceneMotion {
    let moving = robot.model.moving_joints();
    let terms = moving[index].follows.iter().map(|term| (term.coordinate, robot.value(&term.ratio)));
    SceneMotion::Follows { terms: terms.collect(), offset: moving[index].offset }
}

fn kind(kind: JointKind) -> SceneKind {
    match kind {
        JointKind::Fixed | JointKind::Revolute | JointKind::Continuous => SceneKind::Turns,
        JointKind::Prismatic => SceneKind::Slides,
        JointKind::Helical { pitch } => SceneKind::Screws { pitch },
    }
}

fn scene_joint(robot: &Robot<'_>, link: &Link, joint: &Joint) -> SceneJoint {
    let motion = match joint.motion {
        Motion::Follower(index) => follower(robot, index),
        Motion::Fixed => SceneMotion::Fixed,
        Motion::Held(position) => SceneMotion::Held(position),
        Motion::Coordinate(index) => SceneMotion::Coordinate(index),
    };
    let acts = |drive: &&crate::model::Drive| match joint.motion {
        Motion::Coordinate(index) => drive.acts_on.iter().any(|term| term.coordinate == index),
        _ => false,
    };
    let drives: Vec<String> =
        robot.model.input_drives().filter(acts).map(|drive| drive.name.clone()).collect();
    SceneJoint {
        name: joint.name.clone(),
        link: link.name.clone(),
        parent: joint_of(joint.parent),
        translation: robot.vector(&joint.origin.translation),
        rotation: joint.origin.rotation,
        axis: joint.axis,
        kind: kind(joint.kind),
        motion,
        limits: joint.limits.position,
        input: (!drives.is_empty()).then(|| drives.join(", ")),
    }
}
