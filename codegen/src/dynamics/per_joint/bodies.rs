//! Motions of the bodies as arrays over joints, and the forces that they require.

use super::builder::{ArrayBuilder, Rows};
use super::rows::{entries_of, flat, flow_of, force_of, moments_of, motion_of, moved, vector};
use super::setup::Setup;
use crate::graph::Scalar;
use crate::program::arrays::ArrayId;

/// Arrays over joints with the bodies' motions, inertias and forces, in the base frame.
pub(super) struct Motions {
    /// Velocity that each joint adds to the velocity of its parent.
    pub joint_velocity: ArrayId,
    pub velocity: ArrayId,
    /// Rate of the joint's screw. The screw is the motion of the joint's body for a unit of the joint's
    /// velocity.
    pub screw_rate: ArrayId,
    /// Acceleration of each body minus gravity. For the inverse dynamics, it contains the joints'
    /// accelerations. For the forward dynamics, it contains only velocity terms.
    pub acceleration: ArrayId,
    /// Acceleration that each joint adds to the acceleration of its parent.
    pub joint_acceleration: ArrayId,
    pub inertia: ArrayId,
    pub force: ArrayId,
}

/// Arrays with sums of inertia, momentum rate and force over all bodies beyond each joint.
pub(super) struct Composites {
    pub inertia: ArrayId,
    pub flow: ArrayId,
    pub force: ArrayId,
}

/// Computes the rows of one body: inertia, moments of its velocity, rate of the joint's screw, acceleration
/// that the joint adds, and rate of the momentum.
fn body_in_motion<'g>(
    [axes, origin, moments, screw, rate, gravity, velocity]: [&Rows<'g>; 7],
    acceleration: Option<Scalar<'g>>,
) -> [Vec<Scalar<'g>>; 5] {
    let moments = moved(axes, vector(origin), moments_of(moments));
    let (screw, velocity) = (motion_of(screw), motion_of(velocity));
    let screw_rate = velocity.cross(screw);
    let mut gained = screw_rate.scaled(rate[0]);
    gained.linear = gained.linear + vector(gravity);
    if let Some(acceleration) = acceleration {
        gained = gained + screw.scaled(acceleration);
    }
    let (momentum, spin) = flow_of(&moments, velocity);
    [
        entries_of(&moments),
        [&momentum.0[..], &spin.0.concat()].concat(),
        screw_rate.entries().to_vec(),
        gained.entries().to_vec(),
        flat(velocity.cross_force(moments.times(velocity))),
    ]
}

/// Adds steps that compute velocities, accelerations and forces of the bodies. The second result is the array
/// of each body's moments `2 ∫ ṙ dm` and `2 ∫ ṙ rᵀ dm` with the points r of the body.
pub(super) fn move_bodies(
    builder: &mut ArrayBuilder,
    setup: &Setup,
    is_accelerated: bool,
) -> (Motions, ArrayId) {
    let [joint_velocity] = builder.map(
        "joint_velocities",
        "Velocity that each joint adds.",
        &[setup.screws, setup.rates],
        [("joint_velocity", 6)],
        |rows| [motion_of(rows[0]).scaled(rows[1][0]).entries().to_vec()],
    );
    let velocity = builder.sum_ancestors(joint_velocity, "velocity");
    // Only the last body of a chain has a mass, so all bodies of the chain may have its velocity.
    let velocity = builder.gather_last(velocity, "velocity_of_body");
    let [axes, origins, moments, screws, rates, gravity] =
        [setup.axes, setup.origins, setup.moments, setup.screws, setup.rates, setup.gravity];
    let writes =
        [("inertia", 10), ("flow", 12), ("screw_rate", 6), ("joint_acceleration", 6), ("momentum_rate", 6)];
    let [inertia, flow, screw_rate, joint_acceleration, momentum_rate] = match is_accelerated {
        true => builder.map(
            "bodies_in_motion",
            "Inertia of each body, its momentum, and the acceleration that its joint adds.",
            &[axes, origins, moments, screws, rates, gravity, velocity, setup.last],
            writes,
            |[axes, origin, moments, screw, rate, gravity, velocity, acceleration]| {
                let steady = [axes, origin, moments, screw, rate, gravity, velocity];
                body_in_motion(steady, Some(acceleration[0]))
            },
        ),
        false => builder.map(
            "bodies_in_steady_motion",
            "Inertia of each body, its momentum, and the acceleration that its joint adds at ÿ = 0.",
            &[axes, origins, moments, screws, rates, gravity, velocity],
            writes,
            |steady| body_in_motion(steady, None),
        ),
    };
    let acceleration = builder.sum_ancestors(joint_acceleration, "acceleration");
    let [force] = builder.map(
        "body_forces",
        "Force that each body needs.",
        &[inertia, acceleration, momentum_rate],
        [("force", 6)],
        |rows| {
            let inertial = moments_of(rows[0]).times(motion_of(rows[1]));
            [flat(inertial + force_of(rows[2]))]
        },
    );
    let motion =
        Motions { joint_velocity, velocity, screw_rate, acceleration, joint_acceleration, inertia, force };
    (motion, flow)
}
