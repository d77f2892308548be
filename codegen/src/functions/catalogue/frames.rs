//! Functions of named frames in the catalogue.

use super::quantity::Argument::{Coordinates, Velocities};
use super::quantity::{FRAME_JACOBIAN, FrameQuantity, IN_SPACE, ROTATION, matrix, vector};
use crate::dynamics::recursion::motion::MotionInput;
use crate::functions::function::FrameKind;

pub(in crate::functions) const FRAME_QUANTITIES: &[FrameQuantity] = &[
    FrameQuantity {
        kind: FrameKind::Pose,
        summary: "Pose of the frame",
        equation: "r_base = p + R r_frame",
        arguments: &[Coordinates],
        results: &[
            ("p", IN_SPACE, "origin in the base frame [m]"),
            ("R", ROTATION, "rotation matrix, columns are the frame's axes"),
        ],
        build: |equations, arguments, link, pose| {
            let pose = equations.base_poses(&arguments.y).pose(link, pose);
            let rows = (0..3).map(|row| pose.axes.iter().map(|axis| axis[row]).collect()).collect();
            vec![vector(pose.origin.0.to_vec()), matrix(rows)]
        },
    },
    FrameQuantity {
        kind: FrameKind::Jacobian,
        summary: "Jacobian of the frame",
        equation: "(ṗ, ω) = J(y) ẏ",
        arguments: &[Coordinates],
        results: &[(
            "J",
            FRAME_JACOBIAN,
            "rows: velocity of the origin, then angular velocity, in the axes of the base frame",
        )],
        build: |equations, arguments, link, pose| {
            vec![matrix(equations.base_poses(&arguments.y).jacobian(link, pose))]
        },
    },
    FrameQuantity {
        kind: FrameKind::JacobianRateTimesVelocity,
        summary: "Acceleration of the frame at ÿ = 0",
        equation: "(p̈, ω̇) = J(y) ÿ + J̇ ẏ",
        arguments: &[Coordinates, Velocities],
        results: &[(
            "J̇ẏ",
            IN_SPACE,
            "acceleration of the origin [m/s²], then angular acceleration [rad/s²], in the axes of the base frame",
        )],
        build: |equations, arguments, link, pose| {
            let (y, v) = (&arguments.y, &arguments.v);
            let input = MotionInput { y, v, a: &equations.unaccelerated() };
            vec![vector(equations.base_poses(y).acceleration(link, pose, input))]
        },
    },
];
