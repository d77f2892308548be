//! What the catalogue says of robots with spherical and floating joints.

use super::motion::LINEARIZE_ON_TANGENT;
use super::quantity::Quantity;
use crate::functions::function::Function;
use crate::model::Model;

/// The rows that replace those of the same name.
pub fn rows(model: &Model) -> &'static [Quantity] {
    match model.quaternion_joints.is_empty() {
        true => &[],
        false => LINEARIZE_ON_TANGENT,
    }
}

/// Functions whose derivatives by positions are taken along small motions.
const ALONG: [&str; 7] = [
    "inverse_dynamics_derivatives",
    "inverse_dynamics_derivatives_and_mass_matrix",
    "forward_dynamics_derivatives",
    "wrench_forces_derivatives",
    "inverse_dynamics_derivatives_with_wrenches",
    "forward_dynamics_derivatives_with_wrenches",
    "inverse_dynamics_hessian",
];

/// Says what ∂/∂y means, and what rows belong to a joint with a quaternion.
pub fn describe(model: &Model, function: &mut Function) {
    if model.quaternion_joints.is_empty() {
        return;
    }
    if ALONG.contains(&function.name.as_str()) {
        let note = "Column j of ∂/∂y is the derivative along ⊕: of `δ ↦ f(integrate(y, δ))` by δ_j at 0, with the velocities \
                    held in the frames of their bodies.";
        function.notes.push(note.to_owned());
    }
    if function.name == "joint_wrenches" {
        let note = "A spherical or floating joint has one row, in the place of its last velocity.";
        function.notes.push(note.to_owned());
    }
}
