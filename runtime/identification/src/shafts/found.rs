//! Findings about the friction that was identified if shafts take rows.

use super::super::estimation::{Estimate, Uncertain};
use super::super::robot::Robot;
use super::ShaftRows;
use gelenk_findings::digits::{plain, rounded};
use gelenk_findings::{Finding, Rule};

/// Sees: drives that act on several joints.
/// Matters: their friction is that of their shafts, and rows are named by the drive.
/// Example: a differential wrist.
/// Fixture: `shaft` in `codegen/tests/findings/shared.rs`.
const SHAFTS: Rule = Rule::note("rows-of-shafts");

/// Sees: friction that is described on a joint whose row is replaced by that of a shaft.
/// Matters: it is estimated near its description.
/// Example: a seal at the joint of a differential wrist.
/// Fixture: `codegen/tests/coupled_identification/shafts.rs`.
const JOINT_TERM: Rule = Rule::note("friction-of-joint");

impl ShaftRows {
    /// Findings about the shafts, and about the friction of joints whose rows they take.
    ///
    /// - `robot`: the robot with joints as rows
    pub(crate) fn found(&self, robot: &dyn Robot, estimate: &Estimate) -> Vec<Finding> {
        let names: Vec<&str> = self.shafts().iter().map(|shaft| shaft.name.as_str()).collect();
        let shafts = format!(
            "drives that act on several joints have friction on their shafts, over the motors' speeds, and rows of torques at \
             the motors: {}",
            names.join(", ")
        );
        let joints = robot.joint_names();
        let factors = estimate.parameters.get(self.first_term()..).unwrap_or_default();
        let term = |(term, factor): (&super::JointTerm, &Uncertain)| {
            let [low, high] = factor.interval;
            let error = Some(0.5 * (high - low));
            let message = format!(
                "its friction {} is estimated next to that of the shafts, near its description if the data do not determine it: {} becomes \
                 {} ({} to {})",
                term.basis,
                plain(term.coefficient, 4),
                rounded(factor.value, error),
                rounded(low, error),
                rounded(high, error)
            );
            JOINT_TERM.found(message).joint(&joints[term.joint])
        };
        std::iter::once(SHAFTS.found(shafts))
            .chain(self.joint_terms().iter().zip(factors).map(term))
            .collect()
    }
}
