//! Functions of robots with load-dependent friction: an additional function, other equations, and missing
//! functions.
//!
//! The applied forces q include the friction that depends on velocity and position. The equations of motion
//! have an additional term for the load-dependent friction.

use super::quantity::Argument::{Coordinates, Velocities};
use super::quantity::{Quantity, VECTOR, vector};
use crate::function_names as names;

/// Equations of motion with load-dependent friction. τ_l is the load (the drive's force without friction),
/// and s₁ is the friction per unit of the load.
pub const MOTION: &str = "M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u − |τ_l| s₁(y, ẏ)";

/// The function `load_friction`, which only robots with load-dependent friction have.
pub const QUANTITIES: &[Quantity] = &[Quantity {
    name: names::LOAD_FRICTION,
    summary: "Load-dependent friction `s₁(y, ẏ)`: additional friction per unit of load.",
    equation: MOTION,
    arguments: &[Coordinates, Velocities],
    results: &[(
        "s₁",
        VECTOR,
        "friction divided by load, without unit; positive for positive velocity, 0 for joints without load-dependent friction",
    )],
    notes: &[
        LOAD,
        "`|s₁| < 1` was checked at the described values of free parameters, within the joint's limits.",
    ],
    build: |equations, arguments| vec![vector(equations.load_friction(&arguments.y, &arguments.v))],
    ..Quantity::PLAIN
}];

/// Documentation note that defines the load τ_l.
pub const LOAD: &str = "The load `τ_l` is the drive force without friction, `M ÿ + k − gravity_forces − \
        spring_forces`. Friction is `friction_torques + |τ_l| load_friction` (Hamon, Gautier and Garrec 2010).";

/// Documentation note on the derivatives at zero load.
pub const KINK: &str = "The derivatives are discontinuous at a load of 0. There they have the values without \
        `load_friction`, which are between the two one-sided limits.";

#[cfg(test)]
mod tests {
    use super::super::kind::Difference;
    use super::super::{KINDS, all};

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
            let of_load = KINDS.iter().find(|kind| kind.code == "load-friction");
            let difference = of_load.and_then(|kind| kind.difference(row.name));
            let is_documented = matches!(difference, Some(Difference::Documented(_)));
            let is_missing = matches!(difference, Some(Difference::Missing { .. }));
            let true_rows = [
                "gravity_forces",
                "spring_forces",
                "bias_forces",
                "base_regressor",
                "inertial_parameters",
                "joint_wrenches",
            ];
            let is_true = true_rows.contains(&row.name);
            // A robot with wrenches or driven joints has no load-dependent friction.
            let mut apart = KINDS.iter().flat_map(|kind| kind.adds);
            let is_own = apart.any(|own| own.name == row.name);
            assert!(
                about.is_empty() || is_documented || is_true || is_own || is_missing,
                "{}: {about:?}",
                row.name
            );
        }
    }
}
