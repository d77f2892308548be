//! Test of hypotheses: one is offered if it lowers the error on held-out data clearly.

use super::super::methods::confidence::quantile;
use super::fit::HeldOut;
use gelenk_findings::Finding;

/// A hypothesis counts as better where it lowers the held-out error by this share and beyond chance, and where no joint's error grows
/// by this share: what is wrong in one place is explained in part by changes elsewhere.
pub(super) const CLEARLY: f64 = 0.1;

/// Probability of a hypothesis that is better by chance alone.
const DOUBT: f64 = 0.05;

/// Trust with which a further parameter stays zero.
pub(super) const HELD: f64 = 1e12;

/// Name of the number by which a hypothesis is better, in percent.
pub(super) const FALL: &str = "fall of the held-out error";

/// R² below which a joint is hardly explained, and its sign is doubted.
pub(super) const POOR: f64 = 0.5;

/// Share of the held-out error by which a hypothesis is better; `None` unless it is clearly better. The trust is that of all
/// hypotheses of a kind together (Dunn 1961): where many are tried, one fits better by chance.
///
/// - residual sums of squares of the joints in the units of the same columns
/// - `tried`: number of hypotheses of this kind
pub(super) fn gain(own: &HeldOut, other: &HeldOut, tried: usize) -> Option<f64> {
    let (excess, deviation) = other.excess(own);
    let share = -excess / own.total();
    let least = quantile(1.0 - DOUBT / tried as f64, own.scores.len() as f64 - 1.0).ok()?;
    (share > CLEARLY && -excess > least * deviation && !harms(own, other)).then_some(share)
}

/// Whether a hypothesis raises the error of a joint by as much.
pub(super) fn harms(own: &HeldOut, other: &HeldOut) -> bool {
    own.rss.iter().zip(&other.rss).any(|(own, other)| *other > (1.0 + CLEARLY) * own)
}

/// The finding with the share of [`gain`].
pub(super) fn offered(finding: Finding, share: f64) -> Finding {
    let percent = 100.0 * share;
    let message = format!("{}; the error on held-out data falls by {percent:.0} %", finding.message);
    Finding { message, ..finding }.with(FALL, percent, "%")
}
