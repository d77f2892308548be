//! Functions that are linear in parameters, for identification.

use super::quantity::Argument::{Accelerations, Coordinates, Velocities};
use super::quantity::{Estimate, PARAMETERS, Quantity, REGRESSOR, Value, matrix, vector};
use crate::dynamics::arguments::Arguments;
use crate::dynamics::equations::Equations;
use crate::dynamics::forces;
use crate::dynamics::parameters::regressor;
use crate::dynamics::recursion::motion::MotionInput;
use crate::function_names;
use crate::functions::module_constants;

/// Functions of the regressors, and of the parameters with which they are multiplied.
pub const QUANTITIES: &[Quantity] = &[
    Quantity {
        name: function_names::INERTIAL_PARAMETERS,
        summary: "Inertial parameters `π` of links and rotors in the description.",
        equation: "W(y, ẏ, ÿ) π = M ÿ + k − q_gravity",
        arguments: &[],
        results: &[("π", PARAMETERS, "in the order of `INERTIAL_PARAMETER_NAMES`")],
        build: |equations, _| {
            let parameters = regressor::inertial_parameters(equations.graph, equations.model);
            vec![vector(parameters)]
        },
        constants: |model, _, _| vec![module_constants::inertial_names(model)],
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::INERTIAL_REGRESSOR,
        summary: "Regressor `W` of the inertial parameters.",
        equation: "W(y, ẏ, ÿ) π = M ÿ + k − q_gravity",
        arguments: &[Coordinates, Velocities, Accelerations],
        results: &[(
            "W",
            REGRESSOR,
            "one row per coordinate, columns in the order of `INERTIAL_PARAMETER_NAMES`; columns of rotors are last",
        )],
        notes: &[
            "The inverse dynamics are `W π + τ − springs`, with friction τ and the springs' forces. W does not depend on the \
             described inertias (Atkeson, An and Hollerbach 1986).",
        ],
        build: |equations, Arguments { y, v, a, .. }| {
            vec![matrix(equations.inertial_regressor(MotionInput { y, v, a }))]
        },
        straight_size: Some(Estimate::Regressor),
        ..Quantity::PLAIN
    },
    Quantity {
        name: function_names::BASE_REGRESSOR,
        summary: "Regressor `W_b` of the base parameters: the independent columns of `inertial_regressor`.",
        equation: "W_b(y, ẏ, ÿ) β = W π = M ÿ + k − q_gravity",
        arguments: &[Coordinates, Velocities, Accelerations],
        results: &[(
            "W_b",
            REGRESSOR,
            "one row per coordinate, columns in the order of `BASE_PARAMETER_NAMES`",
        )],
        notes: &[
            "Dependent columns were found numerically (Gautier 1991). If W_b is stacked over enough exciting states, it has \
             full rank for almost all values of free parameters.",
        ],
        build: |equations, Arguments { y, v, a, .. }| {
            vec![matrix(equations.base_regressor(MotionInput { y, v, a }))]
        },
        constants: |model, formulations, _| {
            module_constants::base_parameters(model, formulations.base_parameters())
        },
        straight_size: Some(Estimate::Regressor),
        ..Quantity::PLAIN
    },
    FRICTION_PARAMETERS,
    FRICTION_REGRESSOR,
];

const FRICTION_PARAMETERS: Quantity = Quantity {
    name: function_names::FRICTION_PARAMETERS,
    summary: "Friction parameters `φ` of the description: the factors of `friction_regressor`.",
    equation: "τ(ẏ) = friction_regressor(ẏ) · friction_parameters",
    arguments: &[],
    results: &[("φ", PARAMETERS, "in the order of `FRICTION_PARAMETER_NAMES`")],
    build: friction_parameters,
    constants: |model, _, _| vec![module_constants::friction_names(model)],
    ..Quantity::PLAIN
};

const FRICTION_REGRESSOR: Quantity = Quantity {
    name: function_names::FRICTION_REGRESSOR,
    summary: "Regressor of the friction parameters.",
    equation: "τ(ẏ) = friction_regressor(ẏ) · friction_parameters",
    arguments: &[Velocities],
    results: &[(
        "R",
        REGRESSOR,
        "one row per coordinate, columns in the order of `FRICTION_PARAMETER_NAMES`",
    )],
    notes: &[
        "Nonlinear parameters keep the values of the description: a3 and a5 of the Stribeck law, and slopes of tanh.",
    ],
    build: friction_regressor,
    ..Quantity::PLAIN
};

const BY_POSITION: &str = "τ(y, ẏ) = friction_regressor(y, ẏ) · friction_parameters";

/// The function of friction parameters if friction depends on the position.
pub const PARAMETERS_BY_POSITION: Quantity = Quantity { equation: BY_POSITION, ..FRICTION_PARAMETERS };

/// The function of the friction regressor if friction depends on the position.
pub const REGRESSOR_BY_POSITION: Quantity =
    Quantity { equation: BY_POSITION, arguments: &[Coordinates, Velocities], ..FRICTION_REGRESSOR };

fn friction_parameters<'g>(equations: &Equations<'_, 'g>, _: &Arguments<'g>) -> Vec<Value<'g>> {
    let coefficients = forces::friction_coefficients(equations.graph, equations.model);
    vec![vector(coefficients)]
}

fn friction_regressor<'g>(
    equations: &Equations<'_, 'g>,
    Arguments { y, v, .. }: &Arguments<'g>,
) -> Vec<Value<'g>> {
    let columns = forces::friction_columns(equations.graph, equations.model, y, v);
    let zero = equations.graph.constant(0.0);
    let mut rows = vec![vec![zero; columns.len()]; equations.model.motion_count()];
    for (index, column) in columns.iter().enumerate() {
        column.transmission.add_row_entry(index, column.basis, &mut rows);
    }
    vec![matrix(rows)]
}
