//! What is said of rows that are shafts.

use super::super::digits::{plain, rounded};
use super::super::error::IdentificationError;
use super::super::estimation::{Estimate, Uncertain};
use super::super::robot::Robot;
use super::ShaftRows;

impl ShaftRows {
    /// A sentence about rows, which calls shafts what they are: "Joint left_motor" is the shaft of that drive.
    #[must_use]
    pub fn worded(&self, sentence: &str) -> String {
        let mut text = sentence.to_owned();
        for name in self.shafts().iter().map(|shaft| &shaft.name) {
            for (joint, shaft) in [("Joint", "The shaft of"), ("joint", "the shaft of")] {
                text = with_word(&text, &format!("{joint} {name}"), &format!("{shaft} {name}"));
            }
        }
        text
    }

    /// Calls shafts what they are in all that is said of an estimate, and says first where friction was looked for.
    ///
    /// - `robot`: the one with joints as rows
    /// - `faults`: further sentences about rows
    pub(crate) fn word<'s>(
        &self,
        robot: &dyn Robot,
        estimate: &mut Estimate,
        faults: impl Iterator<Item = &'s mut String>,
    ) {
        let word = |sentence: &mut String| *sentence = self.worded(sentence);
        faults.for_each(word);
        estimate.choices.iter_mut().chain(&mut estimate.warnings).for_each(word);
        estimate.choices.splice(0..0, self.said(robot, estimate));
    }

    /// Where friction was looked for, in sentences.
    fn said(&self, robot: &dyn Robot, estimate: &Estimate) -> Vec<String> {
        let names: Vec<&str> = self.shafts().iter().map(|shaft| shaft.name.as_str()).collect();
        let shafts = format!(
            "Drives that act on several joints have friction on their shafts, over the motors' speeds, and rows of torques at \
             the motors: {}.",
            names.join(", ")
        );
        let joints = robot.joint_names();
        let factors = estimate.parameters.get(self.first_term()..).unwrap_or_default();
        let term = |(term, factor): (&super::JointTerm, &Uncertain)| {
            let [low, high] = factor.interval;
            let error = Some(0.5 * (high - low));
            format!(
                "Friction {} of joint {} is estimated beside that of the shafts, near its description where the data cannot \
                 tell: {} becomes {} ({} to {}).",
                term.basis,
                joints[term.joint],
                plain(term.coefficient, 4),
                rounded(factor.value, error),
                rounded(low, error),
                rounded(high, error)
            )
        };
        std::iter::once(shafts).chain(self.joint_terms().iter().zip(factors).map(term)).collect()
    }
}

/// An error about rows, which calls shafts what they are.
pub(crate) fn in_words(error: IdentificationError, rows: Option<&ShaftRows>) -> IdentificationError {
    let Some(rows) = rows else { return error };
    match error {
        IdentificationError::Unexplained { joint, r_squared, least, reasons } => {
            let is_shaft = rows.shafts().iter().any(|shaft| shaft.name == joint);
            let joint = if is_shaft { format!("{joint} (the shaft of this drive)") } else { joint };
            IdentificationError::Unexplained { joint, r_squared, least, reasons: rows.worded(&reasons) }
        }
        other => other,
    }
}

/// The text with a phrase replaced where it ends with a word.
fn with_word(text: &str, old: &str, new: &str) -> String {
    let mut found = String::new();
    let mut rest = text;
    while let Some(place) = rest.find(old) {
        let end = place + old.len();
        let goes_on = rest[end..].starts_with(|c: char| c.is_alphanumeric() || c == '_');
        found.push_str(&rest[..place]);
        found.push_str(if goes_on { old } else { new });
        rest = &rest[end..];
    }
    found.push_str(rest);
    found
}
