//! How well a joint's force is explained with the friction law that is written, which need not have the terms of the
//! common estimate.

use super::super::estimation::{Estimate, JointEstimate};
use super::super::friction::joint_samples::kept;
use super::super::numeric::digits::plain;
use super::super::result::FrictionResult;
use super::super::run::PreparedRun;
use gelenk_findings::Rule;

/// Sees: a law that explains less than viscous and Coulomb friction would.
/// Matters: the terms that were asked for are too few.
/// Example: `--friction viscous` of a joint with Coulomb friction.
/// Fixture: `codegen/tests/external_arm/doubts.rs`.
const TOO_FEW_TERMS: Rule = Rule::warning("too-few-terms");

/// Loss of held-out R² from which it is said.
const NOTICEABLE: f64 = 0.01;

/// Gives a joint the numbers of its law, and the law a warning where it explains much less than the estimate's own terms.
///
/// The held-out error is the larger one of the estimate's and the law's: neither knows the left-out data, and the law's is
/// beside bodies that do.
pub(crate) fn judge(joint: &mut JointEstimate, law: &mut FrictionResult) {
    let total = joint.sigma.powi(2) / (1.0 - joint.r_squared);
    let of_friction = law.residual.powi(2) / (1.0 - law.r_squared);
    if !(total.is_finite() && of_friction.is_finite() && total > 0.0) {
        return;
    }
    let unseen = law.held_out.map_or(law.residual.powi(2), |r_squared| (1.0 - r_squared) * of_friction);
    let before = joint.held_out_r_squared;
    joint.held_out_r_squared = before.min(1.0 - unseen / total);
    let loss = before - joint.held_out_r_squared;
    joint.held_out_with_rest -= loss;
    joint.r_squared = 1.0 - law.residual.powi(2) / total;
    joint.sigma = law.residual;
    if loss > NOTICEABLE {
        let message = format!(
            "the terms of the law explain less than friction with viscous and Coulomb terms of its own would: R² on held-out data is \
             {} instead of {}",
            plain(joint.held_out_r_squared, 3),
            plain(before, 3)
        );
        law.findings.push(TOO_FEW_TERMS.found(message).help("let more terms be chosen (--friction)"));
    }
}

/// Predicts a joint's force with its law, where that was fitted.
///
/// - `residuals`: of the law, over the samples in which the joint moves
pub(crate) fn predict(estimate: &mut Estimate, joint: usize, runs: &[PreparedRun], residuals: &[f64]) {
    let mut residuals = residuals.iter();
    for (index, run) in runs.iter().enumerate() {
        let measured = &estimate.measured[index][joint];
        let predicted = &mut estimate.predicted[index][joint];
        for (i, residual) in kept(run, joint, &estimate.friction[index][joint]).zip(&mut residuals) {
            predicted[i] = measured[i] - residual;
        }
    }
}
