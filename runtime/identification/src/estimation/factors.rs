//! Test whether the effort of one joint has a wrong factor. Possible reasons are a unit, gear or sensor that
//! differs from the description, or an effort in percent of a rated torque.
//!
//! A body loads several joints, so the efforts of the other joints determine the factor of one joint. Forces that act on a
//! single joint, for example its friction, do not determine the factor.

use super::super::error::Result;
use super::super::run::Effort;
use super::fit::HeldOut;
use super::levels;
use super::trial::{Bodies, Case, Change, Hypothesis};
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule};

/// Sees: the effort of one joint that fits better with a factor.
/// Matters: masses and friction of this joint would be wrong by the factor.
/// Example: one sensor in another unit.
/// Fixture: `factor` in `codegen/tests/findings/arm.rs`.
const FACTOR: Rule = Rule::error("other-factor");

pub(super) const OTHER_FACTOR: Hypothesis = Hypothesis {
    when: |case, doubts| doubts.is_empty() && case.too_short().is_none(),
    bodies: Bodies::Unbounded,
    accepts: explains,
    ..Hypothesis::of(FACTOR, factors, finding)
};

/// Factors that are tried first.
const TRIED: [f64; 12] = [0.05, 0.1, 0.2, 0.33, 0.5, 0.7, 1.4, 2.0, 3.0, 5.0, 10.0, 20.0];
/// Ratio of neighbouring factors in the refinement around the best candidate.
const FINE: f64 = 1.05;
/// Number of factors on each side of the best candidate in the refinement.
const STEPS: i32 = 8;

/// Whether the fit explains the effort of every joint sufficiently.
fn explains(case: &Case, errors: &HeldOut) -> bool {
    let r_squared = case.chosen.centred_r_squared(&errors.rss);
    case.layout().rubbing().all(|joint| r_squared[joint] >= levels::POOR.get())
}

/// For each joint, the factor of its effort with the least held-out error, if this factor lowers the error noticeably.
fn factors(case: &Case) -> Result<Vec<Change>> {
    let mut found = Vec::new();
    if case.layout().known_gains.contains(&false) {
        return Ok(found);
    }
    let most = (1.0 - levels::CLEARLY.get()) * case.own(Bodies::Unbounded).total();
    for joint in case.layout().rubbing() {
        let (factor, error) = best(case, joint, TRIED.into_iter())?;
        if error < most {
            let (factor, _) = best(case, joint, (-STEPS..=STEPS).map(|i| factor * FINE.powi(i)))?;
            found.push(Change::Factor(Some(joint), factor));
        }
    }
    Ok(found)
}

/// The factor of a joint's effort with the least held-out error, and the least error.
fn best(case: &Case, joint: usize, factors: impl Iterator<Item = f64>) -> Result<(f64, f64)> {
    let mut best = (1.0, f64::INFINITY);
    for factor in factors {
        let error = case.errors(&Change::Factor(Some(joint), factor), None, Bodies::Unbounded)?.total();
        if error < best.1 {
            best = (factor, error);
        }
    }
    Ok(best)
}

fn finding(case: &Case, change: &Change, rule: &Rule) -> Result<Option<Finding>> {
    let Change::Factor(_, factor) = change else { return Ok(None) };
    let shown = plain(*factor, 2);
    let (sources, example) = match case.layout().effort {
        Effort::Joint => ("gear ratio and sensor", format!("'torque=tau1|tau2[{shown} Nm]|tau3'")),
        Effort::Input => ("gear ratio and sensor", format!("'input=u1|u2[{shown} Nm]|u3'")),
        Effort::Current => ("gear ratio and motor constant", format!("'current=i1|i2[{shown} A]|i3'")),
    };
    let remedy = format!(
        "check the effort's unit, {sources}, and the zero of its position. To multiply one column by the factor, use --columns {example}"
    );
    let message = format!("the data are explained better if its effort is multiplied by {shown}");
    Ok(Some(rule.found(message).with("factor", *factor, "").help(remedy)))
}
