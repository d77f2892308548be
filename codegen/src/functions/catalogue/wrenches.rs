//! Functions of robots with wrenches as arguments.

use super::quantity::Argument::{Accelerations, Coordinates, Inputs, Velocities, Wrenches};
use super::quantity::{Estimate, Quantity, SQUARE, VECTOR, matrix, vector};
use crate::dynamics::arguments::Arguments;
use crate::dynamics::recursion::motion::MotionInput;
use crate::function_names;

const MOTION: &str = "M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u + wrench_forces(y, w)";

/// Functions that only robots with wrenches as arguments have.
pub const QUANTITIES: &[Quantity] = &[
    Quantity {
        name: function_names::WRENCH_FORCES,
        summary: "Generalized forces of the wrenches.",
        equation: "Σ Jᵀ w over the wrenches w, with the Jacobian J of each wrench's frame",
        arguments: &[Coordinates, Wrenches],
        results: &[("q_w", VECTOR, "a positive force acts in the positive direction of the joint")],
        build: |equations, Arguments { y, w, .. }| vec![vector(equations.wrench_forces(y, w))],
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::WRENCH_FORCES_DERIVATIVES,
        summary: "Generalized forces of the wrenches with their Jacobian.",
        equation: "δ(Σ Jᵀ w) = ∂/∂y δy + Σ Jᵀ δw",
        arguments: &[Coordinates, Wrenches],
        results: &[
            ("q_w", VECTOR, "a positive force acts in the positive direction of the joint"),
            ("∂/∂y", SQUARE, "row i = force i; a wrench in the axes of its frame turns with it"),
        ],
        build: |equations, Arguments { y, w, .. }| {
            let (forces, by_coordinates) = equations.wrench_forces_derivatives(y, w);
            vec![vector(forces), matrix(by_coordinates)]
        },
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::INVERSE_DYNAMICS_WITH_WRENCHES,
        summary: "Inverse dynamics: the drive forces that produce a motion under wrenches.",
        equation: "M(y) ÿ + k(y, ẏ) − q(y, ẏ) − wrench_forces(y, w)",
        arguments: &[Coordinates, Velocities, Accelerations, Wrenches],
        results: &[("B u", VECTOR, "drive forces at the joints")],
        build: |equations, Arguments { y, v, a, w, .. }| {
            vec![vector(equations.inverse_dynamics_with_wrenches(MotionInput { y, v, a }, w))]
        },
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::FORWARD_DYNAMICS_WITH_WRENCHES,
        summary: "Forward dynamics: the accelerations that inputs and wrenches cause.",
        equation: MOTION,
        arguments: &[Coordinates, Velocities, Inputs, Wrenches],
        results: &[("ÿ", VECTOR, "accelerations")],
        build: |equations, Arguments { y, v, u, w, .. }| {
            vec![vector(equations.forward_dynamics_with_wrenches(y, v, u, w))]
        },
        route: |formulations| Some(formulations.forward_dynamics().description()),
        straight_size: Some(Estimate::MassMatrix),
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::INVERSE_DYNAMICS_DERIVATIVES_WITH_WRENCHES,
        differentiates_friction: true,
        summary: "Inverse dynamics under wrenches with its Jacobians.",
        equation: "δ(M ÿ + k − q − Σ Jᵀ w) = ∂/∂y δy + ∂/∂ẏ δẏ + M δÿ − Σ Jᵀ δw",
        arguments: &[Coordinates, Velocities, Accelerations, Wrenches],
        results: &[
            ("B u", VECTOR, "the forces M ÿ + k − q − Σ Jᵀ w, on the joint side"),
            ("∂/∂y", SQUARE, "row i = force i; a wrench in the axes of its frame turns with it"),
            ("∂/∂ẏ", SQUARE, "row i = force i, friction included"),
        ],
        build: |equations, Arguments { y, v, a, w, .. }| {
            let result = equations.inverse_dynamics_derivatives_with_wrenches(MotionInput { y, v, a }, w);
            vec![vector(result.forces), matrix(result.by_coordinates), matrix(result.by_velocities)]
        },
        route: |formulations| Some(formulations.derivatives().description()),
        straight_size: Some(Estimate::MassMatrix),
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::FORWARD_DYNAMICS_DERIVATIVES_WITH_WRENCHES,
        differentiates_friction: true,
        summary: "Forward dynamics under wrenches with its Jacobians.",
        equation: "∂ÿ = −M⁻¹ ∂(M ÿ + k − q − B u − Σ Jᵀ w), ∂ÿ/∂(B u) = M⁻¹",
        arguments: &[Coordinates, Velocities, Inputs, Wrenches],
        results: &[
            ("ÿ", VECTOR, "accelerations"),
            ("∂ÿ/∂y", SQUARE, "row i = acceleration i"),
            ("∂ÿ/∂ẏ", SQUARE, "row i = acceleration i"),
            ("M⁻¹", SQUARE, "symmetric, both triangles filled; ∂ÿ/∂u = M⁻¹ B"),
        ],
        build: |equations, Arguments { y, v, u, w, .. }| {
            let result = equations.forward_dynamics_derivatives_with_wrenches(y, v, u, w);
            let jacobians = [result.by_coordinates, result.by_velocities, result.inverse].map(matrix);
            std::iter::once(vector(result.accelerations)).chain(jacobians).collect()
        },
        route: |formulations| Some(formulations.derivatives().description()),
        straight_size: Some(Estimate::MassMatrix),
        ..Quantity::PLAIN
    },
];
