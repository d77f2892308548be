//! Test of hypotheses. A hypothesis is offered if it lowers the error on held-out data clearly.
//!
//! Some hypotheses are compared with fitted bodies, others with the described ones, because free bodies would explain much
//! of the difference. With the other kind of bodies the hypothesis must not raise the error by more than its standard error.

use super::super::error::Result;
use super::choice::Chosen;
use super::fit::HeldOut;
use super::prior::Prior;
use gelenk_findings::Finding;

/// Weight with which an additional parameter stays zero.
pub(super) const HELD: f64 = 1e12;

/// Weight of the description at which the fit does not change its bodies.
const AS_DESCRIBED: f64 = 1e12;

/// Name of the number in a finding by which a hypothesis lowers the error, in percent.
pub(super) const FALL: &str = "fall of the held-out error";

/// Computes held-out errors of a choice that may be changed.
pub(super) type Errors = fn(Chosen, &Prior) -> Result<HeldOut>;

/// Held-out errors with fitted bodies.
pub(super) fn fitted(chosen: Chosen, prior: &Prior) -> Result<HeldOut> {
    chosen.held_out(prior)
}

/// Held-out errors with the bodies as described, with fitted friction and offsets.
pub(super) fn as_described(mut chosen: Chosen, prior: &Prior) -> Result<HeldOut> {
    chosen.model.consistent = false;
    chosen.weighting.trust.fill(1.0);
    chosen.weighting.description = AS_DESCRIBED;
    chosen.held_out(prior)
}

/// Held-out errors with the efforts of some joints times a factor, in the units of the recorded efforts.
pub(super) fn times(
    chosen: &Chosen,
    joints: &[usize],
    factor: f64,
    errors: Errors,
    prior: &Prior,
) -> Result<HeldOut> {
    let mut scaled = chosen.over(chosen.centred.sums);
    joints.iter().for_each(|joint| scaled.values.gains[*joint] *= factor);
    let mut found = errors(scaled, prior)?;
    joints.iter().for_each(|joint| found.rss[*joint] /= factor.powi(2));
    Ok(found)
}

/// Share by which the described bodies explain the efforts better if all efforts are multiplied by a factor; `None` if they
/// do not explain them clearly better.
pub(super) fn gain_of_unit(chosen: &Chosen, factor: f64, prior: &Prior) -> Result<Option<f64>> {
    let joints: Vec<usize> = (0..chosen.centred.layout.joints).collect();
    let of = |factor: f64| times(chosen, &joints, factor, as_described, prior);
    Ok(of(1.0)?.gain(&of(factor)?))
}

/// The finding with the share of [`HeldOut::gain`].
pub(super) fn offered(finding: Finding, share: f64) -> Finding {
    let percent = 100.0 * share;
    let message = format!("{}; the error on held-out data falls by {percent:.0} %", finding.message);
    Finding { message, ..finding }.with(FALL, percent, "%")
}
