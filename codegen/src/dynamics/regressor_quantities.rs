//! Functions that are linear in parameters, for identification: a part of the catalogue.

use super::catalogue::Argument::{Accelerations, Coordinates, Velocities};
use super::catalogue::{Arguments, Quantity, matrix, vector};
use super::newton_euler::MotionInput;
use super::{forces, regressor};

/// Their rows of the catalogue.
pub const QUANTITIES: &[Quantity] = &[
    Quantity {
        name: "inertial_parameters",
        summary: "Inertial parameters `π` of links and rotors as described.",
        equation: "W(y, ẏ, ÿ) π = M ÿ + k − q_gravity",
        arguments: &[],
        results: &[("π", "in the order of `INERTIAL_PARAMETER_NAMES`")],
        notes: &[],
        build: |equations, _| {
            let parameters = regressor::inertial_parameters(equations.graph, equations.model);
            vec![vector(parameters)]
        },
    },
    Quantity {
        name: "inertial_regressor",
        summary: "Regressor `W` of the inertial parameters.",
        equation: "W(y, ẏ, ÿ) π = M ÿ + k − q_gravity",
        arguments: &[Coordinates, Velocities, Accelerations],
        results: &[(
            "W",
            "rows by coordinate, columns in the order of `INERTIAL_PARAMETER_NAMES`; those of rotors stand last",
        )],
        notes: &[
            "The inverse dynamics are `W π + τ − springs`, with friction τ and the springs' forces. Independent of the \
             described inertias (Atkeson, An and Hollerbach 1986).",
        ],
        build: |equations, Arguments { y, v, a, .. }| {
            vec![matrix(equations.inertial_regressor(MotionInput {
                y,
                v,
                a,
            }))]
        },
    },
    Quantity {
        name: "base_regressor",
        summary: "Regressor `W_b` of the base parameters: the independent columns of `inertial_regressor`.",
        equation: "W_b(y, ẏ, ÿ) β = W π = M ÿ + k − q_gravity",
        arguments: &[Coordinates, Velocities, Accelerations],
        results: &[(
            "W_b",
            "rows by coordinate, columns in the order of `BASE_PARAMETER_NAMES`",
        )],
        notes: &[
            "Columns that depend on earlier ones were found numerically (Gautier 1991); stacked over states that excite \
             the robot, W_b has full rank, for almost all values of free parameters.",
        ],
        build: |equations, Arguments { y, v, a, .. }| {
            vec![matrix(equations.base_regressor(MotionInput { y, v, a }))]
        },
    },
    Quantity {
        name: "friction_parameters",
        summary: "Friction parameters as described: the coefficients of `friction_regressor`.",
        equation: "τ(ẏ) = friction_regressor(ẏ) · friction_parameters",
        arguments: &[],
        results: &[("φ", "in the order of `FRICTION_PARAMETER_NAMES`")],
        notes: &[],
        build: |equations, _| {
            let columns = forces::friction_columns(equations.graph, equations.model, None);
            vec![vector(
                columns.iter().map(|column| column.coefficient).collect(),
            )]
        },
    },
    Quantity {
        name: "friction_regressor",
        summary: "Regressor of the friction parameters.",
        equation: "τ(ẏ) = friction_regressor(ẏ) · friction_parameters",
        arguments: &[Velocities],
        results: &[(
            "R",
            "rows by coordinate, columns in the order of `FRICTION_PARAMETER_NAMES`",
        )],
        notes: &[
            "What enters nonlinearly is held at its described value: a3 and a5 of the Stribeck form, slopes of tanh.",
        ],
        build: |equations, Arguments { v, .. }| {
            let columns = forces::friction_columns(equations.graph, equations.model, Some(v));
            let zero = equations.graph.constant(0.0);
            let mut rows = vec![vec![zero; columns.len()]; equations.model.coordinates.len()];
            for (index, column) in columns.iter().enumerate() {
                rows[column.coordinate][index] = column.basis;
            }
            vec![matrix(rows)]
        },
    },
];
