//! Forces, mass matrix and Jacobians at the joints, from the bodies beyond them.

use super::builder::{ArrayBuilder, Rows};
use super::moving::Moving;
use super::rows::{complement, flat, force_of, moments_of, motion_of, swept, vector};
use crate::graph::Scalar;
use crate::program::arrays::ArrayId;
use crate::spatial::Motion;

/// Adds the array of the inverse dynamics `M ÿ + k − q` (required minus applied forces), by coordinate.
pub(super) fn joint_forces(builder: &mut ArrayBuilder, moving: &Moving) -> ArrayId {
    let forces = forces_at_joints(builder, moving);
    builder.collect(forces, "forces_at_coordinates")
}

fn forces_at_joints(builder: &mut ArrayBuilder, moving: &Moving) -> ArrayId {
    let Moving { setup, motions, rotors, composites } = moving;
    let [forces] = builder.map(
        "forces_at_joints",
        "Force along each joint, without springs and friction.",
        &[setup.screws, composites.force, setup.rotors, setup.last, setup.joint_forces],
        [("forces", 1)],
        |rows| {
            let bodies = motion_of(rows[0]).dot(force_of(rows[1]));
            [vec![bodies + rows[2][0] * rows[3][0] - rows[4][2]]]
        },
    );
    let Some(rotors) = rotors else { return forces };
    let carried = rotors.carried(builder, motions);
    let [forces] = builder.map(
        "forces_at_rotors",
        "Force along each joint and its rotor, without springs and friction.",
        &[forces, carried],
        [("forces_with_rotors", 1)],
        |[force, carried]| [vec![force[0] + carried[0]]],
    );
    forces
}

/// Adds the array of the forces that accelerate the coordinates: driving forces minus Coriolis forces, plus
/// gravity.
pub(super) fn remaining_forces(builder: &mut ArrayBuilder, moving: &Moving) -> ArrayId {
    let remaining = remaining_at_joints(builder, moving);
    builder.collect(remaining, "remaining_at_coordinates")
}

fn remaining_at_joints(builder: &mut ArrayBuilder, moving: &Moving) -> ArrayId {
    let Moving { setup, motions, rotors, composites } = moving;
    let [remaining] = builder.map(
        "remaining_forces",
        "Part of the driving forces that accelerates.",
        &[setup.screws, composites.force, setup.last],
        [("remaining_force", 1)],
        |rows| [vec![rows[2][0] - motion_of(rows[0]).dot(force_of(rows[1]))]],
    );
    let Some(rotors) = rotors else {
        return remaining;
    };
    let carried = rotors.carried(builder, motions);
    let [remaining] = builder.map(
        "remaining_at_rotors",
        "Part of the driving forces that accelerates the joints and their rotors.",
        &[remaining, carried],
        [("remaining_with_rotors", 1)],
        |[remaining, carried]| [vec![remaining[0] - carried[0]]],
    );
    remaining
}

pub(super) fn mass_matrix(builder: &mut ArrayBuilder, moving: &Moving) -> ArrayId {
    let Moving { setup, rotors, composites, .. } = moving;
    let [needed, diagonal] = builder.map(
        "unit_accelerations",
        "Forces for a unit acceleration of each joint.",
        &[setup.screws, composites.inertia, setup.rotors],
        [("unit_force", 6), ("diagonal", 1)],
        |rows| {
            let screw = motion_of(rows[0]);
            let force = moments_of(rows[1]).times(screw);
            [flat(force), vec![screw.dot(force) + rows[2][0]]]
        },
    );
    let needed = rotors.as_ref().map_or(needed, |rotors| rotors.add_momentum(builder, needed));
    let mass = builder.pairs((needed, setup.screws), (setup.screws, needed), diagonal, "mass_matrix");
    builder.project(mass, "mass_matrix_of_coordinates")
}

/// Effect of a unit displacement and unit velocity of a joint on the motion of the bodies beyond the joint.
struct Displacement<'g> {
    /// Rate `v × S` of the joint's screw S (motion per unit of the joint's velocity). v is the velocity of
    /// the joint's body, or of the joint's carrier if the robot has quaternions.
    rate: Motion<'g>,
    /// Acceleration `a × S + v × Ṡ` of the joint's screw S with the rate `Ṡ = v × S`. v and a are the
    /// velocity and acceleration of the joint's body, or of its carrier if the robot has quaternions.
    accelerated: Motion<'g>,
    /// Sum of two rates of the joint's screw S: `v × S` with the velocity v of the joint's body, and
    /// [`Self::rate`].
    twice: Motion<'g>,
}

/// Inertia, velocity moments and force of all bodies beyond a joint.
#[derive(Clone, Copy)]
struct Carried<'a, 'g> {
    inertia: &'a Rows<'g>,
    flow: &'a Rows<'g>,
    force: &'a Rows<'g>,
}

/// Names of the arrays that [`disturb`] computes, with their numbers of rows.
const DISTURBANCES: [(&str, usize); 7] = [
    ("gains", 9),
    ("by_coordinate", 9),
    ("by_velocity", 9),
    ("stiffness", 6),
    ("damping", 6),
    ("own_stiffness", 1),
    ("own_damping", 1),
];

/// Computes, at one joint, the columns and diagonal entries from which the Jacobians are computed.
fn disturb<'g>(
    screw: Motion<'g>,
    Carried { inertia, flow, force }: Carried<'_, 'g>,
    joint: &Rows<'g>,
    displacement: impl FnOnce() -> Displacement<'g>,
) -> [Vec<Scalar<'g>>; 7] {
    let moments = moments_of(inertia);
    let (momentum, spin) = (vector(&flow[..3]), complement(&flow[3..]));
    let Displacement { rate, accelerated, twice } = displacement();
    let damping = swept(&spin, momentum, screw.angular) + moments.times(twice);
    let own = swept(&spin, momentum, rate.angular) + moments.times(accelerated);
    let stiffness = own + screw.cross_force(force_of(force));
    let by_omega = spin.transposed_times(screw.angular) + momentum.cross(screw.linear);
    [
        [&by_omega.0[..], &flat(moments.times(screw))].concat(),
        [&rate.angular.0[..], &accelerated.entries()].concat(),
        [&screw.angular.0[..], &twice.entries()].concat(),
        flat(stiffness),
        flat(damping),
        vec![screw.dot(own) - joint[0]],
        vec![screw.dot(damping) - joint[1]],
    ]
}

const ABOUT_DISTURBANCES: &str =
    "Effect of each joint on the bodies beyond it, and the resulting forces at the joints before it.";

fn disturbances(builder: &mut ArrayBuilder, moving: &Moving) -> [ArrayId; 7] {
    let Moving { setup, motions, composites, .. } = moving;
    let reads = [
        setup.screws,
        motions.screw_rate,
        motions.velocity,
        motions.acceleration,
        composites.inertia,
        composites.flow,
        composites.force,
        setup.joint_forces,
    ];
    builder.map(
        "disturbances",
        ABOUT_DISTURBANCES,
        &reads,
        DISTURBANCES,
        |[screw, screw_rate, velocity, acceleration, inertia, flow, force, joint]| {
            let (screw, rate) = (motion_of(screw), motion_of(screw_rate));
            disturb(screw, Carried { inertia, flow, force }, joint, || {
                let accelerated = motion_of(acceleration).cross(screw) + motion_of(velocity).cross(rate);
                Displacement { rate, accelerated, twice: rate.map(|x| x * 2.0) }
            })
        },
    )
}

/// Adds the arrays of [`disturbances`] for robots with quaternions. All velocities of a joint use the motion
/// of the body that carries the joint.
fn disturbances_on_carriers(
    builder: &mut ArrayBuilder,
    moving: &Moving,
    base_acceleration: ArrayId,
) -> [ArrayId; 7] {
    let Moving { setup, motions, composites, .. } = moving;
    let velocity = builder.gather_carriers(motions.velocity, "carrier_velocity");
    let acceleration = builder.gather_carriers(motions.acceleration, "carrier_acceleration");
    let reads = [
        setup.screws,
        motions.screw_rate,
        velocity,
        acceleration,
        base_acceleration,
        composites.inertia,
        composites.flow,
        composites.force,
        setup.joint_forces,
    ];
    builder.map(
        "disturbances_on_carriers",
        ABOUT_DISTURBANCES,
        &reads,
        DISTURBANCES,
        |[screw, screw_rate, velocity, acceleration, base, inertia, flow, force, joint]| {
            let (screw, velocity) = (motion_of(screw), motion_of(velocity));
            disturb(screw, Carried { inertia, flow, force }, joint, || {
                let mut acceleration = motion_of(acceleration);
                acceleration.linear = acceleration.linear + vector(base);
                let rate = velocity.cross(screw);
                let accelerated = acceleration.cross(screw) + velocity.cross(rate);
                Displacement { rate, accelerated, twice: rate + motion_of(screw_rate) }
            })
        },
    )
}

/// Adds the Jacobians of the inverse dynamics with respect to y and ẏ as square matrices over coordinates.
pub(super) fn jacobians(builder: &mut ArrayBuilder, moving: &Moving) -> (ArrayId, ArrayId) {
    let Moving { setup, rotors, .. } = moving;
    let [gains, by_coordinate, by_velocity, stiffness, damping, own_stiffness, own_damping] =
        match setup.base_acceleration {
            Some(base) => disturbances_on_carriers(builder, moving, base),
            None => disturbances(builder, moving),
        };
    let (gains, damping) = match rotors {
        Some(rotors) => rotors.add_to_columns(builder, gains, damping),
        None => (gains, damping),
    };
    let mut pairs =
        |by_j, column, diagonal, name| builder.pairs((gains, by_j), (setup.screws, column), diagonal, name);
    let by_coordinates = pairs(by_coordinate, stiffness, own_stiffness, "by_coordinates");
    let by_velocities = pairs(by_velocity, damping, own_damping, "by_velocities");
    let (by_coordinates, by_velocities) = match &setup.coupled_forces {
        Some(forces) => (
            builder.subtract(
                by_coordinates,
                forces.by_coordinates,
                ["subtract_stiffness", "by_all_positions"],
            ),
            builder.subtract(by_velocities, forces.by_velocities, ["subtract_damping", "by_all_rates"]),
        ),
        None => (by_coordinates, by_velocities),
    };
    (
        builder.project(by_coordinates, "coordinates_by_coordinates"),
        builder.project(by_velocities, "coordinates_by_velocities"),
    )
}
