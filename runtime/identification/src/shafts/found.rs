//! Findings about the identified friction if shafts replace joints in rows of the equations.

use super::super::estimation::{Estimate, Uncertain};
use super::super::robot::Robot;
use super::ShaftRows;
use gelenk_findings::digits::{plain, rounded};
use gelenk_findings::{Finding, Rule};

/// Sees: drives that act on several joints.
/// Matters: their friction is identified at their shafts, and results have the name of the drive.
/// Example: a differential wrist.
/// Fixture: `shaft` in `codegen/tests/findings/shared.rs`.
const SHAFTS: Rule = Rule::note("rows-of-shafts");

/// Sees: friction that is described at a joint that is replaced by a shaft in the equations.
/// Matters: this friction is estimated together with the friction of the shafts, near its description.
/// Example: a seal at the joint of a differential wrist.
/// Fixture: `codegen/tests/coupled_identification/shafts.rs`.
const JOINT_TERM: Rule = Rule::note("friction-of-joint");

impl ShaftRows {
    /// Findings about the shafts, and about the friction of joints that the shafts replace.
    ///
    /// - `robot`: the robot with joints as rows
    pub(crate) fn found(&self, robot: &dyn Robot, estimate: &Estimate) -> Vec<Finding> {
        let names: Vec<&str> = self.shafts().iter().map(|shaft| shaft.name.as_str()).collect();
        let shafts = format!(
            "the friction of drives that move several joints is identified with the speeds and torques of the motors: {}",
            names.join(", ")
        );
        let joints = robot.joint_names();
        let factors = estimate.parameters.get(self.first_term()..).unwrap_or_default();
        let term = |(term, factor): (&super::JointTerm, &Uncertain)| {
            let [low, high] = factor.interval;
            let error = Some(0.5 * (high - low));
            let message = format!(
                "the factor {1} of its friction term {0} becomes {2} (interval {3} to {4}). It is estimated together with the \
                 friction of the shafts, and stays near {1} if the data do not determine it",
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
