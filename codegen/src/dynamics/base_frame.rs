//! Jacobians of the inverse and forward dynamics in array form, with spatial vectors in the frame of the base.
//!
//! There every sum along a path or over a subtree is a sum of arrays, and what two joints have in common is a product of
//! two columns of six or nine entries. With the screw S of a joint, the spatial velocity v and acceleration a of its
//! body, Ψ̇ = v × S and Ψ̈ = a × S + v × Ψ̇, the composite inertia I, 2B s = Σ 2 ∫ r ∧ (ω_s × ṙ) dm and force f of all
//! that it carries, and for j before i
//!
//! ```text
//! M_ji = S_jᵀ I_i S_i = M_ij
//! ∂τ_j/∂ẏ_i = S_jᵀ (2B_i S_i + 2 I_i Ψ̇_i)          ∂τ_i/∂ẏ_j = S_iᵀ (2B_i S_j + 2 I_i Ψ̇_j)
//! ∂τ_j/∂y_i = S_jᵀ (2B_i Ψ̇_i + I_i Ψ̈_i + S_i ×* f_i)   ∂τ_i/∂y_j = S_iᵀ (2B_i Ψ̇_j + I_i Ψ̈_j)
//! ```
//!
//! (Singh, Russell and Wensing 2022; 2B in the moments 2 ∫ ṙ dm and 2 ∫ ṙ rᵀ dm of `derivatives.rs`, which act on the
//! angular part alone.)

use super::array_builder::{ArrayBuilder, Rows};
use super::catalogue::Arguments;
use super::equations::Equations;
use super::frame_motion::BasePoses;
use super::rotor;
use crate::graph::{Scalar, differentiate};
use crate::kinematics::Mechanism;
use crate::program::arrays::{ArrayId, Arrays};
use crate::program::{InputArray, Shape};
use crate::spatial::{Force, MassMoments, Matrix3, Motion, Symmetric3, Vector3};

/// Whether the array form knows all that the mechanism has: rotors that moving bodies carry are left to the
/// straight-line form.
pub fn is_possible(mechanism: &Mechanism<'_>) -> bool {
    let mut rotors = mechanism.rotors.iter();
    !mechanism.is_empty() && rotors.all(|rotor| rotor.carrier.is_none() || rotor.inertia.is_zero())
}

/// What the setup computes joint by joint.
struct Setup {
    screws: ArrayId,
    axes: ArrayId,
    origins: ArrayId,
    moments: ArrayId,
    rates: ArrayId,
    gravity: ArrayId,
    /// i² J of rotors.
    rotors: ArrayId,
    /// Accelerations, or what drives them.
    last: ArrayId,
    /// Springs and friction: by y, by ẏ, and their force.
    joint_forces: ArrayId,
}

/// The motion of all bodies, their inertia, and what their velocities ask for.
struct Motions {
    velocity: ArrayId,
    /// Ψ̇
    screw_rate: ArrayId,
    /// a with gravity, of the velocities and, in the inverse dynamics, of the accelerations.
    acceleration: ArrayId,
    inertia: ArrayId,
    force: ArrayId,
}

/// Sums over all that a joint carries.
struct Composites {
    inertia: ArrayId,
    flow: ArrayId,
    force: ArrayId,
}

/// `inverse_dynamics_derivatives`
pub fn inverse_dynamics_derivatives<'g>(
    equations: &Equations<'_, 'g>,
    arguments: &Arguments<'g>,
    inputs: Vec<InputArray>,
) -> Arrays {
    let (builder, _) = inverse_dynamics_and_jacobians(equations, arguments);
    builder.finish(equations.graph, inputs)
}

/// `inverse_dynamics_derivatives_and_mass_matrix`
pub fn inverse_dynamics_derivatives_and_mass_matrix<'g>(
    equations: &Equations<'_, 'g>,
    arguments: &Arguments<'g>,
    inputs: Vec<InputArray>,
) -> Arrays {
    let (mut builder, (setup, composites)) = inverse_dynamics_and_jacobians(equations, arguments);
    let mass = mass_matrix(&mut builder, &setup, &composites);
    let n = builder.each_joint();
    builder.output("M", Shape::Matrix(n, n), mass);
    builder.finish(equations.graph, inputs)
}

/// The forces and their Jacobians, with what M is made of.
fn inverse_dynamics_and_jacobians<'g>(
    equations: &Equations<'_, 'g>,
    arguments: &Arguments<'g>,
) -> (ArrayBuilder, (Setup, Composites)) {
    let mut builder = ArrayBuilder::new(&Mechanism::new(equations.graph, equations.model));
    let last = ("accelerations", arguments.a.clone());
    let setup = set_up(&mut builder, equations, arguments, last);
    let (motion, flow) = move_bodies(&mut builder, &setup, true);
    let composites = Composites {
        inertia: builder.sum_subtrees(motion.inertia, "composite_inertia"),
        flow: builder.sum_subtrees(flow, "composite_flow"),
        force: builder.sum_subtrees(motion.force, "composite_force"),
    };
    let forces = joint_forces(&mut builder, &setup, &composites);
    builder.output("B u", Shape::Vector(builder.each_joint()), forces);
    let (by_coordinates, by_velocities) = jacobians(&mut builder, &setup, &motion, &composites);
    let n = builder.each_joint();
    builder.output("∂/∂y", Shape::Matrix(n, n), by_coordinates);
    builder.output("∂/∂ẏ", Shape::Matrix(n, n), by_velocities);
    (builder, (setup, composites))
}

/// `forward_dynamics_derivatives`
pub fn forward_dynamics_derivatives<'g>(
    equations: &Equations<'_, 'g>,
    arguments: &Arguments<'g>,
    inputs: Vec<InputArray>,
) -> Arrays {
    let mut builder = ArrayBuilder::new(&Mechanism::new(equations.graph, equations.model));
    let last = (
        "driving_forces",
        equations.driving_forces(&arguments.y, &arguments.v, &arguments.u),
    );
    let setup = set_up(&mut builder, equations, arguments, last);
    let (steady, flow) = move_bodies(&mut builder, &setup, false);
    let at_rest = Composites {
        inertia: builder.sum_subtrees(steady.inertia, "composite_inertia"),
        flow: builder.sum_subtrees(flow, "composite_flow"),
        force: builder.sum_subtrees(steady.force, "composite_bias"),
    };
    let mass = mass_matrix(&mut builder, &setup, &at_rest);
    let inverse = builder.invert(mass, "inverse");
    let remaining = remaining_forces(&mut builder, &setup, &at_rest);
    let accelerations = builder.apply(inverse, remaining, "accelerations");
    let (motion, composites) = accelerate(&mut builder, &setup, &steady, at_rest, accelerations);
    let (by_coordinates, by_velocities) = jacobians(&mut builder, &setup, &motion, &composites);
    let n = builder.each_joint();
    builder.output("ÿ", Shape::Vector(n), accelerations);
    for (result, matrix, name) in [
        ("∂ÿ/∂y", by_coordinates, "accelerations_by_coordinates"),
        ("∂ÿ/∂ẏ", by_velocities, "accelerations_by_velocities"),
    ] {
        let product = builder.negative_product(inverse, matrix, name);
        builder.output(result, Shape::Matrix(n, n), product);
    }
    builder.output("M⁻¹", Shape::Matrix(n, n), inverse);
    builder.finish(equations.graph, inputs)
}

/// Straight-line code: poses, and what depends on single joints.
fn set_up<'g>(
    builder: &mut ArrayBuilder,
    equations: &Equations<'_, 'g>,
    arguments: &Arguments<'g>,
    (last_name, last): (&'static str, Vec<Scalar<'g>>),
) -> Setup {
    let graph = equations.graph;
    let mechanism = Mechanism::new(graph, equations.model);
    let (n, zero) = (mechanism.len(), graph.constant(0.0));
    let poses = BasePoses::new(mechanism.clone(), &arguments.y);
    let mut rows = |name: &str, count: usize, fill: &dyn Fn(usize) -> Vec<Scalar<'g>>| {
        let mut rows = vec![vec![zero; n]; count];
        for (index, body) in mechanism.bodies.iter().enumerate() {
            for (row, entry) in rows.iter_mut().zip(fill(index)) {
                row[body.transmission.coordinate] = entry;
            }
        }
        builder.set_up(name, rows)
    };
    let joint = equations.joint_forces(&arguments.y, &arguments.v);
    let by = |force: Scalar<'g>, variable: Scalar<'g>| differentiate(graph, &[force], variable)[0];
    let mut rotors = vec![vec![zero; n]; n];
    rotor::add_inertia(&mechanism, &mut rotors);
    let coordinate = |index: usize| mechanism.bodies[index].transmission.coordinate;
    Setup {
        screws: rows("screws", 6, &|index| {
            let (body, pose) = (&mechanism.bodies[index], poses.body(index));
            let axis = pose.axes[2].map(|x| x * body.transmission.ratio);
            body.axis.along(axis, pose.origin).entries().to_vec()
        }),
        axes: rows("axes", 9, &|index| {
            poses.body(index).axes.map(|axis| axis.0).concat()
        }),
        origins: rows("origins", 3, &|index| poses.body(index).origin.0.to_vec()),
        moments: rows("moments", 10, &|index| {
            entries_of(&mechanism.bodies[index].moments)
        }),
        rates: rows("rates", 1, &|index| vec![arguments.v[coordinate(index)]]),
        gravity: rows(
            "gravity",
            3,
            &|index| match mechanism.bodies[index].parent {
                Some(_) => vec![zero; 3],
                None => (-mechanism.gravity).0.to_vec(),
            },
        ),
        rotors: rows("rotor_inertia", 1, &|index| {
            let coordinate = coordinate(index);
            vec![rotors[coordinate][coordinate]]
        }),
        last: rows(last_name, 1, &|index| vec![last[coordinate(index)]]),
        joint_forces: rows("joint_forces", 3, &|index| {
            let coordinate = coordinate(index);
            let force = joint[coordinate];
            vec![
                by(force, arguments.y[coordinate]),
                by(force, arguments.v[coordinate]),
                force,
            ]
        }),
    }
}

/// Inertia, momentum, rate of the screw, the acceleration that the joint adds, and the rate of the momentum, of one body.
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

/// Velocities, accelerations and forces, body by body; also 2 ∫ ṙ dm and 2 ∫ ṙ rᵀ dm.
fn move_bodies(
    builder: &mut ArrayBuilder,
    setup: &Setup,
    is_accelerated: bool,
) -> (Motions, ArrayId) {
    let [joint_velocity] = builder.map(
        ("joint_velocities", "Velocity that each joint adds."),
        &[setup.screws, setup.rates],
        [("joint_velocity", 6)],
        |rows| [motion_of(rows[0]).scaled(rows[1][0]).entries().to_vec()],
    );
    let velocity = builder.sum_ancestors(joint_velocity, "velocity");
    let [axes, origins, moments, screws, rates, gravity] = [
        setup.axes,
        setup.origins,
        setup.moments,
        setup.screws,
        setup.rates,
        setup.gravity,
    ];
    let writes = [
        ("inertia", 10),
        ("flow", 12),
        ("screw_rate", 6),
        ("joint_acceleration", 6),
        ("momentum_rate", 6),
    ];
    let [inertia, flow, screw_rate, joint_acceleration, momentum_rate] = match is_accelerated {
        true => builder.map(
            (
                "bodies_in_motion",
                "Inertia of each body, its momentum, and the acceleration that its joint adds.",
            ),
            &[axes, origins, moments, screws, rates, gravity, velocity, setup.last],
            writes,
            |[axes, origin, moments, screw, rate, gravity, velocity, acceleration]| {
                let steady = [axes, origin, moments, screw, rate, gravity, velocity];
                body_in_motion(steady, Some(acceleration[0]))
            },
        ),
        false => builder.map(
            (
                "bodies_in_steady_motion",
                "Inertia of each body, its momentum, and the acceleration that its joint adds at ÿ = 0.",
            ),
            &[axes, origins, moments, screws, rates, gravity, velocity],
            writes,
            |steady| body_in_motion(steady, None),
        ),
    };
    let acceleration = builder.sum_ancestors(joint_acceleration, "acceleration");
    let [force] = builder.map(
        ("body_forces", "Force that each body needs."),
        &[inertia, acceleration, momentum_rate],
        [("force", 6)],
        |rows| {
            let inertial = moments_of(rows[0]).times(motion_of(rows[1]));
            [flat(inertial + force_of(rows[2]))]
        },
    );
    let motion = Motions {
        velocity,
        screw_rate,
        acceleration,
        inertia,
        force,
    };
    (motion, flow)
}

/// What the accelerations add to a steady motion.
fn accelerate(
    builder: &mut ArrayBuilder,
    setup: &Setup,
    steady: &Motions,
    at_rest: Composites,
    accelerations: ArrayId,
) -> (Motions, Composites) {
    let [gained] = builder.map(
        ("joint_accelerations", "Acceleration that each joint adds."),
        &[setup.screws, accelerations],
        [("added_joint_acceleration", 6)],
        |rows| [motion_of(rows[0]).scaled(rows[1][0]).entries().to_vec()],
    );
    let gained = builder.sum_ancestors(gained, "added_acceleration");
    let [acceleration, force] = builder.map(
        (
            "accelerated_bodies",
            "Acceleration of each body, and the force that the added one needs.",
        ),
        &[steady.inertia, steady.acceleration, gained],
        [("total_acceleration", 6), ("added_force", 6)],
        |rows| {
            let gained = motion_of(rows[2]);
            [
                (motion_of(rows[1]) + gained).entries().to_vec(),
                flat(moments_of(rows[0]).times(gained)),
            ]
        },
    );
    let added = builder.sum_subtrees(force, "composite_added_force");
    let [force] = builder.map(
        ("total_forces", "Force of all that each joint carries."),
        &[at_rest.force, added],
        [("composite_force", 6)],
        |rows| [flat(force_of(rows[0]) + force_of(rows[1]))],
    );
    (
        Motions {
            acceleration,
            ..*steady
        },
        Composites { force, ..at_rest },
    )
}

/// `M ÿ + k − q`
fn joint_forces(builder: &mut ArrayBuilder, setup: &Setup, composites: &Composites) -> ArrayId {
    let [forces] = builder.map(
        (
            "forces_at_joints",
            "Force along each joint, without springs and friction.",
        ),
        &[
            setup.screws,
            composites.force,
            setup.rotors,
            setup.last,
            setup.joint_forces,
        ],
        [("forces", 1)],
        |rows| {
            let bodies = motion_of(rows[0]).dot(force_of(rows[1]));
            [vec![bodies + rows[2][0] * rows[3][0] - rows[4][2]]]
        },
    );
    forces
}

/// What is left to accelerate.
fn remaining_forces(builder: &mut ArrayBuilder, setup: &Setup, composites: &Composites) -> ArrayId {
    let [remaining] = builder.map(
        (
            "remaining_forces",
            "What of the driving forces is left to accelerate.",
        ),
        &[setup.screws, composites.force, setup.last],
        [("remaining_force", 1)],
        |rows| [vec![rows[2][0] - motion_of(rows[0]).dot(force_of(rows[1]))]],
    );
    remaining
}

fn mass_matrix(builder: &mut ArrayBuilder, setup: &Setup, composites: &Composites) -> ArrayId {
    let [needed, diagonal] = builder.map(
        (
            "unit_accelerations",
            "What a unit acceleration of each joint needs.",
        ),
        &[setup.screws, composites.inertia, setup.rotors],
        [("unit_force", 6), ("diagonal", 1)],
        |rows| {
            let screw = motion_of(rows[0]);
            let force = moments_of(rows[1]).times(screw);
            [flat(force), vec![screw.dot(force) + rows[2][0]]]
        },
    );
    builder.pairs(
        (needed, setup.screws),
        (setup.screws, needed),
        diagonal,
        "mass_matrix",
    )
}

/// ∂/∂y and ∂/∂ẏ
fn jacobians(
    builder: &mut ArrayBuilder,
    setup: &Setup,
    motion: &Motions,
    composites: &Composites,
) -> (ArrayId, ArrayId) {
    let [gains, by_coordinate, by_velocity, stiffness, damping, own_stiffness, own_damping] = builder.map(
        ("disturbances", "How each joint disturbs the bodies beyond it, and what that asks of the joints before it."),
        &[
            setup.screws, motion.screw_rate, motion.velocity, motion.acceleration, composites.inertia, composites.flow, composites.force,
            setup.joint_forces,
        ],
        [
            ("gains", 9), ("by_coordinate", 9), ("by_velocity", 9), ("stiffness", 6), ("damping", 6), ("own_stiffness", 1), ("own_damping", 1),
        ],
        |[screw, screw_rate, velocity, acceleration, inertia, flow, force, joint]| {
            let (screw, rate) = (motion_of(screw), motion_of(screw_rate));
            let moments = moments_of(inertia);
            let (momentum, spin) = (vector(&flow[..3]), complement(&flow[3..]));
            let accelerated = motion_of(acceleration).cross(screw) + motion_of(velocity).cross(rate);
            let twice = rate.map(|x| x * 2.0);
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
        },
    );
    let mut pairs = |by_j, column, diagonal, name| {
        builder.pairs((gains, by_j), (setup.screws, column), diagonal, name)
    };
    (
        pairs(by_coordinate, stiffness, own_stiffness, "by_coordinates"),
        pairs(by_velocity, damping, own_damping, "by_velocities"),
    )
}

fn vector<'g>(rows: &Rows<'g>) -> Vector3<'g> {
    Vector3([rows[0], rows[1], rows[2]])
}

fn motion_of<'g>(rows: &Rows<'g>) -> Motion<'g> {
    let (angular, linear) = (vector(&rows[..3]), vector(&rows[3..]));
    Motion { angular, linear }
}

fn force_of<'g>(rows: &Rows<'g>) -> Force<'g> {
    let (moment, force) = (vector(&rows[..3]), vector(&rows[3..]));
    Force { moment, force }
}

fn flat(f: Force<'_>) -> Vec<Scalar<'_>> {
    f.entries().to_vec()
}

fn moments_of<'g>(rows: &Rows<'g>) -> MassMoments<'g> {
    MassMoments {
        mass: rows[0],
        first: vector(&rows[1..]),
        second: Symmetric3::new([rows[4], rows[5], rows[6], rows[7], rows[8], rows[9]]),
    }
}

fn entries_of<'g>(moments: &MassMoments<'g>) -> Vec<Scalar<'g>> {
    [
        &[moments.mass][..],
        &moments.first.0,
        &moments.second.entries(),
    ]
    .concat()
}

/// Moments of a body about the base's origin, in the axes of the base.
fn moved<'g>(axes: &Rows<'g>, origin: Vector3<'g>, own: MassMoments<'g>) -> MassMoments<'g> {
    let axes: [Vector3<'g>; 3] = [0, 1, 2].map(|k| vector(&axes[3 * k..]));
    let direction =
        |v: Vector3<'g>| axes[0].scaled(v[0]) + axes[1].scaled(v[1]) + axes[2].scaled(v[2]);
    let (s, first) = (own.second, direction(own.first));
    // R Σ, column by column, then (R Σ) Rᵀ.
    let half = s.columns().map(direction);
    let turned = |i: usize, j: usize| {
        (0..3).fold(own.mass.constant(0.0), |sum, k| {
            sum + half[k][i] * axes[k][j]
        })
    };
    let turned = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| turned(i, j));
    let carried = origin.scaled(own.mass);
    let middle = first + carried.map(|x| x * 0.5);
    MassMoments {
        mass: own.mass,
        first: first + carried,
        second: Symmetric3::new(turned) + Symmetric3::symmetric_product(middle, origin),
    }
}

/// `2 ∫ ṙ dm` and `2 ∫ ṙ rᵀ dm`
fn flow_of<'g>(moments: &MassMoments<'g>, velocity: Motion<'g>) -> (Vector3<'g>, Matrix3<'g>) {
    let Motion {
        angular: omega,
        linear: v,
    } = velocity.map(|x| x * 2.0);
    let spin = Matrix3::cross_of(omega, moments.second);
    (
        v.scaled(moments.mass) + omega.cross(moments.first),
        Matrix3::from_fn(|i, j| spin[i][j] + v[i] * moments.first[j]),
    )
}

/// `2B s` with the angular part of s.
fn swept<'g>(spin: &Matrix3<'g>, momentum: Vector3<'g>, angular: Vector3<'g>) -> Force<'g> {
    Force {
        moment: spin.times(angular),
        force: angular.cross(momentum),
    }
}

/// `tr A − A` of nine entries, rows first.
fn complement<'g>(a: &Rows<'g>) -> Matrix3<'g> {
    Matrix3([
        [a[4] + a[8], -a[1], -a[2]],
        [-a[3], a[0] + a[8], -a[5]],
        [-a[6], -a[7], a[0] + a[4]],
    ])
}
