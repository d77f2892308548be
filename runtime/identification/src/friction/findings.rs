//! What is said about a law on the way to it: notes, doubts, and reasons to refuse it.

use super::super::digits::plain;
use super::super::error::Result;
use super::super::result::FrictionLaw;
use super::task::FrictionData;

/// Share of samples beyond a limit of the description above which the data do not fit the joint.
const BEYOND_LIMITS: f64 = 0.01;

/// Part of the described speed that a log shows at least where nothing is said.
const SMALL_PART: f64 = 0.1;

/// Friction over the described effort that no joint has.
const ABSURD: f64 = 3.0;

/// What is collected on the way.
pub(super) struct Findings<'a> {
    pub(super) data: &'a FrictionData<'a>,
    pub(super) unit: &'a str,
    pub(super) notes: Vec<String>,
    pub(super) warnings: Vec<String>,
    pub(super) refusals: Vec<String>,
}

impl<'a> Findings<'a> {
    pub(super) fn new(data: &'a FrictionData<'a>) -> Self {
        let notes = data.settings.to_vec();
        Self { data, unit: data.unit, notes, warnings: Vec::new(), refusals: Vec::new() }
    }

    pub(super) fn note(&mut self, text: String) {
        self.notes.push(text);
    }

    /// Names the terms that the law may be made of.
    pub(super) fn note_library(&mut self, terms: &[String], separate: bool, condition: f64) {
        let offsets = match (separate, self.data.one_offset) {
            (false, _) => "",
            (true, false) => " beside the offset of each run",
            (true, true) => " beside one offset of all runs",
        };
        self.note(format!("library [{}]{offsets}, condition number {condition:.1}", terms.join(", ")));
    }

    pub(super) fn warn(&mut self, text: String) {
        self.warnings.push(text);
    }

    pub(super) fn refuse(&mut self, text: String) {
        self.refusals.push(text);
    }

    pub(super) fn judge(&mut self, held_out: Option<f64>, least: f64) {
        let Some(r) = held_out.filter(|r| *r < least) else { return };
        self.refuse(format!(
            "the law explains nothing: R² on left-out data is {r:.3}, and at least {least} is asked for. Record \
             motion with more speed and reversals, or leave the described friction as it is"
        ));
    }

    /// Refuses a law whose data lie beyond a described limit.
    pub(super) fn judge_limit(&mut self, what: &str, share: f64, [limit, largest]: [f64; 2], unit: &str) {
        if share > BEYOND_LIMITS {
            self.refuse(format!(
                "{:.1} % of the {what} exceed the described limit of {} {unit}, up to {}: the \
                 log's columns or units are not this joint's (--columns), or the description's limits are wrong",
                100.0 * share,
                plain(limit, 4),
                plain(largest, 4)
            ));
        }
    }

    /// Doubts a law that takes more than the described effort at a speed that the joint may have and that the data do not show;
    /// refuses it where the data show a small part of the speeds, or where it takes several times as much.
    ///
    /// - `fastest`: largest speed in the data
    ///
    /// # Errors
    /// As [`FrictionLaw::torques`].
    pub(super) fn judge_unseen_speeds(&mut self, law: &FrictionLaw, fastest: f64) -> Result<()> {
        let Some(limits) = self.data.limits else { return Ok(()) };
        let farthest = if limits.velocity.is_finite() { limits.velocity.max(fastest) } else { fastest };
        let shows_little = fastest < SMALL_PART * farthest;
        if shows_little {
            self.warn(format!(
                "the speeds of the log reach {} {}, {:.1} % of the described limit: the law beyond them is a guess",
                plain(fastest, 3),
                self.data.velocity_unit,
                100.0 * fastest / farthest
            ));
        }
        let speeds = (0..=60).flat_map(|i| [1.0, -1.0].map(|sign| sign * farthest * 0.8_f64.powi(i)));
        let speeds: Vec<f64> = speeds.collect();
        let torques = law.torques(&speeds)?;
        let pairs = speeds.iter().zip(&torques).map(|(speed, torque)| [speed.abs(), torque.abs()]);
        let worst = pairs.fold([0.0; 2], |a, b| if b[1] > a[1] { b } else { a });
        let excess = worst[1] / limits.effort;
        if excess > 1.0 {
            let said = self.beyond_effort(worst, limits.effort, fastest);
            if shows_little || excess > ABSURD { self.refuse(said) } else { self.warn(said) }
        }
        Ok(())
    }

    fn beyond_effort(&self, [speed, torque]: [f64; 2], effort: f64, fastest: f64) -> String {
        format!(
            "the law takes {} {} at {} {}, more than the described effort of {}: the data, with speeds up to {}, do not tell the \
             friction there. Record motion with slow reversals and with these speeds, or name fewer terms (--friction \
             viscous,coulomb)",
            plain(torque, 3),
            self.unit,
            plain(speed, 3),
            self.data.velocity_unit,
            plain(effort, 4),
            plain(fastest, 3)
        )
    }

    /// Notes, warnings, and the reason to refuse the law.
    pub(super) fn texts(self) -> (Vec<String>, Vec<String>, Option<String>) {
        let refusal = (!self.refusals.is_empty()).then(|| self.refusals.join("; "));
        (self.notes, self.warnings, refusal)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::result::FrictionTerm;
    use super::super::super::robot::JointLimits;
    use super::*;

    /// What is said of a viscous law of a joint with 4 rad/s and 100 N·m.
    fn said(coefficient: f64, fastest: f64) -> (Vec<String>, Vec<String>) {
        let limits = JointLimits { velocity: 4.0, effort: 100.0, ..JointLimits::NONE };
        let data = FrictionData { limits: Some(limits), ..FrictionData::default() };
        let mut findings = Findings::new(&data);
        let term = FrictionTerm { basis: "v".into(), coefficient, ..FrictionTerm::default() };
        findings.judge_unseen_speeds(&FrictionLaw::Terms(vec![term]), fastest).unwrap();
        (findings.warnings, findings.refusals)
    }

    #[test]
    fn laws_are_judged_at_speeds_that_the_joint_may_have() {
        let none = (Vec::new(), Vec::new());
        assert_eq!(said(24.0, 2.0), none);
        let (warnings, refusals) = said(30.0, 2.0);
        assert!(warnings[0].starts_with("the law takes 120 ") && refusals.is_empty(), "{warnings:?}");
        let (warnings, refusals) = said(300.0, 2.0);
        assert!(warnings.is_empty() && refusals[0].starts_with("the law takes 1200 "), "{refusals:?}");
        // A log that shows a small part of the speeds tells nothing of the others.
        let (warnings, refusals) = said(30.0, 0.1);
        assert!(warnings[0].contains("reach 0.1 , 2.5 % of the described limit"), "{warnings:?}");
        assert!(refusals[0].contains("more than the described effort of 100"), "{refusals:?}");
    }
}
