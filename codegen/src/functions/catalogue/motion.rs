//! Functions of the equations of motion, and functions derived from these equations.

use super::frame_inputs;
use super::quantity::Argument::{Accelerations, Coordinates, Inputs, Velocities};
use super::quantity::{
    BY_INPUTS, Estimate, Loops, Products, Quantity, SCALAR, SQUARE, VECTOR, Value, matrix, scalar, vector,
};
use crate::dynamics::arguments::Arguments;
use crate::dynamics::equations::Equations;
use crate::dynamics::per_joint;
use crate::dynamics::recursion::motion::MotionInput;
use crate::function_names;
use crate::functions::module_constants;

/// Functions of the equations of motion, and functions derived from these equations.
pub(super) const QUANTITIES: &[Quantity] = &[
    Quantity {
        name: function_names::MASS_MATRIX,
        summary: "Mass matrix `M(y)`.",
        equation: "M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u",
        arguments: &[Coordinates],
        results: &[("M", SQUARE, "symmetric, positive definite, both triangles filled")],
        notes: &["Composite rigid bodies (Walker and Orin 1982; Featherstone 2008, ch. 6), rotors included."],
        build: |equations, arguments| vec![matrix(equations.mass_matrix(&arguments.y))],
        constants: |_, _, program| module_constants::patterns(program, &[("MASS_MATRIX_NONZERO", "M")]),
        straight_size: Some(Estimate::MassMatrix),
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::CORIOLIS_FORCES,
        summary: "Coriolis, centrifugal and gyroscopic forces `k(y, ẏ)`.",
        equation: "M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u",
        arguments: &[Coordinates, Velocities],
        results: &[("k", VECTOR, "on the left-hand side, without gravity, springs and friction")],
        notes: &["Recursive Newton–Euler equations without gravity and accelerations."],
        build: |equations, arguments| vec![vector(equations.coriolis_forces(&arguments.y, &arguments.v))],
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::GRAVITY_FORCES,
        summary: "Generalized forces of gravity, a part of the applied forces q.",
        equation: "q = gravity_forces + spring_forces − friction_torques",
        arguments: &[Coordinates],
        results: &[(
            "q_gravity",
            VECTOR,
            "a positive force acts in the positive direction of the joint; equals −∂V/∂y",
        )],
        build: |equations, arguments| vec![vector(equations.gravity_forces(&arguments.y))],
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::SPRING_FORCES,
        summary: "Generalized forces of springs and dampers, a part of the applied forces q.",
        equation: "q = gravity_forces + spring_forces − friction_torques",
        arguments: &[Coordinates, Velocities],
        results: &[("q_springs", VECTOR, "a positive force acts in the positive direction of the joint")],
        build: |equations, arguments| vec![vector(equations.spring_forces(&arguments.y, &arguments.v))],
        ..Quantity::PLAIN
    },
    FRICTION_TORQUES,
    Quantity {
        name: function_names::APPLIED_FORCES,
        summary: "Applied forces `q(y, ẏ)`.",
        equation: "q = gravity_forces + spring_forces − friction_torques",
        arguments: &[Coordinates, Velocities],
        results: &[("q", VECTOR, "on the right-hand side, without the inputs")],
        build: |equations, arguments| vec![vector(equations.applied_forces(&arguments.y, &arguments.v))],
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::BIAS_FORCES,
        summary: "Bias forces `k − q_gravity`.",
        equation: "k − gravity_forces",
        arguments: &[Coordinates, Velocities],
        results: &[("b", VECTOR, "forces that hold the accelerations at zero, without springs and friction")],
        notes: &["Recursive Newton–Euler equations at ÿ = 0. Pinocchio calls this `nle`."],
        build: |equations, arguments| vec![vector(equations.bias_forces(&arguments.y, &arguments.v))],
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::INPUT_MATRIX,
        summary: "Input matrix `B`.",
        equation: "M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u",
        arguments: &[],
        results: &[("B", BY_INPUTS, "gear ratios, times motor constants for inputs that are currents")],
        build: |equations, _| vec![matrix(equations.input_matrix(&[]))],
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::EQUATIONS_OF_MOTION,
        summary: "Mass matrix, Coriolis forces and applied forces at once.",
        equation: "M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u",
        arguments: &[Coordinates, Velocities],
        results: &[
            ("M", SQUARE, "symmetric, positive definite, both triangles filled"),
            ("k", VECTOR, "Coriolis, centrifugal and gyroscopic forces"),
            ("q", VECTOR, "gravity, springs and friction"),
        ],
        notes: &["Common terms are computed once."],
        build: |equations, arguments| {
            let (y, v) = (&arguments.y, &arguments.v);
            let k = equations.coriolis_forces(y, v);
            vec![matrix(equations.mass_matrix(y)), vector(k), vector(equations.applied_forces(y, v))]
        },
        straight_size: Some(Estimate::MassMatrix),
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::INVERSE_DYNAMICS,
        summary: "Inverse dynamics: the drive forces that produce a motion.",
        equation: "M(y) ÿ + k(y, ẏ) − q(y, ẏ)",
        arguments: &[Coordinates, Velocities, Accelerations],
        results: &[(
            "B u",
            VECTOR,
            "drive forces at the joints; the feedforward inputs are u_ff = B⁻¹ (B u)",
        )],
        notes: &["Recursive Newton–Euler equations (Luh, Walker and Paul 1980) with base parameters."],
        build: |equations, arguments| {
            vec![vector(equations.inverse_dynamics(&arguments.y, &arguments.v, &arguments.a))]
        },
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::FORWARD_DYNAMICS,
        summary: "Forward dynamics: the accelerations that inputs cause.",
        equation: "ÿ = M⁻¹ (q + B u − k)",
        arguments: &[Coordinates, Velocities, Inputs],
        results: &[("ÿ", VECTOR, "accelerations")],
        build: |equations, arguments| {
            vec![vector(equations.forward_dynamics(&arguments.y, &arguments.v, &arguments.u))]
        },
        route: |formulations| Some(formulations.forward_dynamics().description()),
        straight_size: Some(Estimate::MassMatrix),
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::MASS_MATRIX_AND_BIAS_FORCES,
        summary: "Mass matrix and bias forces at once.",
        equation: "M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u",
        arguments: &[Coordinates, Velocities],
        results: &[
            ("M", SQUARE, "symmetric, positive definite, both triangles filled"),
            (
                "b",
                VECTOR,
                "k − gravity_forces: forces that hold the accelerations at zero, without springs and friction",
            ),
        ],
        notes: &["Common terms are computed once."],
        build: |equations, arguments| {
            let (mass, bias) = equations.mass_matrix_and_bias(&arguments.y, &arguments.v);
            vec![matrix(mass), vector(bias)]
        },
        straight_size: Some(Estimate::MassMatrix),
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::INVERSE_DYNAMICS_DERIVATIVES,
        differentiates_friction: true,
        summary: "Inverse dynamics with its Jacobians.",
        equation: "δ(M ÿ + k − q) = ∂/∂y δy + ∂/∂ẏ δẏ + M δÿ",
        arguments: &[Coordinates, Velocities, Accelerations],
        results: &[
            ("B u", VECTOR, "the forces M ÿ + k − q, on the joint side"),
            ("∂/∂y", SQUARE, "row i = force i"),
            ("∂/∂ẏ", SQUARE, "row i = force i, friction included"),
        ],
        notes: DERIVATIVE_NOTES,
        build: |equations, Arguments { y, v, a, .. }| {
            let result = equations.inverse_dynamics_derivatives(MotionInput { y, v, a });
            vec![vector(result.forces), matrix(result.by_coordinates), matrix(result.by_velocities)]
        },
        route: |formulations| Some(formulations.derivatives().description()),
        straight_size: Some(Estimate::MassMatrix),
        loops: Some(Loops::PerJoint {
            build: per_joint::inverse_dynamics_derivatives,
            size: Estimate::Pairs,
            products: None,
        }),
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::INVERSE_DYNAMICS_DERIVATIVES_AND_MASS_MATRIX,
        differentiates_friction: true,
        summary: "Inverse dynamics with all its Jacobians; the Jacobian by the accelerations is `M(y)`.",
        equation: "δ(M ÿ + k − q) = ∂/∂y δy + ∂/∂ẏ δẏ + M δÿ",
        arguments: &[Coordinates, Velocities, Accelerations],
        results: &[
            ("B u", VECTOR, "the forces M ÿ + k − q, on the joint side"),
            ("∂/∂y", SQUARE, "row i = force i"),
            ("∂/∂ẏ", SQUARE, "row i = force i, friction included"),
            ("M", SQUARE, "symmetric, positive definite, both triangles filled"),
        ],
        notes: DERIVATIVE_NOTES,
        build: |equations, Arguments { y, v, a, .. }| {
            let result = equations.inverse_dynamics_derivatives(MotionInput { y, v, a });
            let jacobians = [result.by_coordinates, result.by_velocities, result.mass_matrix].map(matrix);
            std::iter::once(vector(result.forces)).chain(jacobians).collect()
        },
        route: |formulations| Some(formulations.derivatives().description()),
        straight_size: Some(Estimate::MassMatrix),
        loops: Some(Loops::PerJoint {
            build: per_joint::inverse_dynamics_derivatives_and_mass_matrix,
            size: Estimate::Pairs,
            products: None,
        }),
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::FORWARD_DYNAMICS_DERIVATIVES,
        differentiates_friction: true,
        summary: "Forward dynamics with its Jacobians.",
        equation: "∂ÿ = −M⁻¹ ∂(M ÿ + k − q), ∂ÿ/∂(B u) = M⁻¹",
        arguments: &[Coordinates, Velocities, Inputs],
        results: &[
            ("ÿ", VECTOR, "accelerations"),
            ("∂ÿ/∂y", SQUARE, "row i = acceleration i"),
            ("∂ÿ/∂ẏ", SQUARE, "row i = acceleration i"),
            ("M⁻¹", SQUARE, "symmetric, both triangles filled; ∂ÿ/∂u = M⁻¹ B"),
        ],
        notes: DERIVATIVE_NOTES,
        build: |equations, Arguments { y, v, u, .. }| {
            let result = equations.forward_dynamics_derivatives(y, v, u);
            let jacobians = [result.by_coordinates, result.by_velocities, result.inverse].map(matrix);
            std::iter::once(vector(result.accelerations)).chain(jacobians).collect()
        },
        route: |formulations| Some(formulations.derivatives().description()),
        straight_size: Some(Estimate::MassMatrix),
        loops: Some(Loops::PerJoint {
            build: per_joint::forward_dynamics_derivatives,
            size: Estimate::Inverse,
            products: Some(Products {
                build: per_joint::forward_dynamics_derivatives_by_products,
                beside: function_names::INVERSE_DYNAMICS_DERIVATIVES_AND_MASS_MATRIX,
            }),
        }),
        ..Quantity::PLAIN
    },
    LINEARIZE,
    Quantity {
        name: function_names::KINETIC_ENERGY,
        summary: "Kinetic energy, rotors included.",
        equation: "T = ½ ẏᵀ M ẏ",
        arguments: &[Coordinates, Velocities],
        results: &[("T", SCALAR, "energy [J]")],
        build: |equations, arguments| vec![scalar(equations.kinetic_energy(&arguments.y, &arguments.v))],
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::POTENTIAL_ENERGY,
        summary: "Potential energy of gravity.",
        equation: "V = −g · Σ m c",
        arguments: &[Coordinates],
        results: &[(
            "V",
            SCALAR,
            "energy [J] of the moving bodies without springs, 0 if the centre of mass is at the height of the base frame's origin",
        )],
        build: |equations, arguments| vec![scalar(equations.potential_energy(&arguments.y))],
        describe: frame_inputs::describe_energy,
        ..Quantity::PLAIN
    },
];

/// The function of friction torques that depend only on the velocities.
const FRICTION_TORQUES: Quantity = Quantity {
    name: function_names::FRICTION_TORQUES,
    summary: "Joint friction `τ(ẏ)`.",
    equation: "q = gravity_forces + spring_forces − friction_torques",
    arguments: &[Velocities],
    results: &[("τ", VECTOR, "friction at the joint, positive for positive velocity")],
    build: friction_torques,
    ..Quantity::PLAIN
};

/// The function `linearize` for robots without quaternions.
const LINEARIZE: Quantity = Quantity {
    name: function_names::LINEARIZE,
    differentiates_friction: true,
    summary: "Linearization of the accelerations in continuous time.",
    equation: "ÿ ≈ A_y y + A_v ẏ + B_x u + c; with x = (y, ẏ) the upper halves of A, B_x and c are [0 I], 0 and 0",
    arguments: &[Coordinates, Velocities, Inputs],
    results: &[
        ("A_y", SQUARE, "∂ÿ/∂y, row i = acceleration i"),
        ("A_v", SQUARE, "∂ÿ/∂ẏ, row i = acceleration i"),
        ("B_x", BY_INPUTS, "∂ÿ/∂u, row i = acceleration i"),
        ("c", VECTOR, "affine remainder ÿ − A_y y − A_v ẏ − B_x u"),
    ],
    notes: DERIVATIVE_NOTES,
    build: |equations, Arguments { y, v, u, .. }| {
        let result = equations.linearize(y, v, u);
        let jacobians = [result.by_coordinates, result.by_velocities, result.by_inputs].map(matrix);
        jacobians.into_iter().chain([vector(result.remainder)]).collect()
    },
    route: |formulations| Some(formulations.derivatives().description()),
    constants: |_, _, program| {
        module_constants::patterns(
            program,
            &[("A_Y_NONZERO", "A_y"), ("A_V_NONZERO", "A_v"), ("B_X_NONZERO", "B_x")],
        )
    },
    straight_size: Some(Estimate::MassMatrix),
    loops: Some(Loops::Affine { called: function_names::FORWARD_DYNAMICS_DERIVATIVES }),
    ..Quantity::PLAIN
};

/// The function `linearize` for robots with quaternions, whose states are deviations from the given
/// positions.
pub(super) const LINEARIZE_ON_TANGENT: Quantity = Quantity {
    summary: "Linearization of the accelerations in continuous time, on the tangent.",
    equation: "with δ from y: δ̇ ≈ D δ + v − v̄ and v̇ ≈ A_y δ + A_v v + B_x u + c",
    results: &[
        ("A_y", SQUARE, "∂v̇/∂δ, row i = acceleration i"),
        ("A_v", SQUARE, "∂v̇/∂v, row i = acceleration i"),
        ("B_x", BY_INPUTS, "∂v̇/∂u, row i = acceleration i"),
        ("c", VECTOR, "affine remainder v̇ − A_v v̄ − B_x u at δ = 0"),
        ("D", SQUARE, "−ad_v̄ in the rows of a spherical or floating joint, 0 in all other rows"),
    ],
    notes: &[
        DERIVATIVE_NOTES[0],
        "δ is a small displacement: the positions are `integrate(y, δ)`. v̄ is the argument `v`, the velocities of the \
         linearization. For joints without quaternions δ is the difference of the positions.",
    ],
    build: |equations, Arguments { y, v, u, .. }| {
        let result = equations.linearize(y, v, u);
        let jacobians = [result.by_coordinates, result.by_velocities, result.by_inputs].map(matrix);
        let rest = [vector(result.remainder), matrix(equations.drift(v))];
        jacobians.into_iter().chain(rest).collect()
    },
    ..LINEARIZE
};

/// The function of the input matrix B for inputs at frames, with which B depends on the positions.
pub(super) const INPUT_MATRIX_BY_POSITION: Quantity = Quantity {
    name: function_names::INPUT_MATRIX,
    summary: "Input matrix `B(y)`.",
    equation: "M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B(y) u",
    arguments: &[Coordinates],
    results: &[(
        "B",
        BY_INPUTS,
        "generalized forces of one unit of each input: gear ratios for drives, times motor constants for currents; for \
         inputs at frames `Jᵀ` times the wrench, or `−∂l/∂y` for inputs that shorten the distance l",
    )],
    build: |equations, arguments| vec![matrix(equations.input_matrix(&arguments.y))],
    ..Quantity::PLAIN
};

/// The function of friction torques that depend on positions and velocities.
pub(super) const FRICTION_BY_POSITION: Quantity = Quantity {
    summary: "Joint friction `τ(y, ẏ)`.",
    arguments: &[Coordinates, Velocities],
    results: &[("τ", VECTOR, "friction at the joint, positive if it brakes a positive velocity")],
    ..FRICTION_TORQUES
};

fn friction_torques<'g>(equations: &Equations<'_, 'g>, arguments: &Arguments<'g>) -> Vec<Value<'g>> {
    vec![vector(equations.friction_torques(&arguments.y, &arguments.v))]
}

const DERIVATIVE_NOTES: &[&str] =
    &["Analytic, with composite bodies (Carpentier and Mansard 2018; Singh, Russell and Wensing 2022)."];
