//! Test whether the effort of one joint has a wrong factor: a unit, gear or sensor other than described, or percent of a
//! rated torque.
//!
//! A body loads several joints, so that the efforts of the other joints determine the factor of one. Forces that act on a
//! single joint, as its friction, do not determine it.

use super::super::error::Result;
use super::super::run::Effort;
use super::choice::Chosen;
use super::fit::{HeldOut, held_out};
use super::levels;
use super::normal::Model;
use super::offer::{gain, offered};
use super::prior::Prior;
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule};

/// Factors that are tried first.
const TRIED: [f64; 12] = [0.05, 0.1, 0.2, 0.33, 0.5, 0.7, 1.4, 2.0, 3.0, 5.0, 10.0, 20.0];
/// Factor of one refinement step around the best candidate, and number of steps to each side.
const FINE: f64 = 1.05;
const STEPS: i32 = 8;

/// The chosen fit with another factor of one joint's effort.
struct Factors<'a> {
    chosen: &'a Chosen<'a>,
    prior: &'a Prior,
    model: Model,
}

impl Factors<'_> {
    fn error(&self, joint: usize, factor: f64) -> Result<HeldOut> {
        let mut start = self.chosen.values.clone();
        start.gains[joint] *= factor;
        let mut errors =
            held_out(&self.chosen.centred, &self.model, self.prior, &self.chosen.weighting, &start)?;
        // The residual sum of squares is in the unit of the measured effort.
        errors.rss[joint] /= factor.powi(2);
        Ok(errors)
    }

    /// The factor with the least held-out error, and this error; `None` without factors.
    fn best(&self, joint: usize, factors: impl Iterator<Item = f64>) -> Result<Option<(f64, HeldOut)>> {
        let mut best: Option<(f64, HeldOut)> = None;
        for factor in factors {
            let error = self.error(joint, factor)?;
            if best.as_ref().is_none_or(|(_, least)| error.total() < least.total()) {
                best = Some((factor, error));
            }
        }
        Ok(best)
    }
}

/// Whether every joint is explained well.
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
    let model = Model { consistent: false, ..chosen.model.clone() };
    let factors = Factors { chosen, prior, model };
    let mut clearest: Option<(usize, f64, f64)> = None;
    for joint in layout.rubbing() {
        let own = factors.error(joint, 1.0)?;
        let Some((factor, other)) = factors.best(joint, TRIED.into_iter())? else { continue };
        let Some(share) = gain(&own, &other).filter(|_| explains(chosen, &other)) else {
            continue;
        };
        if clearest.is_none_or(|(.., most)| share > most) {
            clearest = Some((joint, factor, share));
        }
    }
    let Some((joint, factor, share)) = clearest else { return Ok(None) };
    let near = (-STEPS..=STEPS).map(|i| factor * FINE.powi(i));
    let factor = factors.best(joint, near)?.map_or(factor, |(factor, _)| factor);
    Ok(Some((joint, offered(other_factor(layout.effort, factor), share))))
}

/// Sees: the effort of one joint that fits better with a factor.
/// Matters: its masses and its friction would be wrong by the factor.
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
        "check the effort's unit, {sources}, and the zero of its position; --columns gives one column a factor, as in {example}"
    );
    let message = format!("the data are explained better with its effort times {shown}");
    OTHER_FACTOR.found(message).with("factor", factor, "").help(remedy)
}
