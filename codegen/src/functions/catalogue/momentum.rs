//! Functions of the centre of mass and of the momentum about it.

use super::quantity::Argument::{Coordinates, Velocities};
use super::quantity::{FRAME_JACOBIAN, IN_SPACE, Quantity, matrix, vector};
use crate::dynamics::arguments::Arguments;
use crate::function_names;

const NOTES: &[&str] = &[
    "Includes all moving bodies, in the axes of the base frame. Excludes bodies on a fixed base. Rotors with \
     `coupling = \"body\"` spin with their gear ratio.",
];

/// Functions of the centre of mass and momentum. They are derived only if they are requested by name.
pub const QUANTITIES: [Quantity; 4] = [
    Quantity {
        name: function_names::CENTER_OF_MASS,
        summary: "Centre of mass of the moving bodies.",
        equation: "c = Σ m_i c_i / Σ m_i",
        arguments: &[Coordinates],
        results: &[("c", IN_SPACE, "in the base frame (m)")],
        notes: NOTES,
        build: |equations, Arguments { y, .. }| vec![vector(equations.masses(y).center().0.into())],
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::CENTER_OF_MASS_JACOBIAN,
        summary: "Jacobian of the centre of mass.",
        equation: "ċ = J_c ẏ",
        arguments: &[Coordinates],
        results: &[("J_c", FRAME_JACOBIAN, "rows x, y, z of the base frame")],
        notes: NOTES,
        build: |equations, Arguments { y, .. }| vec![matrix(equations.masses(y).center_jacobian())],
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::CENTROIDAL_MOMENTUM_MATRIX,
        summary: "Centroidal momentum matrix.",
        equation: "(p, L) = A ẏ",
        arguments: &[Coordinates],
        results: &[(
            "A",
            FRAME_JACOBIAN,
            "rows: linear momentum, then angular momentum about the centre of mass, in the axes of the base",
        )],
        notes: NOTES,
        build: |equations, Arguments { y, .. }| vec![matrix(equations.masses(y).momentum_matrix())],
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::CENTROIDAL_MOMENTUM,
        summary: "Momentum of the moving bodies about their centre of mass.",
        equation: "(p, L) = (Σ m ċ_i, Σ (c_i − c) × m ċ_i + I ω)",
        arguments: &[Coordinates, Velocities],
        results: &[(
            "h",
            IN_SPACE,
            "linear momentum [N s], then angular momentum about the centre of mass [N m s], in the axes of the base",
        )],
        notes: NOTES,
        build: |equations, Arguments { y, v, .. }| {
            let rows = equations.masses(y).momentum_matrix();
            vec![vector(rows.iter().map(|row| equations.along_velocities(row, v)).collect())]
        },
        ..Quantity::PLAIN
    },
];
