//! Doubts about the unit of efforts, from the ratio of the estimated rigid-body force to the force of the described bodies.
//!
//! A single joint is weak evidence. If gravity hardly loads the joint, the estimated and the described force
//! are nearly zero. Friction in the gear may then make the estimated force ten times as large. So the joints
//! that carry the robot decide about the unit.

use super::super::error::{IdentificationError, Result};
use super::super::robot::Robot;
use super::super::run::Effort;
use super::levels;
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule};

/// Sees: rigid-body forces that differ from the described ones by a factor above 3 at the joints that carry the robot.
/// Matters: efforts are probably in another unit. Beyond a factor of 10 the result is refused.
/// Example: efforts of motors before their gears.
/// Fixture: `hundredths` in `codegen/tests/findings/arm.rs`.
pub(super) const COMMON_FACTOR: Rule = Rule::error("other-unit-of-efforts");

/// Sees: an estimated rigid-body force that differs from the described force by a factor above 3 at one joint.
/// Matters: the unit of its effort, its gear ratio or a described mass is wrong.
/// Example: one effort in mN m.
/// Fixture: `estimation/tests/simulated.rs`.
const JOINT_FACTOR: Rule = Rule::warning("other-unit-of-effort");

/// Units that are tried for recorded torques.
const UNITS: [&str; 3] = ["mNm", "Ncm", "kNm"];
/// Estimated rigid force, described rigid force, and measured force, each as the root of a sum of squares.
pub(super) type Sizes = [f64; 3];

/// The median ratio of estimated to described rigid-body forces over the revolute joints, or over the prismatic joints.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CommonRatio {
    pub(super) factor: f64,
    /// Names of the joints over which the median is taken.
    joints: Vec<String>,
    /// Unit of the joints' positions, rad or m.
    unit: &'static str,
    effort: Effort,
}

/// The ratio of the revolute joints or the ratio of the prismatic joints, whichever is farther from 1; `None` if no joint
/// carries the robot.
///
/// - `known`: for each joint, whether it moves and its effort was measured
pub(super) fn common_ratio(
    robot: &dyn Robot,
    effort: Effort,
    known: &[bool],
    sizes: &[Sizes],
) -> Option<CommonRatio> {
    let (names, units) = (robot.joint_names(), robot.position_units());
    let of = |unit: &'static str| {
        let known = (0..known.len()).filter(|joint| known[*joint]);
        let known: Vec<usize> = known.filter(|joint| (units[*joint] == "m") == (unit == "m")).collect();
        let largest = known.iter().map(|joint| sizes[*joint][1]).fold(0.0, f64::max);
        let mut carrying: Vec<(f64, usize)> = known
            .into_iter()
            .filter(|joint| sizes[*joint][1] >= levels::CARRIES.get() * largest && sizes[*joint][1] > 0.0)
            .map(|joint| (sizes[joint][0] / sizes[joint][1], joint))
            .collect();
        carrying.sort_by(|a, b| a.0.total_cmp(&b.0));
        let factor = middle(&carrying.iter().map(|(ratio, _)| *ratio).collect::<Vec<_>>())?;
        let joints = carrying.iter().map(|(_, joint)| names[*joint].clone()).collect();
        Some(CommonRatio { factor, joints, unit, effort })
    };
    let distance = |ratio: &CommonRatio| ratio.factor.max(f64::MIN_POSITIVE).ln().abs();
    [of("rad"), of("m")].into_iter().flatten().max_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// The median of ascending ratios. The median of an even number is the geometric mean of the two middle ones.
fn middle(ratios: &[f64]) -> Option<f64> {
    let half = ratios.len() / 2;
    let upper = *ratios.get(half)?;
    Some(if ratios.len().is_multiple_of(2) { (ratios[half - 1] * upper).sqrt() } else { upper })
}

impl CommonRatio {
    /// A doubt about the efforts of the robot as a whole; `None` if the ratio is near 1.
    ///
    /// - `unit`: returns the finding with a unit in which the efforts are explained better; `None` if there is no such unit
    ///
    /// # Errors
    /// [`IdentificationError::Found`] with the ratio and its likely causes, if the ratio is far from 1 and this is not
    /// accepted.
    pub(crate) fn judged(
        &self,
        accept_poor: bool,
        unit: impl FnOnce() -> Result<Option<Finding>>,
    ) -> Result<Option<Finding>> {
        if !self.is_other() {
            return Ok(None);
        }
        let finding = unit()?.unwrap_or_else(|| self.finding(None, &COMMON_FACTOR));
        if self.is_within(levels::ANOTHER_UNIT.get()) || accept_poor {
            return Ok(Some(finding.accepted()));
        }
        Err(IdentificationError::Found { findings: vec![finding] })
    }

    /// Whether the efforts may be in another unit.
    pub(super) fn is_other(&self) -> bool {
        !self.is_within(levels::OTHER_UNIT.get())
    }

    fn is_within(&self, factor: f64) -> bool {
        (1.0 / factor..=factor).contains(&self.factor)
    }

    /// Units that are tried.
    pub(super) fn units(&self) -> &'static [&'static str] {
        if self.unit == "m" || self.effort == Effort::Current { &[] } else { &UNITS }
    }

    /// Finding that the unit of the efforts is probably wrong.
    ///
    /// - `guess`: a unit in which the efforts are explained better
    pub(super) fn finding(&self, guess: Option<&str>, rule: &Rule) -> Finding {
        let (key, unit) = match self.effort {
            Effort::Input => ("input", if self.unit == "m" { "N" } else { "Nm" }),
            Effort::Joint => ("torque", if self.unit == "m" { "N" } else { "Nm" }),
            Effort::Current => ("current", "A"),
        };
        let guess = guess.map(|name| format!("they may be in {name} (--columns '{key}=…[{name}]'); "));
        let usual = if self.effort == Effort::Current {
            "the described motor constants may be wrong"
        } else if self.factor < 1.0 {
            "use --effort input for efforts on the motor side of the gears, and --effort current for currents"
        } else {
            "use --effort current for currents, and --effort joint for efforts on the output side of the gears"
        };
        let message = format!(
            "the rigid-body forces in the efforts are {} times the forces of the described bodies (joints {})",
            plain(self.factor, 3),
            self.joints.join(", ")
        );
        let remedy = format!(
            "{}{usual}; give counts and percents a factor, for example --columns '{key}=…[0.05 {unit}]'. If the efforts are right, \
             check the unit of the positions, the described masses and the direction of gravity. --accept-poor uses the efforts as \
             they are",
            guess.unwrap_or_default()
        );
        rule.found(message).with("factor", self.factor, "").help(remedy)
    }
}

/// A doubt about the unit of one joint's effort; `None` if the ratio is near 1 or the described force is small.
pub(super) fn unit_doubt([rigid, described, measured]: Sizes) -> Option<Finding> {
    let ratio = rigid / described;
    let matters = described > levels::CARRIES.get() * measured;
    (matters && !(1.0 / levels::OTHER_UNIT.get()..=levels::OTHER_UNIT.get()).contains(&ratio)).then(|| {
        let message = format!(
            "the rigid-body force in its effort is {} times the force of the described bodies",
            plain(ratio, 3)
        );
        let remedy =
            "check the described masses and the gear ratio, and look for forces that the description lacks";
        JOINT_FACTOR.found(message).with("factor", ratio, "").help(remedy)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_is_between_the_middle_ones() {
        assert_eq!(middle(&[]), None);
        assert_eq!(middle(&[2.0]), Some(2.0));
        assert_eq!(middle(&[1.0, 4.0]), Some(2.0));
        assert_eq!(middle(&[0.1, 1.0, 50.0]), Some(1.0));
    }
}
