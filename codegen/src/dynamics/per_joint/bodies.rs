//! Motion of the bodies, and their forces and moments.

use super::builder::{ArrayBuilder, Rows};
use super::rows::{entries_of, flat, flow_of, force_of, moments_of, motion_of, moved, vector};
use super::setup::Setup;
use crate::graph::Scalar;
use crate::program::arrays::ArrayId;

/// Motion of all bodies, their inertia, and the forces from their velocities.
pub(super) struct Motions {
    /// Velocity contributed by each joint.
    pub joint_velocity: ArrayId,
    pub velocity: ArrayId,
    /// Ṡ; equal to Ψ̇ for joints without quaternions.
    pub screw_rate: ArrayId,
    /// Acceleration a with gravity, from the velocities and, in the inverse dynamics, from the accelerations.
    pub acceleration: ArrayId,
    /// Acceleration contributed by each joint.
    pub joint_acceleration: ArrayId,
    pub inertia: ArrayId,
    pub force: ArrayId,
}

/// Sums over all bodies beyond each joint.
pub(super) struct Composites {
    pub inertia: ArrayId,
    pub flow: ArrayId,
    pub force: ArrayId,
}

/// Inertia, momentum, rate of the screw, the acceleration that the joint adds, and the rate of the momentum,
/// of one body.
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

/// Computes velocities, accelerations and forces of the bodies, and 2 ∫ ṙ dm and 2 ∫ ṙ rᵀ dm.
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
    // The bodies of a chain but the last have no mass: what holds for it may be said of all of them.
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
