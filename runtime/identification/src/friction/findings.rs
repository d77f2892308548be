//! Findings about a friction law while it is identified: doubts, and reasons to refuse it.

use super::super::error::Result;
use super::super::methods::library::Library;
use super::super::result::FrictionLaw;
use super::levels;
use super::settings::SETTINGS;
use super::task::FrictionData;
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule};

/// Sees: a law that explains less of held-out data than required.
/// Matters: the law describes noise.
/// Example: a joint that moved once, slowly.
/// Fixture: `friction/tests.rs`.
const POOR_LAW: Rule = Rule::error("poor-law");

/// Sees: a log that contains a small part of the described range of speeds.
/// Matters: the law is an extrapolation at higher speeds.
/// Example: a motion at 0.1 rad/s of a joint with a limit of 3 rad/s.
/// Fixture: `laws_are_judged_at_speeds_that_the_joint_may_have` in `friction/findings.rs`.
const SLOW_LOG: Rule = Rule::warning("slow-log");

/// Sees: a law that exceeds the described effort at a speed outside the data.
/// Matters: the law is wrong there. If it exceeds the effort several times, it is refused.
/// Example: a steep term of a slow log.
/// Fixture: `laws_are_judged_at_speeds_that_the_joint_may_have` in `friction/findings.rs`.
const BEYOND_EFFORT: Rule = Rule::error("law-beyond-effort");

/// Inputs of the findings, and the findings that were made.
pub(super) struct Findings<'a> {
    pub(super) data: &'a FrictionData<'a>,
    pub(super) notes: Vec<Finding>,
    pub(super) all: Vec<Finding>,
}

impl<'a> Findings<'a> {
    pub(super) fn new(data: &'a FrictionData<'a>) -> Self {
        Self { data, notes: data.settings.to_vec(), all: Vec::new() }
    }

    /// Notes a setting.
    pub(super) fn note(&mut self, message: impl Into<String>) {
        self.notes.push(SETTINGS.found(message));
    }

    /// Notes the terms from which the law is chosen.
    ///
    /// - `offsets`: words on the offsets that are estimated in addition to the law
    /// - `condition`: condition number of the scaled terms
    pub(super) fn note_library(&mut self, library: &Library, offsets: &str, condition: f64) {
        let terms = library.terms().join(", ");
        let message = format!(
            "the law is chosen from the terms [{terms}]{offsets}. Their condition number is {condition:.1}"
        );
        self.notes.push(SETTINGS.found(message).with("condition number", condition, ""));
    }

    pub(super) fn add(&mut self, finding: Finding) {
        self.all.push(finding);
    }

    pub(super) fn judge(&mut self, held_out: Option<f64>, least: f64) {
        let Some(r) = held_out.filter(|r| *r < least) else { return };
        let message = format!(
            "the law explains too little. R² on held-out data is {r:.3}, but at least {least} is required"
        );
        let remedy = "record motion with more speed and reversals, or leave the described friction as it is";
        self.add(POOR_LAW.found(message).help(remedy));
    }

    /// Adds findings if a law needs more than the described effort at a speed that the joint may have but the
    /// data do not contain. The finding is a warning. It is an error in two cases: the data contain only a
    /// small part of the speeds, or the law needs several times the described effort. An error refuses the
    /// law.
    ///
    /// - `fastest`: largest speed in the data
    ///
    /// # Errors
    /// The errors are those of [`FrictionLaw::torques`].
    pub(super) fn judge_unseen_speeds(&mut self, law: &FrictionLaw, fastest: f64) -> Result<()> {
        let Some(limits) = self.data.limits else { return Ok(()) };
        let farthest = if limits.velocity.is_finite() { limits.velocity.max(fastest) } else { fastest };
        let shows_little = fastest < levels::SMALL_PART.get() * farthest;
        if shows_little {
            self.add(SLOW_LOG.found(format!(
                "the speeds of the log reach only {} {}, {:.1} % of the described limit. At higher speeds, the law is an extrapolation",
                plain(fastest, 3),
                self.data.velocity_unit,
                100.0 * fastest / farthest
            )));
        }
        let speeds = (0..=60).flat_map(|i| [1.0, -1.0].map(|sign| sign * farthest * 0.8_f64.powi(i)));
        let speeds: Vec<f64> = speeds.collect();
        let torques = law.torques(&speeds)?;
        let pairs = speeds.iter().zip(&torques).map(|(speed, torque)| [speed.abs(), torque.abs()]);
        let worst = pairs.fold([0.0; 2], |a, b| if b[1] > a[1] { b } else { a });
        let excess = worst[1] / limits.effort;
        if excess > 1.0 {
            let found = self.beyond_effort(worst, limits.effort, fastest);
            self.add(if shows_little || excess > levels::ABSURD.get() { found } else { found.accepted() });
        }
        Ok(())
    }

    fn beyond_effort(&self, [speed, torque]: [f64; 2], effort: f64, fastest: f64) -> Finding {
        let message = format!(
            "the law gives {} {} at {} {}, more than the described effort limit of {}. The data reach only speeds up to {}, so \
             they do not determine this friction",
            plain(torque, 3),
            self.data.unit,
            plain(speed, 3),
            self.data.velocity_unit,
            plain(effort, 4),
            plain(fastest, 3)
        );
        BEYOND_EFFORT.found(message).help(
            "record motion with slow reversals and with higher speeds, or name fewer terms, as in --friction viscous,coulomb",
        )
    }

    /// The notes on the settings, and the findings about the joint.
    pub(super) fn parts(self) -> [Vec<Finding>; 2] {
        [self.notes, self.all]
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::result::FrictionTerm;
    use super::super::super::robot::JointLimits;
    use super::*;
    use gelenk_findings::Severity;

    /// Warnings and errors about a viscous law of a joint with 4 rad/s and 100 N·m.
    fn said(coefficient: f64, fastest: f64) -> (Vec<String>, Vec<String>) {
        let limits = JointLimits { velocity: 4.0, effort: 100.0, ..JointLimits::NONE };
        let data = FrictionData { limits: Some(limits), ..FrictionData::default() };
        let mut findings = Findings::new(&data);
        let term = FrictionTerm { basis: "v".into(), coefficient, ..FrictionTerm::default() };
        findings.judge_unseen_speeds(&FrictionLaw::Terms(vec![term]), fastest).unwrap();
        let of = |severity: Severity| {
            let all = findings.all.iter().filter(|finding| finding.severity == severity);
            all.map(ToString::to_string).collect()
        };
        (of(Severity::Warning), of(Severity::Error))
    }

    #[test]
    fn laws_are_judged_at_speeds_that_the_joint_may_have() {
        let none = (Vec::new(), Vec::new());
        assert_eq!(said(24.0, 2.0), none);
        let (warnings, refusals) = said(30.0, 2.0);
        assert!(
            warnings[0].contains("[law-beyond-effort]: the law gives 120 ") && refusals.is_empty(),
            "{warnings:?}"
        );
        let (warnings, refusals) = said(300.0, 2.0);
        assert!(
            warnings.is_empty() && refusals[0].contains("[law-beyond-effort]: the law gives 1200 "),
            "{refusals:?}"
        );
        // A log with a small part of the speeds does not determine the law at higher speeds.
        let (warnings, refusals) = said(30.0, 0.1);
        assert!(
            warnings[0].starts_with("warning[slow-log]")
                && warnings[0].contains("reach only 0.1 , 2.5 % of the described limit"),
            "{warnings:?}"
        );
        assert!(refusals[0].contains("more than the described effort limit of 100"), "{refusals:?}");
    }
}
