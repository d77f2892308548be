//! Robots with driven joints, whose motion is an argument.

use super::quantity::Argument::{Accelerations, Coordinates, Velocities};
use super::quantity::{Quantity, vector};
use crate::dynamics::arguments::Arguments;
use crate::function_names as names;
use crate::layout::Dimension;

/// The functions that only these robots have.
pub const QUANTITIES: &[Quantity] = &[Quantity {
    name: names::DRIVING_FORCES,
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
