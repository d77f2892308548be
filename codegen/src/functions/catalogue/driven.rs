//! Catalogue texts of robots with driven joints, whose motion is an argument.

use super::otherwise::{Otherwise, Robots};
use super::quantity::Argument::{Accelerations, Coordinates, Velocities};
use super::quantity::{Quantity, vector};
use crate::dynamics::arguments::Arguments;
use crate::function_names;
use crate::layout::Dimension;

/// The rows that only robots with driven joints have; they are derived if they are asked for by name.
pub const QUANTITIES: &[Quantity] = &[Quantity {
    name: function_names::DRIVING_FORCES,
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

/// The inertial forces of the driven joints' accelerations are not part of M ÿ.
pub const BIAS: Otherwise = Otherwise {
    notes: &[
        "It contains M_d d̈, the inertial forces of the driven joints' accelerations, so that M ÿ + k = q + B u holds for the other \
         joints.",
    ],
    ..Otherwise::of(Robots::Driven)
};

/// The kinetic energy is that of all joints.
pub const ENERGY: Otherwise = Otherwise {
    equation: Some("½ (ẏ, ḋ)ᵀ M (ẏ, ḋ)"),
    notes: &["With the mass matrix of all joints, the driven ones included."],
    ..Otherwise::of(Robots::Driven)
};

/// Driven joints have rows too.
pub const ROWS: Otherwise = Otherwise {
    notes: &["The rows of the driven joints stand behind those of the coordinates."],
    ..Otherwise::of(Robots::Driven)
};

/// Driven joints have columns too.
pub const COLUMNS: Otherwise = Otherwise {
    notes: &["The columns of the driven joints stand behind those of the coordinates."],
    ..Otherwise::of(Robots::Driven)
};

/// At ÿ = 0 the driven joints are accelerated nevertheless.
pub const ACCELERATED: Otherwise =
    Otherwise { notes: &["The driven joints are accelerated as d says."], ..Otherwise::of(Robots::Driven) };
