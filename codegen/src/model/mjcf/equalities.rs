//! Equalities of joints as couplings.

use super::super::Pose;
use super::super::description::FollowsDescription;
use super::files::Element;
use super::schema::Place;
use super::{Placed, Reader, Remark};
use crate::diagnostic::{At, nearest};
use gelenk_formula::Formula;

impl<'a> Reader<'_, 'a> {
    pub(super) fn equalities(&mut self, section: Element<'a>) {
        for element in self.known_children(Place::Equalities, section) {
            let class = self.class(element, "class", 0);
            let placed = Placed { element, pose: Pose::identity(), class };
            let active = element.attribute("active");
            let active = active.or_else(|| self.classes.attribute(class, "equality", "active"));
            if active.is_some_and(|given| given.text == "false") || self.options.ignore_mimic {
                self.notes.skip(format!("<{}>", element.tag()), element.span());
                continue;
            }
            match element.tag() {
                "joint" => self.equality(&placed),
                tag => {
                    let name =
                        element.node.attribute("name").map_or(format!("<{tag}>"), |name| format!("`{name}`"));
                    self.notes.remark(Remark::Loop, element.span(), name);
                }
            }
        }
    }

    /// `joint1 − ref1 = a₀ + a₁ (joint2 − ref2)`
    fn equality(&mut self, placed: &Placed<'a>) {
        let element = placed.element;
        let Some(follower) = self.joint_of(element, "joint1") else { return };
        let polynomial = self.numbers_of(placed);
        let owner = format!("`{follower}`");
        let is_linear = polynomial.iter().skip(2).all(|factor| *factor == 0.0);
        let at = |index: usize| polynomial.get(index).copied().unwrap_or(0.0);
        let leader = match element.attribute("joint2") {
            Some(_) => match self.joint_of(element, "joint2") {
                Some(leader) => Some(leader),
                None => return,
            },
            None => None,
        };
        let has_quaternion = |name: &String| self.joints.get(name).is_some_and(|joint| joint.has_quaternion);
        let reference = |name: &String| self.joints.get(name).map_or(0.0, |joint| joint.reference);
        let is_coupled =
            self.robot.joints.iter().any(|joint| {
                joint.name.value == follower && (joint.follows.is_some() || joint.held.is_some())
            });
        let quaternion = has_quaternion(&follower) || leader.as_ref().is_some_and(has_quaternion);
        if !is_linear || quaternion || is_coupled {
            return self.notes.remark(Remark::Equality, element.span(), owner);
        }
        let span = element.span();
        let leader = leader.filter(|_| at(1) != 0.0);
        let offset =
            reference(&follower) + at(0) - leader.as_ref().map_or(0.0, |leader| at(1) * reference(leader));
        let Some(joint) = self.robot.joints.iter_mut().find(|joint| joint.name.value == follower) else {
            return;
        };
        match leader {
            None => joint.held = Some(offset),
            Some(leader) => {
                let ratio = At::new(Formula::Number(at(1)), span);
                let follows = FollowsDescription { joint: At::new(leader, span), ratio };
                joint.follows = Some(At::new(vec![follows], span));
                joint.offset = (offset != 0.0).then(|| At::new(offset, span));
            }
        }
    }

    /// The coefficients; joint1 is joint2 without them.
    fn numbers_of(&mut self, placed: &Placed<'a>) -> Vec<f64> {
        let own = placed.element.attribute("polycoef");
        let given = own.or_else(|| self.classes.attribute(placed.class, "equality", "polycoef"));
        let numbers = given.and_then(|given| self.numbers(given, "polycoef"));
        numbers.map_or(vec![0.0, 1.0], |numbers| numbers.value)
    }

    /// The joint that an attribute names; complains where there is none.
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
