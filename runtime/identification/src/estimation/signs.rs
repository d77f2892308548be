//! Test of the sign of each effort, and the findings about friction that drives a joint.

use super::super::error::Result;
use super::layout::{ARMATURE, LOAD};
use super::levels;
use super::trial::{Bodies, Case, Change, Hypothesis};
use gelenk_findings::{Finding, Rule};

/// Sees: efforts of a joint that fit the rigid body better with the other sign.
/// Matters: friction would drive the joint, and its masses would be wrong.
/// Example: a torque whose positive direction is opposite to that of the position.
/// Fixture: `sign` in `codegen/tests/findings/arm.rs`.
const OTHER_SIGN: Rule = Rule::error("other-sign");

/// Sees: friction that drives a joint, and a rigid body that does not fit better with the other sign.
/// Matters: such a law is not passive.
/// Example: a controller that compensates more friction than there is.
/// Fixture: `estimation/tests/pendulum.rs`.
const DRIVING: Rule = Rule::error("driving-friction");

/// Sees: a log with too few samples to distinguish friction from noise.
/// Matters: a wrong sign cannot be detected.
/// Example: 2 s of slow motion.
/// Fixture: `a_wrong_sign_and_forces_that_are_noise_are_refused` in `estimation/tests/simulated.rs`.
const TOO_SHORT: Rule = Rule::error("log-too-short");

const SIGNS: Hypothesis = Hypothesis { each: true, ..Hypothesis::of(OTHER_SIGN, signs, other_sign) };

impl Case<'_> {
    /// Doubts about the sign of each joint's effort.
    pub(super) fn signs(&self) -> Result<Vec<Finding>> {
        let mut doubts = self.offered(&SIGNS)?;
        for joint in self.layout().rubbing().filter(|joint| self.drives(*joint)) {
            let driving = driving().of(self.robot.subject(joint));
            if doubts.iter().all(|doubt| doubt.about != driving.about) {
                doubts.push(driving);
            }
        }
        let short = self.too_short();
        let said = |doubt: Finding| match &short {
            Some(short) => short.clone().of(doubt.about.subject),
            None => doubt,
        };
        Ok(doubts.into_iter().map(said).collect())
    }

    /// Finding that replaces a doubt about a sign if there are too few samples to distinguish friction from noise; `None` if
    /// there are enough samples. The criterion is the number of samples, because a wrong sign makes the correlation time of the
    /// residuals long.
    pub(super) fn too_short(&self) -> Option<Finding> {
        let task = self.checked?.task;
        let samples: usize = task.runs.iter().map(|run| run.times.len()).sum();
        (samples < levels::FEWEST_SAMPLES.get()).then(|| {
            let message = format!(
                "the log is too short: {samples} samples are left after the filter, and friction cannot be distinguished from noise"
            );
            TOO_SHORT.found(message).help("record a motion of 10 s or more")
        })
    }

    /// Whether the estimated friction τ(v) drives the joint noticeably: `Σ v τ(v)` is clearly negative.
    fn drives(&self, joint: usize) -> bool {
        let (layout, chosen) = (self.layout(), self.chosen);
        let products = &chosen.centred.all[joint];
        let first = layout.first_term(joint);
        let term =
            |term: usize| chosen.values.unknowns[layout.term(joint, term)] * products[(first, first + term)];
        let power: f64 = (0..ARMATURE).chain(LOAD..layout.terms).map(term).sum();
        let last = products.nrows() - 1;
        let scale =
            chosen.values.gains[joint].abs() * (products[(first, first)] * products[(last, last)]).sqrt();
        power < -levels::NOTICEABLE_POWER.get() * scale
    }
}

/// Whether a finding says that friction drives a joint and that no remedy is known.
pub(super) fn is_driving(finding: &Finding) -> bool {
    finding.code == DRIVING.code
}

fn driving() -> Finding {
    let message = "its estimated friction drives it. With the other sign of its effort, friction would brake, but the fit would \
                   not be better";
    let remedy = "check the sign, the unit and the assignment of its columns, and whether the robot's controller compensates friction";
    DRIVING.found(message).help(remedy)
}

/// For each effort that is hardly explained or whose estimated friction drives the joint, the change to the other sign.
fn signs(case: &Case) -> Result<Vec<Change>> {
    let r_squared = case.chosen.centred_r_squared(&case.own(Bodies::Fitted).rss);
    let is_doubted = |joint: &usize| case.drives(*joint) || r_squared[*joint] < levels::POOR.get();
    Ok(case.layout().rubbing().filter(is_doubted).map(|joint| Change::Factor(Some(joint), -1.0)).collect())
}

fn other_sign(_: &Case, _: &Change, rule: &Rule) -> Result<Option<Finding>> {
    Ok(Some(rule.found("the data are explained better with the other sign of its effort").help(
        "check the signs of effort and position. To change the sign of all efforts, use --columns 'torque=tau{}[-1 Nm]'; to change \
         one sign, use --columns 'torque=tau1|tau2[-1 Nm]|tau3'",
    )))
}
