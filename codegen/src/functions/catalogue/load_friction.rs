//! What the catalogue says of robots whose friction grows with the load: a function more, other equations, and
//! the functions that they do not have.
//!
//! There q keeps the friction τ of velocity and position alone, and the equations of motion have one more
//! term.

use super::quantity::Argument::{Coordinates, Velocities};
use super::quantity::{Quantity, VECTOR, vector};
use crate::dynamics::load_friction;
use crate::functions::function::Function;
use crate::model::Model;

const MOTION: &str = "M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u − |τ_l| s₁(y, ẏ)";

/// The function that only such robots have.
pub const QUANTITIES: &[Quantity] = &[Quantity {
    name: "load_friction",
    summary: "Friction under load `s₁(y, ẏ)`: what friction gains for each unit of the load.",
    equation: MOTION,
    arguments: &[Coordinates, Velocities],
    results: &[(
        "s₁",
        VECTOR,
        "friction over load, without unit; positive for positive velocity, 0 for joints without such friction",
    )],
    notes: &[
        LOAD,
        "`|s₁| < 1` was checked at the described values of free parameters, within the joint's limits.",
    ],
    build: |equations, arguments| vec![vector(equations.load_friction(&arguments.y, &arguments.v))],
    ..Quantity::PLAIN
}];

/// Tells whether a model has this function.
pub fn is_in(model: &Model) -> bool {
    load_friction::is_there(model)
}

/// What the load is.
const LOAD: &str = "The load `τ_l` is what a drive would exert without friction, `M ÿ + k − gravity_forces − spring_forces`. Friction is \
    `friction_torques + |τ_l| load_friction` (Hamon, Gautier and Garrec 2010).";

const KINK: &str = "At a load of exactly 0 the derivatives jump; there they are those without `load_friction`, between those of either \
    side.";

const WITHOUT: &str =
    "Friction without what the load adds, `|τ_l| load_friction`: that depends on the accelerations.";

/// What is said otherwise of a function.
struct Text {
    name: &'static str,
    /// The equation in place of the row's.
    equation: Option<&'static str>,
    /// In place of the meaning of the first result.
    first_result: Option<&'static str>,
    notes: &'static [&'static str],
}

impl Text {
    const PLAIN: Self = Self { name: "", equation: None, first_result: None, notes: &[] };

    const fn motion(name: &'static str) -> Self {
        Self { name, equation: Some(MOTION), notes: &[LOAD], ..Self::PLAIN }
    }

    const fn note(name: &'static str, notes: &'static [&'static str]) -> Self {
        Self { name, notes, ..Self::PLAIN }
    }
}

const INVERSE: &str =
    "τ_l + friction_torques + |τ_l| s₁(y, ẏ), τ_l = M ÿ + k − gravity_forces − spring_forces";

const FORCES: &str = "what the drives exert at the joints, friction under load included";

const TEXTS: &[Text] = &[
    Text::motion("mass_matrix"),
    Text::motion("coriolis_forces"),
    Text::motion("input_matrix"),
    Text::motion("equations_of_motion"),
    Text::motion("mass_matrix_and_bias_forces"),
    Text::note("friction_torques", &[WITHOUT]),
    Text::note("applied_forces", &[WITHOUT]),
    Text { name: "inverse_dynamics", equation: Some(INVERSE), notes: &[LOAD], ..Text::PLAIN },
    Text {
        name: "forward_dynamics",
        equation: Some(
            "ÿ = M⁻¹ (τ_l + gravity_forces + spring_forces − k), τ_l = w / (1 + s₁ sign w), w = B u − friction_torques",
        ),
        notes: &[
            LOAD,
            "Joint by joint, since `|s₁| < 1`: `w`, what a drive exerts beyond `friction_torques`, has the sign of the load.",
        ],
        ..Text::PLAIN
    },
    Text {
        name: "inverse_dynamics_derivatives",
        equation: Some("δ(B u) = ∂/∂y δy + ∂/∂ẏ δẏ + D M δÿ, D = diag(1 + s₁ sign τ_l)"),
        first_result: Some(FORCES),
        notes: &[LOAD, KINK],
    },
    Text::note("linearize", &[LOAD, KINK]),
    Text::note(
        "inertial_regressor",
        &[
            "Here `W π − springs` is the load `τ_l`, and `|τ_l| load_friction` is part of the inverse dynamics too.",
        ],
    ),
    Text::note("friction_parameters", &[WITHOUT]),
    Text::note("friction_regressor", &[WITHOUT]),
];

/// Says what is otherwise where friction grows with the load.
pub fn describe(model: &Model, function: &mut Function) {
    let text = TEXTS.iter().find(|text| text.name == function.name);
    let Some(text) = text.filter(|_| is_in(model)) else {
        return;
    };
    if let Some(equation) = text.equation {
        equation.clone_into(&mut function.equation);
    }
    if let (Some(meaning), Some(first)) = (text.first_result, function.results.first_mut()) {
        meaning.clone_into(first);
    }
    function.notes.extend(text.notes.iter().map(|&note| note.to_owned()));
}

#[cfg(test)]
mod tests {
    use super::super::all;
    use super::*;

    /// A row whose equation or notes know friction, the applied forces or the inputs would be untrue.
    #[test]
    fn nothing_untrue_is_said_of_any_function() {
        for row in all() {
            let said = [row.equation, row.summary].into_iter().chain(row.notes.iter().copied());
            let said = said.chain(row.results.iter().map(|(_, _, meaning)| *meaning));
            let words = ["= q(", "− q", "+ B u", "friction", "δ(M ÿ"];
            let mut about: Vec<&str> =
                said.flat_map(|text| words.into_iter().filter(move |word| text.contains(word))).collect();
            about.dedup();
            let is_told = TEXTS.iter().any(|text| text.name == row.name);
            let true_rows = [
                "gravity_forces",
                "spring_forces",
                "bias_forces",
                "base_regressor",
                "inertial_parameters",
                "joint_wrenches",
            ];
            let is_true = true_rows.contains(&row.name);
            // A robot with wrenches or driven joints has no friction under load.
            let others = super::super::wrenches::QUANTITIES.iter().chain(super::super::driven::QUANTITIES);
            let mut apart = QUANTITIES.iter().chain(others);
            let is_own = apart.any(|own| own.name == row.name);
            assert!(
                about.is_empty() || is_told || is_true || is_own || row.ignores_load,
                "{}: {about:?}",
                row.name
            );
            assert!(!(is_told && row.ignores_load), "{}", row.name);
        }
    }

    #[test]
    fn every_text_has_its_function() {
        for text in TEXTS {
            assert!(all().any(|row| row.name == text.name), "{}", text.name);
        }
    }
}
