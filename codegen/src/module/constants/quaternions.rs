//! Constants of robots with spherical and floating joints: assignment of positions and velocities to joints.

use super::{constant, strings};
use crate::functions::function::{Constant, ConstantValue};
use crate::functions::positions;
use crate::layout::Dimension::{Coordinates, Joints, Positions};
use crate::model::{Joint, JointPosition, Model};

/// Constants with lengths that only robots with quaternions have.
pub(super) fn sizes(model: &Model) -> Vec<Constant> {
    if model.quaternion_joints.is_empty() {
        return vec![];
    }
    let count = |name, summary, count| constant(name, summary, ConstantValue::Count(count));
    vec![
        count("NY", "Number of position entries.", model.position_count()),
        count("JOINTS", "Number of joints.", model.joint_positions().count()),
    ]
}

/// Constants with names, types, indices and units of joints, positions and velocities.
pub(super) fn names(model: &Model) -> Vec<Constant> {
    let velocities: Vec<&Joint> = model.joints().collect();
    let joints: Vec<JointPosition<'_>> = model.joint_positions().collect();
    let name = |joint: &JointPosition<'_>| match joint {
        JointPosition::Coordinate(coordinate) => velocities[*coordinate].name.clone(),
        JointPosition::Quaternion(joint) => joint.name.clone(),
    };
    let kind = |joint: &JointPosition<'_>| match joint {
        JointPosition::Coordinate(coordinate) => velocities[*coordinate].kind.name(),
        JointPosition::Quaternion(joint) => joint.kind.name(),
    };
    let names: Vec<String> = joints.iter().map(name).collect();
    let indices = |name, summary, of: &dyn Fn(&JointPosition<'_>) -> usize| {
        constant(name, summary, ConstantValue::Indices(Joints, joints.iter().map(of).collect()))
    };
    let position_names = positions::names(model);
    let rates = velocities.iter().map(|joint| if joint.kind.unit() == "m" { "m/s" } else { "rad/s" });
    vec![
        constant(
            "JOINT_NAMES",
            "Names of the joints, in the order of their positions and velocities.",
            strings(Joints, names.iter().map(String::as_str)),
        ),
        constant("JOINT_KINDS", "Types of the joints.", strings(Joints, joints.iter().map(kind))),
        constant(
            "JOINT_POSITIONS",
            "Number of position entries of each joint: 4 for a spherical joint (quaternion x y z w), 7 for a floating \
                         joint (position of its body's origin in the parent's frame, then the quaternion), otherwise 1. The numbers of \
                         velocities are 3, 6 and 1.",
            ConstantValue::Indices(Joints, joint_positions(model)),
        ),
        indices("FIRST_POSITIONS", "The first position entry of each joint.", &|joint| {
            model.first_position(first_velocity(joint))
        }),
        indices("FIRST_VELOCITIES", "The first velocity of each joint.", &first_velocity),
        constant(
            "POSITION_NAMES",
            "Names of the position entries.",
            strings(Positions, position_names.iter().map(String::as_str)),
        ),
        constant(
            "POSITION_UNITS",
            "Units of the position entries: `rad`, `m`, `1` for quaternions.",
            strings(Positions, positions::units(model).into_iter()),
        ),
        constant(
            "VELOCITY_NAMES",
            "Names of the velocities. A floating joint has linear velocities (x, y, z), then angular velocities (rx, ry, \
                         rz). A spherical joint has angular velocities. Both are in the axes of the body that the joint carries.",
            strings(Coordinates, velocities.iter().map(|joint| joint.name.as_str())),
        ),
        constant("VELOCITY_UNITS", "Units of the velocities: `rad/s` or `m/s`.", strings(Coordinates, rates)),
        neutral(model),
    ]
}

/// Number of position entries of each joint; empty without quaternions.
pub(in crate::module) fn joint_positions(model: &Model) -> Vec<usize> {
    let entries = |joint: JointPosition<'_>| match joint {
        JointPosition::Coordinate(_) => 1,
        JointPosition::Quaternion(joint) => joint.kind.positions(),
    };
    let joints = model.joint_positions().filter(|_| !model.quaternion_joints.is_empty());
    joints.map(entries).collect()
}

fn first_velocity(joint: &JointPosition<'_>) -> usize {
    match joint {
        JointPosition::Coordinate(coordinate) => *coordinate,
        JointPosition::Quaternion(joint) => joint.first,
    }
}

/// Constant with the positions at which no joint is rotated or displaced.
fn neutral(model: &Model) -> Constant {
    let positions = model.positions_by(&vec![0.0; model.coordinates.len()]);
    let summary = "Positions at which no joint is turned or displaced: 0, and the quaternion 0 0 0 1.";
    constant("NEUTRAL", summary, ConstantValue::Numbers(Positions, positions))
}
