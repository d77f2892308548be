//! Jacobians of the forward dynamics with loops only for the products with M⁻¹.
//!
//! If branches are short, most entries of M and of the Jacobians of the inverse dynamics are zero, and
//! straight-line code omits them. Therefore M, M⁻¹, the accelerations and the Jacobians of the inverse
//! dynamics are straight-line code. M⁻¹ is dense if the base moves, so the products with M⁻¹ are loops.

use super::builder::ArrayBuilder;
use super::tree::LoopJoints;
use crate::dynamics::arguments::Arguments;
use crate::dynamics::equations::Equations;
use crate::kinematics::{Mechanism, Number};
use crate::program::arrays::{ArrayId, Arrays};
use crate::program::{InputArray, Shape};

/// Whether each joint of the mechanism is independent. [`forward_dynamics_derivatives_by_products`] requires
/// this.
pub fn products_are_possible(mechanism: &Mechanism<Number>) -> bool {
    LoopJoints::new(mechanism).coordinates(mechanism).is_none()
}

/// Array form of the function `forward_dynamics_derivatives`, with loops only for the products with M⁻¹.
pub fn forward_dynamics_derivatives_by_products<'g>(
    equations: &Equations<'_, 'g>,
    arguments: &Arguments<'g>,
    inputs: Vec<InputArray>,
) -> Arrays {
    let mechanism = equations.mechanism();
    let loops = LoopJoints::new(&mechanism);
    let mut builder = ArrayBuilder::new(loops.tree.clone(), None, loops.chains(&mechanism));
    let Arguments { y, v, u, .. } = arguments;
    let accelerated = equations.accelerated_forces(y, v, u);
    let forces = accelerated.forces;
    let accelerations = builder.set_up("accelerations", vec![accelerated.accelerations]);
    let inverse = builder.set_up_matrix("inverse", accelerated.inverse);
    let by_coordinates = builder.set_up_matrix("forces_by_coordinates", forces.by_coordinates);
    let by_velocities = builder.set_up_matrix("forces_by_velocities", forces.by_velocities);
    put_derivatives(&mut builder, accelerations, inverse, [by_coordinates, by_velocities]);
    builder.finish_from_leaves(equations.graph, inputs)
}

/// Declares the results `ÿ`, `∂ÿ/∂y = −M⁻¹ ∂n/∂y`, `∂ÿ/∂ẏ = −M⁻¹ ∂n/∂ẏ` and the inverse mass matrix `M⁻¹`.
///
/// - `forces`: derivatives ∂n/∂y and ∂n/∂ẏ of the forces n that the accelerations require
pub(super) fn put_derivatives(
    builder: &mut ArrayBuilder,
    accelerations: ArrayId,
    inverse: ArrayId,
    forces: [ArrayId; 2],
) {
    let n = builder.each_coordinate();
    builder.output("ÿ", Shape::Vector(n), accelerations);
    let results = [("∂ÿ/∂y", "accelerations_by_coordinates"), ("∂ÿ/∂ẏ", "accelerations_by_velocities")];
    for ((result, name), matrix) in results.into_iter().zip(forces) {
        let product = builder.negative_product(inverse, matrix, name);
        builder.output(result, Shape::Matrix(n, n), product);
    }
    builder.output("M⁻¹", Shape::Matrix(n, n), inverse);
}
