//! Test of the stated delays of the efforts.

use super::super::error::Result;
use super::checks::Checked;
use super::trial::{Case, Change, Hypothesis};
use gelenk_findings::{Finding, Rule};

/// Sees: an effort that comes later or earlier than `--delay` says.
/// Matters: the delay causes errors of inertia and friction.
/// Example: `--delay 0` with efforts that are 50 ms early.
/// Fixture: `efforts_that_come_early_are_moved` in `codegen/tests/external_arm/main.rs`.
const DELAY: Rule = Rule::warning("other-delay");

pub(super) const OTHER_DELAY: Hypothesis =
    Hypothesis { each: true, ..Hypothesis::of(DELAY, delays, other_delay) };

impl Checked<'_> {
    /// The delay of a joint's effort \[s\] that its residual shows; `None` if the residual is not proportional to the rate of
    /// the force. A torque τ that is late by d is `τ(t − d) ≈ τ − d τ̇`.
    fn delay(&self, joint: usize) -> Option<f64> {
        let slope = |run: usize, i: usize| {
            let (p, t) = (self.predicted(run, joint), &self.task.runs[run].times);
            let (before, after) = (i.saturating_sub(1), (i + 1).min(t.len() - 1));
            (p(after) - p(before)) / (t[after] - t[before])
        };
        let (factor, share) = self.explained(joint, &slope)?;
        self.is_suspicious(share).then_some(-factor)
    }

    fn predicted(&self, run: usize, joint: usize) -> impl Fn(usize) -> f64 + '_ {
        let (measured, residual) = (&self.forces.measured[run][joint], &self.forces.residual[run][joint]);
        move |i| measured[i] - residual[i]
    }
}

/// Further delays that the residuals show, if the settings state the delays. Delays that are not stated are unknowns of the
/// fit.
fn delays(case: &Case) -> Result<Vec<Change>> {
    let Some(checked) = case.checked.filter(|checked| checked.task.layout.delays.is_empty()) else {
        return Ok(Vec::new());
    };
    let delay = |joint: usize| checked.delay(joint).map(|seconds| Change::Delay(joint, seconds));
    Ok(case.layout().rubbing().filter_map(delay).collect())
}

fn other_delay(_: &Case, change: &Change, rule: &Rule) -> Result<Option<Finding>> {
    let Change::Delay(_, seconds) = change else { return Ok(None) };
    let way = if *seconds > 0.0 { "later" } else { "earlier" };
    let message = format!(
        "relative to its position, its effort comes {:.1} ms {way} than the stated delay says",
        1e3 * seconds.abs()
    );
    let remedy =
        "leave --delay out, or give the whole delay with --delay SECONDS (positive if efforts are late)";
    Ok(Some(rule.found(message).with("delay", *seconds, "s").help(remedy)))
}
