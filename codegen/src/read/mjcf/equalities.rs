//! Reading of equalities of joints and fixed tendons. They become couplings.

use std::collections::BTreeSet;

use super::actuators::Sums;
use super::files::Element;
use super::schema::Place;
use super::{Placed, Reader, notes};
use crate::description::FollowsDescription;
use crate::diagnostic::{At, Span, nearest};
use gelenk_formula::Formula;

impl<'a> Reader<'_, 'a> {
    pub(super) fn equalities(&mut self, section: Element<'a>, sums: &Sums) {
        for element in self.known_children(Place::Equalities, section) {
            let class = self.class(element, "class", 0);
            let placed = Placed::outside(element, class);
            let active = element.attribute("active");
            let active = active.or_else(|| self.classes.attribute(class, "equality", "active"));
            if active.is_some_and(|given| given.text == "false") {
                self.notes.skip(format!("<{}>", element.tag()), element.span());
                continue;
            }
            match element.tag() {
                "joint" if self.options.ignore_mimic => {}
                "joint" | "tendon" => self.equality(&placed, sums),
                _ => self.opened(element),
            }
        }
    }

    fn opened(&mut self, element: Element<'a>) {
        let name = element.node.attribute("name");
        let name = name.map_or(format!("<{}>", element.tag()), |name| format!("`{name}`"));
        self.notes.remark(notes::LOOP, element.span(), name);
    }

    /// Reads `length1 − length1₀ = a₀ + a₁ (length2 − length2₀)`. The length of a joint is its position, and
    /// that of a fixed tendon a weighted sum of positions.
    fn equality(&mut self, placed: &Placed<'a>, sums: &Sums) {
        let element = placed.element;
        let polynomial = self.numbers_of(placed);
        let at = |index: usize| polynomial.get(index).copied().unwrap_or(0.0);
        let Some(first) = self.length(element, '1', 1.0, sums) else { return };
        let second = match element.attribute(&format!("{}2", element.tag())) {
            Some(_) => self.length(element, '2', -at(1), sums),
            None => Some(Vec::new()),
        };
        let Some(second) = second else { return };
        let mut terms = [first, second].concat();
        terms.retain(|(_, factor)| *factor != 0.0);
        let names: BTreeSet<&String> = terms.iter().map(|(joint, _)| joint).collect();
        let is_linear = polynomial.iter().skip(2).all(|factor| *factor == 0.0);
        let has_quaternion =
            |name: &&String| self.joints.get(*name).is_some_and(|joint| joint.has_quaternion);
        let is_plain = is_linear && names.len() == terms.len() && !names.iter().any(has_quaternion);
        let is_free = |name: &str| {
            let mut joints = self.robot.joints.iter();
            joints.any(|joint| joint.name.value == name && joint.follows.is_none() && joint.held.is_none())
        };
        match terms.first() {
            Some((follower, _)) if is_plain && is_free(follower) => {
                self.couple(&terms, at(0), element.span())
            }
            first => {
                let owner = first.map_or(format!("<{}>", element.tag()), |(joint, _)| format!("`{joint}`"));
                self.notes.remark(notes::EQUALITY, element.span(), owner);
            }
        }
    }

    /// The joints in the length of an equality, with their factors; `None` if the length is not a sum of
    /// joint positions.
    fn length(
        &mut self,
        element: Element<'a>,
        number: char,
        factor: f64,
        sums: &Sums,
    ) -> Option<Vec<(String, f64)>> {
        let key = format!("{}{number}", element.tag());
        if element.tag() == "joint" {
            return self.joint_of(element, &key).map(|joint| vec![(joint, factor)]);
        }
        let sum = element.attribute(&key).and_then(|given| sums.get(given.text));
        let Some(sum) = sum.filter(|sum| !sum.is_empty()) else {
            self.opened(element);
            return None;
        };
        let term = |term: &FollowsDescription| {
            Some((term.joint.value.clone(), factor * term.ratio.value.as_number()?))
        };
        sum.iter().map(term).collect()
    }

    /// Adds the coupling `Σ factor (position − reference) = constant`, solved for the first joint.
    fn couple(&mut self, terms: &[(String, f64)], constant: f64, span: Span) {
        let Some(((follower, factor), others)) = terms.split_first() else { return };
        let reference = |name: &String| self.joints.get(name).map_or(0.0, |joint| joint.reference);
        let ratios = others.iter().map(|(joint, other)| (joint, -other / factor));
        let shift: f64 = ratios.clone().map(|(joint, ratio)| ratio * reference(joint)).sum();
        let offset = reference(follower) + constant / factor - shift;
        let follows = ratios.map(|(joint, ratio)| FollowsDescription {
            joint: At::new(joint.clone(), span),
            ratio: At::new(Formula::Number(ratio), span),
        });
        let follows: Vec<FollowsDescription> = follows.collect();
        let mut joints = self.robot.joints.iter_mut();
        let Some(joint) = joints.find(|joint| joint.name.value == *follower) else { return };
        if follows.is_empty() {
            joint.held = Some(offset);
        } else {
            joint.follows = Some(At::new(follows, span));
            joint.offset = (offset != 0.0).then(|| At::new(offset, span));
        }
    }

    /// The coefficients a₀, a₁, … of an equality of joints. Without coefficients, joint1 equals joint2.
    fn numbers_of(&mut self, placed: &Placed<'a>) -> Vec<f64> {
        let own = placed.element.attribute("polycoef");
        let given = own.or_else(|| self.classes.attribute(placed.class, "equality", "polycoef"));
        let numbers = given.and_then(|given| self.numbers(given, "polycoef"));
        numbers.map_or(vec![0.0, 1.0], |numbers| numbers.value)
    }

    /// Name of the joint that an attribute names. If the joint does not exist, an error is reported and the
    /// result is `None`.
    pub(super) fn joint_of(&mut self, element: Element<'a>, key: &str) -> Option<String> {
        let Some(given) = element.attribute(key) else {
            let message = format!("<{}> has no `{key}`", element.tag());
            self.report.error(element.span(), "missing-attribute", message);
            return None;
        };
        if self.joints.contains_key(given.text) {
            return Some(given.text.to_owned());
        }
        self.report.error(given.span, "unknown-joint", format!("unknown joint `{}`", given.text));
        if let Some(help) = nearest(given.text, self.joints.keys().map(String::as_str)) {
            self.report.help(help);
        }
        None
    }
}
