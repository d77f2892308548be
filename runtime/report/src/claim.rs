//! Claims with verdicts that follow from numbers and thresholds.

use std::fmt;

use super::number::{DIGITS, rounded};

/// A statement with measured values and a verdict.
///
/// The verdict follows from the criteria and cannot be set. A claim without criteria does not hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    /// Anchor on the page, and name of the claim in JSON and CSV.
    pub id: String,
    /// Statement of the claim as a sentence; `$…$` is an equation in LaTeX.
    pub statement: String,
    /// Numbers with thresholds. All thresholds must be met.
    pub criteria: Vec<Criterion>,
    /// Condition under which the claim holds; `None` if the claim has no condition.
    pub condition: Option<String>,
    /// Change of the experiment that would reverse the verdict; may be empty.
    pub flipped_by: String,
    /// Remark on the result; may be empty.
    pub remark: String,
    /// Identifier of the figure or table that shows the claim; `None` without figure or table.
    pub shown_in: Option<String>,
}

/// A measured number and its threshold.
#[derive(Debug, Clone, PartialEq)]
pub struct Criterion {
    /// Name of the measured quantity.
    pub name: String,
    /// Measured value.
    pub value: f64,
    /// Threshold for the value.
    pub bound: Bound,
    /// Unit of value and threshold; may be empty.
    pub unit: String,
}

/// Threshold for a measured value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bound {
    /// Largest value that meets the threshold.
    AtMost(f64),
    /// Smallest value that meets the threshold.
    AtLeast(f64),
}

/// Verdict on a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// All criteria are met, and the claim has no condition.
    Holds,
    /// All criteria are met, and the claim has a condition.
    HoldsConditionally,
    /// A criterion is not met, or the claim has no criteria.
    DoesNotHold,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Holds => "holds",
            Self::HoldsConditionally => "holds under a condition",
            Self::DoesNotHold => "does not hold",
        })
    }
}

impl Claim {
    /// A claim without criteria; `$…$` in the statement is an equation in LaTeX.
    #[must_use]
    pub fn new(id: impl Into<String>, statement: impl Into<String>) -> Self {
        Self {
            id: id.into(),
            statement: statement.into(),
            criteria: Vec::new(),
            condition: None,
            flipped_by: String::new(),
            remark: String::new(),
            shown_in: None,
        }
    }

    /// Adds a measured number with its threshold.
    #[must_use]
    pub fn criterion(mut self, criterion: Criterion) -> Self {
        self.criteria.push(criterion);
        self
    }

    /// Sets the condition under which the claim holds.
    #[must_use]
    pub fn under(mut self, condition: impl Into<String>) -> Self {
        self.condition = Some(condition.into());
        self
    }

    /// Sets the change of the experiment that would reverse the verdict.
    #[must_use]
    pub fn flipped_by(mut self, cause: impl Into<String>) -> Self {
        self.flipped_by = cause.into();
        self
    }

    /// Adds a remark.
    #[must_use]
    pub fn remark(mut self, remark: impl Into<String>) -> Self {
        self.remark = remark.into();
        self
    }

    /// Sets the figure or table that shows the claim.
    #[must_use]
    pub fn shown_in(mut self, id: impl Into<String>) -> Self {
        self.shown_in = Some(id.into());
        self
    }

    /// Verdict that follows from the criteria and the condition.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let is_met = !self.criteria.is_empty() && self.criteria.iter().all(Criterion::is_met);
        match (is_met, &self.condition) {
            (false, _) => Verdict::DoesNotHold,
            (true, None) => Verdict::Holds,
            (true, Some(_)) => Verdict::HoldsConditionally,
        }
    }
}

impl Criterion {
    /// A criterion that is met if `value ≤ bound`.
    #[must_use]
    pub fn at_most(name: impl Into<String>, value: f64, bound: f64, unit: impl Into<String>) -> Self {
        Self { name: name.into(), value, bound: Bound::AtMost(bound), unit: unit.into() }
    }

    /// A criterion that is met if `value ≥ bound`.
    #[must_use]
    pub fn at_least(name: impl Into<String>, value: f64, bound: f64, unit: impl Into<String>) -> Self {
        Self { bound: Bound::AtLeast(bound), ..Self::at_most(name, value, bound, unit) }
    }

    /// Whether the value meets its threshold; false for NaN.
    #[must_use]
    pub fn is_met(&self) -> bool {
        match self.bound {
            Bound::AtMost(bound) => self.value <= bound,
            Bound::AtLeast(bound) => self.value >= bound,
        }
    }

    /// The threshold as text, for example `≤ 0.01 rad`.
    pub(super) fn threshold(&self) -> String {
        let (sign, bound) = match self.bound {
            Bound::AtMost(bound) => ("≤", bound),
            Bound::AtLeast(bound) => ("≥", bound),
        };
        format!("{sign} {}", with_unit(super::number::exact(bound), &self.unit))
    }

    /// The measured number as text, for example `0.00412 rad`.
    pub(super) fn measured(&self) -> String {
        with_unit(rounded(self.value, DIGITS), &self.unit)
    }
}

fn with_unit(number: String, unit: &str) -> String {
    match unit {
        "" => number,
        unit => format!("{number}\u{a0}{unit}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn claim(value: f64) -> Claim {
        Claim::new("c", "c").criterion(Criterion::at_most("error", value, 1.0, "rad"))
    }

    #[test]
    fn verdicts_follow_from_numbers() {
        assert_eq!(claim(1.0).verdict(), Verdict::Holds);
        assert_eq!(claim(1.0).under("x").verdict(), Verdict::HoldsConditionally);
        assert_eq!(claim(1.1).under("x").verdict(), Verdict::DoesNotHold);
        assert_eq!(claim(f64::NAN).verdict(), Verdict::DoesNotHold);
        assert_eq!(Claim::new("c", "c").verdict(), Verdict::DoesNotHold);
        let gain = Criterion::at_least("gain", f64::NAN, 0.0, "");
        assert_eq!(claim(0.0).criterion(gain).verdict(), Verdict::DoesNotHold);
    }
}
