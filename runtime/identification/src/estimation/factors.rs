//! Test whether the effort of one joint has a wrong factor, for example because of another unit, gear or sensor than
//! described, or because the effort is a percentage of a rated torque.
//!
//! A body loads several joints, so the efforts of the other joints determine the factor of one joint. Forces that act on a
//! single joint, for example its friction, do not determine the factor.

use super::super::error::Result;
use super::super::run::Effort;
use super::choice::Chosen;
use super::fit::HeldOut;
use super::levels;
use super::offer::{as_described, fitted, offered, times};
use super::prior::Prior;
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule};

/// Factors that are tried first.
const TRIED: [f64; 12] = [0.05, 0.1, 0.2, 0.33, 0.5, 0.7, 1.4, 2.0, 3.0, 5.0, 10.0, 20.0];
/// Factor of one refinement step around the best candidate, and number of steps to each side.
const FINE: f64 = 1.05;
const STEPS: i32 = 8;

/// Whether the fit explains the effort of every joint sufficiently.
fn explains(chosen: &Chosen, errors: &HeldOut) -> bool {
    let r_squared = chosen.centred_r_squared(&errors.rss);
    chosen.centred.layout.rubbing().all(|joint| r_squared[joint] >= levels::POOR.get())
}

/// The joint whose effort with another factor improves the fit most, and a finding with the factor; `None` if no factor
/// improves the fit clearly.
pub(super) fn factor(chosen: &Chosen, prior: &Prior) -> Result<Option<(usize, Finding)>> {
    let layout = chosen.centred.layout;
    if layout.known_gains.contains(&false) {
        return Ok(None);
    }
    let mut free = chosen.over(chosen.centred.sums);
    free.model.consistent = false;
    let own = times(&free, &[], 1.0, fitted, prior)?;
    let described = times(chosen, &[], 1.0, as_described, prior)?;
    let mut clearest: Option<(usize, f64, f64)> = None;
    for joint in layout.rubbing() {
        let Some((factor, other)) = best(&free, joint, TRIED.into_iter(), prior)? else { continue };
        let share = own.gain(&other).filter(|_| explains(chosen, &other));
        let is_clearest = share.is_some_and(|share| clearest.is_none_or(|(.., most)| share > most));
        // Free bodies may explain effects that the described bodies exclude.
        if is_clearest && !described.is_exceeded_by(&times(chosen, &[joint], factor, as_described, prior)?) {
            clearest = share.map(|share| (joint, factor, share));
        }
    }
    let Some((joint, factor, share)) = clearest else { return Ok(None) };
    let near = (-STEPS..=STEPS).map(|i| factor * FINE.powi(i));
    let factor = best(&free, joint, near, prior)?.map_or(factor, |(factor, _)| factor);
    Ok(Some((joint, offered(other_factor(layout.effort, factor), share))))
}

/// The factor of a joint's effort with the least held-out error, and this error; `None` if there are no factors.
fn best(
    chosen: &Chosen,
    joint: usize,
    factors: impl Iterator<Item = f64>,
    prior: &Prior,
) -> Result<Option<(f64, HeldOut)>> {
    let mut best: Option<(f64, HeldOut)> = None;
    for factor in factors {
        let error = times(chosen, &[joint], factor, fitted, prior)?;
        if best.as_ref().is_none_or(|(_, least)| error.total() < least.total()) {
            best = Some((factor, error));
        }
    }
    Ok(best)
}

/// Sees: the effort of one joint that fits better with a factor.
/// Matters: masses and friction of this joint would be wrong by the factor.
/// Example: one sensor in another unit.
/// Fixture: `factor` in `codegen/tests/findings/arm.rs`.
const OTHER_FACTOR: Rule = Rule::error("other-factor");

fn other_factor(effort: Effort, factor: f64) -> Finding {
    let shown = plain(factor, 2);
    let (sources, example) = match effort {
        Effort::Joint => ("gear ratio and sensor", format!("'torque=tau1|tau2[{shown} Nm]|tau3'")),
        Effort::Input => ("gear ratio and sensor", format!("'input=u1|u2[{shown} Nm]|u3'")),
        Effort::Current => ("gear ratio and motor constant", format!("'current=i1|i2[{shown} A]|i3'")),
    };
    let remedy = format!(
        "check the effort's unit, {sources}, and the zero of its position; to multiply one column by the factor, use --columns {example}"
    );
    let message = format!("the data are explained better with its effort times {shown}");
    OTHER_FACTOR.found(message).with("factor", factor, "").help(remedy)
}
