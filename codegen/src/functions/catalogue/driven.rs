//! Functions of robots with driven joints. The prescribed motion of these joints is an argument of the
//! functions.

use super::quantity::Argument::{Accelerations, Coordinates, Velocities};
use super::quantity::{Quantity, vector};
use crate::dynamics::arguments::Arguments;
use crate::function_names as names;
use crate::layout::Dimension;

/// Functions that only robots with driven joints (with prescribed motion) have.
pub const QUANTITIES: &[Quantity] = &[Quantity {
    name: names::DRIVING_FORCES,
    summary: "Driving forces: forces that produce the prescribed motion of the driven joints.",
    equation: "the rows of M ÿ + k − q for the driven joints",
    arguments: &[Coordinates, Velocities, Accelerations],
    results: &[(
        "f_d",
        &[Dimension::Fixed],
        "one entry per driven joint, in the order of `DRIVEN_NAMES`; a positive force acts in the positive direction of the joint",
    )],
    notes: &[
        "Includes all forces at the joint except gravity, springs and friction. Forces of inputs are included.",
    ],
    build: |equations, Arguments { y, v, a, .. }| {
        let forces = equations.inverse_dynamics(y, v, a);
        vec![vector(forces[equations.model.coordinates.len()..].to_vec())]
    },
    ..Quantity::PLAIN
}];
