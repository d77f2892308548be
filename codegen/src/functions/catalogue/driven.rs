//! What the catalogue says of robots with driven joints, whose motion is an argument.

use super::quantity::Argument::{Accelerations, Coordinates, Velocities};
use super::quantity::{Quantity, vector};
use crate::dynamics::arguments::Arguments;
use crate::functions::function::Function;
use crate::layout::Dimension;
use crate::model::Model;

/// The rows that only robots with driven joints have; they are derived where they are asked for by name.
pub const QUANTITIES: &[Quantity] = &[Quantity {
    name: "driving_forces",
    summary: "Driving forces: what moves the driven joints as prescribed.",
    equation: "the rows of M ÿ + k − q that belong to the driven joints",
    arguments: &[Coordinates, Velocities, Accelerations],
    results: &[(
        "f_d",
        &[Dimension::Fixed],
        "by driven joint, in the order of `DRIVEN_NAMES`; positive where it drives the joint forwards",
    )],
    notes: &[
        "All that acts at the joint but gravity, springs and friction. Where an input acts on a driven joint too, its share is in \
         here.",
    ],
    build: |equations, Arguments { y, v, a, .. }| {
        let forces = equations.inverse_dynamics(y, v, a);
        vec![vector(forces[equations.model.coordinates.len()..].to_vec())]
    },
    ..Quantity::PLAIN
}];

/// The rows of a model.
pub fn rows(model: &Model) -> &'static [Quantity] {
    match model.driven.is_empty() {
        true => &[],
        false => QUANTITIES,
    }
}

/// Says what is otherwise.
pub fn describe(model: &Model, function: &mut Function) {
    if model.driven.is_empty() {
        return;
    }
    const BIAS: &str = "It contains M_d d̈, the inertial forces of the driven joints' accelerations, so that M ÿ + k = q + B u holds \
        for the other joints.";
    const COLUMNS: &str = "The columns of the driven joints stand behind those of the coordinates.";
    let note = match function.name.as_str() {
        "coriolis_forces" | "bias_forces" | "equations_of_motion" | "mass_matrix_and_bias_forces" => BIAS,
        "kinetic_energy" => {
            "½ (ẏ, ḋ)ᵀ M (ẏ, ḋ)".clone_into(&mut function.equation);
            "With the mass matrix of all joints, the driven ones included."
        }
        "joint_wrenches" => "The rows of the driven joints stand behind those of the coordinates.",
        "center_of_mass_jacobian" | "centroidal_momentum_matrix" => COLUMNS,
        name if name.starts_with("frame_") && name.ends_with("_jacobian") => COLUMNS,
        name if name.starts_with("frame_") && name.ends_with("_times_velocity") => {
            "The driven joints are accelerated as d says."
        }
        _ => return,
    };
    function.notes.push(note.to_owned());
}
