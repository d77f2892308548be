//! Limits as URDFs have them: 0, infinite and reversed ones are common, and none of them enters the
//! equations.

use super::JointKind;
use super::description::{LimitsDescription, Name};
use super::urdf::{Reader, XmlNode};
use super::urdf_notes::Remark;
use crate::diagnostic::At;
use gelenk_formula::LARGEST_NUMBER;

/// What a file says about a limit.
enum Limit<T> {
    Given(At<T>),
    /// Nothing, 0, or infinity.
    Unset,
    /// Reversed or negative.
    Unusable,
    /// No number, which is an error already.
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
            Self::Unset => Some(Remark::LimitUnset),
            Self::Unusable => Some(Remark::LimitUnusable),
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
                self.notes.remark(Remark::LimitMissing, name.span, owner);
            }
            return LimitsDescription::default();
        };
        let position = self.position_limits(node);
        let (velocity, effort) = (self.amount(node, "velocity"), self.amount(node, "effort"));
        let of_position = match (&position, turns_freely) {
            (position, false) => position.remark(),
            (Limit::Unset | Limit::Broken, true) => None,
            (_, true) => Some(Remark::ContinuousLimits),
        };
        let mut remarks = vec![of_position, velocity.remark(), effort.remark()];
        remarks.sort();
        remarks.dedup();
        let span = self.span(node);
        for remark in remarks.into_iter().flatten() {
            self.notes.remark(remark, span, owner.clone());
        }
        LimitsDescription {
            position: position.given().filter(|_| !turns_freely),
            velocity: velocity.given(),
            effort: effort.given(),
            peak_effort: None,
        }
    }

    /// A bound that is not given is 0.
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
            Some(_) if low > high => Limit::Unusable,
            _ => Limit::Unset,
        }
    }

    /// A largest speed or force.
    fn amount(&mut self, node: XmlNode<'_>, key: &str) -> Limit<f64> {
        match self.bound(node, key) {
            Err(NotANumber) => Limit::Broken,
            Ok(Some(limit)) if limit.value < 0.0 => Limit::Unusable,
            Ok(Some(limit)) if limit.value > 0.0 && limit.value.is_finite() => Limit::Given(limit),
            Ok(_) => Limit::Unset,
        }
    }

    /// A number, infinite where it is beyond what equations take.
    fn bound(&mut self, node: XmlNode<'_>, key: &str) -> Result<Option<At<f64>>, NotANumber> {
        let Some(attribute) = node.attribute_node(key) else {
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

/// It was reported.
struct NotANumber;
