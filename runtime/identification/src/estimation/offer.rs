//! Test of hypotheses. A hypothesis becomes a finding if it lowers the error on held-out data clearly.
//!
//! Some hypotheses are tested with fitted bodies. Others are tested with the described bodies, because fitted bodies would
//! explain much of the difference. With the other kind of bodies the hypothesis must not raise the error by more than the
//! standard error.

use super::super::error::Result;
use super::choice::Chosen;
use super::fit::HeldOut;
use super::prior::Prior;
use gelenk_findings::Finding;

/// Weight of the prior that keeps an additional parameter at zero.
pub(super) const HELD: f64 = 1e12;

/// Weight of the description at which the bodies stay as described.
const AS_DESCRIBED: f64 = 1e12;

/// Name of the decrease of the held-out error [%] among the numbers of a finding.
pub(super) const FALL: &str = "fall of the held-out error";

/// Function that computes the held-out errors of a choice. It takes the choice by value and may change it.
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

/// Held-out errors in the units of the recorded efforts, if the efforts of some joints are multiplied by a factor.
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

/// The finding, with the relative decrease of the held-out error in its message and its numbers.
///
/// - `share`: the decrease as in [`HeldOut::gain`]
pub(super) fn offered(finding: Finding, share: f64) -> Finding {
    let percent = 100.0 * share;
    let message = format!("{}; the error on held-out data falls by {percent:.0} %", finding.message);
    Finding { message, ..finding }.with(FALL, percent, "%")
}
