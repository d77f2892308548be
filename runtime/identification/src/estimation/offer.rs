//! Test of hypotheses. A hypothesis is offered if it lowers the error on held-out data clearly.

use super::fit::HeldOut;
use super::levels;
use gelenk_findings::Finding;

/// Weight with which an additional parameter stays zero.
pub(super) const HELD: f64 = 1e12;

/// Name of the number in a finding by which a hypothesis lowers the error, in percent.
pub(super) const FALL: &str = "fall of the held-out error";

/// Share of the held-out error by which a hypothesis is better; `None` if it is not clearly better.
///
/// The residual sums of squares of each joint must be in the units of the same columns.
pub(super) fn gain(own: &HeldOut, other: &HeldOut) -> Option<f64> {
    let (excess, deviation) = other.excess(own);
    let share = -excess / own.total();
    (share > levels::CLEARLY.get() && -excess > 2.0 * deviation && !harms(own, other)).then_some(share)
}

/// Whether a hypothesis raises the error of a joint by the share at which hypotheses count as clearly better.
pub(super) fn harms(own: &HeldOut, other: &HeldOut) -> bool {
    own.rss.iter().zip(&other.rss).any(|(own, other)| *other > (1.0 + levels::CLEARLY.get()) * own)
}

/// The finding with the share of [`gain`].
pub(super) fn offered(finding: Finding, share: f64) -> Finding {
    let percent = 100.0 * share;
    let message = format!("{}; the error on held-out data falls by {percent:.0} %", finding.message);
    Finding { message, ..finding }.with(FALL, percent, "%")
}
