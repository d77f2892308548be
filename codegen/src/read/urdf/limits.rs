//! Limits in URDFs. Limits that are 0, infinite or reversed are common. No limit affects the equations.

use super::notes;
use super::values::of_any_tool;
use super::{Reader, XmlNode};
use crate::description::{LimitsDescription, Name};
use crate::diagnostic::At;
use crate::model::JointKind;
use crate::read::skipped::Remark;
use gelenk_formula::LARGEST_NUMBER;

/// A limit of position, speed or force as the file gives it.
enum Limit<T> {
    Given(At<T>),
    /// The limit is absent, 0 or infinite.
    Unset,
    /// Position limits are reversed or equal, or another limit is negative.
    Unusable,
    /// The limit is not a number. An error was already reported.
    Broken,
}

impl<T> Limit<T> {
    fn given(self) -> Option<At<T>> {
        match self {
            Self::Given(limit) => Some(limit),
            _ => None,
        }
    }

    fn remark(&self) -> Option<Remark> {
        match self {
            Self::Unset => Some(notes::LIMIT_UNSET),
            Self::Unusable => Some(notes::LIMIT_UNUSABLE),
            Self::Given(_) | Self::Broken => None,
        }
    }
}

impl Reader<'_> {
    pub(super) fn limits(
        &mut self,
        joint: XmlNode<'_>,
        kind: Option<JointKind>,
        name: &Name,
    ) -> LimitsDescription {
        let owner = name.quoted();
        if kind == Some(JointKind::Fixed) {
            return LimitsDescription::default();
        }
        let turns_freely = kind == Some(JointKind::Continuous);
        let Some(node) = self.single(joint, "limit", &owner) else {
            if !turns_freely {
                self.notes.remark(notes::LIMIT_MISSING, name.span, owner);
            }
            return LimitsDescription::default();
        };
        let position = self.position_limits(node);
        let keys = ["velocity", "effort", "acceleration", "deceleration", "jerk"];
        let amounts = keys.map(|key| self.amount(node, key));
        let of_position = match (&position, turns_freely) {
            (position, false) => position.remark(),
            (Limit::Unset | Limit::Broken, true) => None,
            (_, true) => Some(notes::CONTINUOUS_LIMITS),
        };
        // The last three attributes are new in URDF 1.1. If they are 0 or absent, there is no limit and no remark.
        let of_amounts = amounts.iter().enumerate().filter_map(|(index, amount)| match amount {
            Limit::Unset if index > 1 => None,
            amount => amount.remark(),
        });
        let mut remarks: Vec<Option<Remark>> = of_amounts.map(Some).chain([of_position]).collect();
        remarks.sort();
        remarks.dedup();
        let span = self.span(node);
        for remark in remarks.into_iter().flatten() {
            self.notes.remark(remark, span, owner.clone());
        }
        let [velocity, effort, acceleration, deceleration, jerk] = amounts.map(Limit::given);
        let smaller = |limit: &At<f64>, other: &At<f64>| limit.value.total_cmp(&other.value);
        LimitsDescription {
            position: position.given().filter(|_| !turns_freely),
            velocity,
            effort,
            peak_effort: None,
            acceleration: acceleration.into_iter().chain(deceleration).min_by(smaller),
            jerk,
        }
    }

    /// Reads the position limits of a joint. An absent bound is 0.
    fn position_limits(&mut self, node: XmlNode<'_>) -> Limit<[f64; 2]> {
        let bounds = ["lower", "upper"].map(|key| self.bound(node, key));
        let [Ok(lower), Ok(upper)] = bounds else {
            return Limit::Broken;
        };
        let value = |bound: &Option<At<f64>>| bound.as_ref().map_or(0.0, |bound| bound.value);
        let (low, high) = (value(&lower), value(&upper));
        match upper.or(lower) {
            Some(bound) if low < high && (high - low).is_finite() => {
                Limit::Given(At::new([low, high], bound.span))
            }
            Some(_) if low > high || (low == high && low != 0.0) => Limit::Unusable,
            _ => Limit::Unset,
        }
    }

    /// Reads a limit on speed, force or another amount.
    fn amount(&mut self, node: XmlNode<'_>, key: &str) -> Limit<f64> {
        match self.bound(node, key) {
            Err(NotANumber) => Limit::Broken,
            Ok(Some(limit)) if limit.value < 0.0 => Limit::Unusable,
            Ok(Some(limit)) if limit.value > 0.0 && limit.value.is_finite() => Limit::Given(limit),
            Ok(_) => Limit::Unset,
        }
    }

    /// Reads a number of a limit. It becomes infinite if it exceeds the largest number of descriptions.
    fn bound(&mut self, node: XmlNode<'_>, key: &str) -> Result<Option<At<f64>>, NotANumber> {
        let Some(attribute) = of_any_tool(node, key) else {
            return Ok(None);
        };
        match attribute.value().trim().parse::<f64>() {
            Ok(number) if number.abs() > LARGEST_NUMBER => {
                let infinite = f64::INFINITY.copysign(number);
                Ok(Some(At::new(infinite, self.attribute_span(attribute))))
            }
            _ => self.number(node, key).map(Some).ok_or(NotANumber),
        }
    }
}

/// Error of an attribute that is not a number. It was already reported.
struct NotANumber;
