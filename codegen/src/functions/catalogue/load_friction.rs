//! Catalogue texts of robots whose friction grows with the load: one more function, other equations, and the
//! functions that are missing.
//!
//! There q keeps the friction τ of velocity and position alone, and the equations of motion have one more
//! term.

use super::otherwise::{Otherwise, Robots};
use super::quantity::Argument::{Coordinates, Velocities};
use super::quantity::{Quantity, VECTOR, vector};
use crate::function_names;

const MOTION: &str = "M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u − |τ_l| s₁(y, ẏ)";

/// The function that only such robots have.
pub const QUANTITIES: &[Quantity] = &[Quantity {
    name: function_names::LOAD_FRICTION,
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

/// Definition of the load.
const LOAD: &str = "The load `τ_l` is what a drive would exert without friction, `M ÿ + k − gravity_forces − spring_forces`. Friction is \
    `friction_torques + |τ_l| load_friction` (Hamon, Gautier and Garrec 2010).";

const KINK: &str = "At a load of exactly 0 the derivatives jump; there they are those without `load_friction`, between those of either \
    side.";

const WITHOUT: &str =
    "Friction without what the load adds, `|τ_l| load_friction`: that depends on the accelerations.";

const OTHERWISE: Otherwise = Otherwise::of(Robots::LoadFriction);

/// The equations of motion have one more term.
pub const EQUATIONS: Otherwise = Otherwise { equation: Some(MOTION), notes: &[LOAD], ..OTHERWISE };

/// Friction is not all in friction.
pub const APART: Otherwise = Otherwise { notes: &[WITHOUT], ..OTHERWISE };

/// The inverse dynamics have one more term.
pub const INVERSE_DYNAMICS: Otherwise = Otherwise {
    equation: Some("τ_l + friction_torques + |τ_l| s₁(y, ẏ), τ_l = M ÿ + k − gravity_forces − spring_forces"),
    notes: &[LOAD],
    ..OTHERWISE
};

/// Forward dynamics with friction under load.
pub const FORWARD_DYNAMICS: Otherwise = Otherwise {
    equation: Some(
        "ÿ = M⁻¹ (τ_l + gravity_forces + spring_forces − k), τ_l = w / (1 + s₁ sign w), w = B u − friction_torques",
    ),
    notes: &[
        LOAD,
        "Joint by joint, since `|s₁| < 1`: `w`, what a drive exerts beyond `friction_torques`, has the sign of the load.",
    ],
    ..OTHERWISE
};

/// The Jacobian by the accelerations is not M.
pub const INVERSE_DERIVATIVES: Otherwise = Otherwise {
    equation: Some("δ(B u) = ∂/∂y δy + ∂/∂ẏ δẏ + D M δÿ, D = diag(1 + s₁ sign τ_l)"),
    first_result: Some("what the drives exert at the joints, friction under load included"),
    notes: &[LOAD, KINK],
    ..OTHERWISE
};

/// The linearization has a kink.
pub const LINEARIZE: Otherwise = Otherwise { notes: &[LOAD, KINK], ..OTHERWISE };

/// The regressor of the inertial parameters has the load.
pub const REGRESSOR: Otherwise = Otherwise {
    notes: &[
        "Here `W π − springs` is the load `τ_l`, and `|τ_l| load_friction` is part of the inverse dynamics too.",
    ],
    ..OTHERWISE
};

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
            let is_told = row.otherwise.iter().any(|said| said.robots == Robots::LoadFriction);
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
}
