//! Functions and notes of robots with forces at frames. With inputs at frames, the input matrix B depends on
//! the coordinates.

use super::kind::{Difference, notes};
use super::quantity::Argument::{Coordinates, Inputs};
use super::quantity::{Quantity, SQUARE, VECTOR, matrix, vector};
use crate::function_names;
use crate::functions::function::Function;
use crate::model::{Model, PointForce};
use crate::wording;
use gelenk_formula::Formula;

/// Functions that only robots with inputs at frames have.
pub const QUANTITIES: &[Quantity] = &[Quantity {
    name: function_names::INPUT_FORCES_DERIVATIVES,
    summary: "Generalized forces of the inputs with their Jacobian.",
    equation: "δ(B(y) u) = ∂/∂y δy + B δu",
    arguments: &[Coordinates, Inputs],
    results: &[("B u", VECTOR, "on the joint side"), ("∂/∂y", SQUARE, "row i = force i")],
    build: |equations, arguments| {
        let (forces, by_coordinates) = equations.input_forces_derivatives(&arguments.y, &arguments.u);
        vec![vector(forces), matrix(by_coordinates)]
    },
    ..Quantity::PLAIN
}];

/// Note on the joint wrenches of a robot with forces at frames.
pub(super) const fn beyond() -> Difference {
    notes(&[
        "A row includes forces at frames beyond its joint (springs, inputs, wrenches). The joint itself \
         transmits the row minus these forces.",
    ])
}

/// Adds a sentence to the documentation of the potential energy: which forces between frames it includes.
pub fn describe_energy(model: &Model, function: &mut Function) {
    let forces = |wanted: fn(Option<&Formula>) -> bool| -> Vec<&PointForce> {
        model.point_forces.iter().filter(|force| wanted(force.law.energy().as_ref())).collect()
    };
    // Dampers have no energy, so they are neither included nor excluded.
    let known = forces(|energy| energy.is_some_and(|energy| !energy.is_zero()));
    let unknown = forces(|energy| energy.is_none());
    let named = |forces: &[&PointForce]| wording::list(forces.iter().map(|force| force.name.as_str()));
    if !known.is_empty() {
        "Potential energy of gravity and of forces between frames.".clone_into(&mut function.summary);
        "V = −g · Σ m c + Σ ∫ F(l, l̇ = 0) dl".clone_into(&mut function.equation);
        "energy [J] without springs of joints; the part of gravity is 0 if the centre of mass is at the height of the base frame's origin"
            .clone_into(&mut function.results[0]);
        function.notes.push(format!(
            "Includes the force laws of {} at standstill. The energy of a summand c (l − l₀)ⁿ is 0 at the distance \
             l = l₀. The energy of any other polynomial is 0 at l = 0.",
            named(&known)
        ));
    }
    if !unknown.is_empty() {
        function.notes.push(format!(
            "Excludes the force laws of {}, which are not polynomials of the distance.",
            named(&unknown)
        ));
    }
}
