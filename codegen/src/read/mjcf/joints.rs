//! Reading of MJCF joints. Several joints in one body become a chain.

use super::place::by_axis;
use super::{KnownJoint, Placed, Reader, notes, or};
use crate::description::{FrictionDescription, JointDescription, LimitsDescription, Name};
use crate::diagnostic::At;
use crate::model::pose::rotate_numbers;
use crate::model::{FrictionTerm, JointKind, Pose, QuaternionKind};
use crate::read::composite::{self, Composite, Place};
use crate::read::toml::forces::warn_of_negative_stiffness;
use gelenk_formula::{Formula, TermOf};

/// The two links that a joint connects.
struct Between {
    parent: Name,
    child: Name,
    /// Pose of the moved body in the parent's frame if the joint is at position 0.
    frame: Pose,
}

impl<'a> Reader<'_, 'a> {
    /// Reads the joints between a body and its parent, starting at the parent.
    pub(super) fn joints(&mut self, body: &Name, parent: Name, pose: Pose, joints: &[&Placed<'a>]) {
        let (mut carrier, mut frame) = (parent, Some(pose));
        for (index, joint) in joints.iter().enumerate() {
            let class = self.class(joint.element, "class", joint.class);
            let joint = Placed { class, ..(*joint).clone() };
            let name = self.joint_name(&joint, body, joints.len() == 1);
            let child = match index + 1 == joints.len() {
                true => body.clone(),
                false => {
                    let wanted = format!("{}_{}", body.value, name.value);
                    let link = At::new(self.link_names.take(&wanted), name.span);
                    self.robot.links.push(link.clone());
                    link
                }
            };
            let frame = frame.take().unwrap_or_else(Pose::identity);
            let between = Between { parent: carrier, child: child.clone(), frame };
            carrier = child;
            match self.kind(&joint) {
                Some("free") => self.free(&joint, name, between, joints.len() == 1),
                Some("ball") => self.ball(&joint, name, between),
                // An unknown type was reported. It counts as a hinge, so that it causes no further error.
                kind => self.single(&joint, name, between, kind == Some("slide")),
            }
        }
    }

    fn kind(&mut self, joint: &Placed<'a>) -> Option<&'static str> {
        if joint.element.tag() == "freejoint" {
            return Some("free");
        }
        match self.find(joint, "type") {
            Some(given) => self.one_of(given, "type", &["hinge", "slide", "ball", "free"]),
            None => Some("hinge"),
        }
    }

    fn joint_name(&mut self, joint: &Placed<'a>, body: &Name, is_only: bool) -> Name {
        let named = self.placed_name(joint);
        let wanted = match &named {
            Some(name) => name.value.clone(),
            None if is_only => format!("{}_joint", body.value),
            None => format!("{}_joint_1", body.value),
        };
        let name = self.joint_names.take(&wanted);
        let span = named.as_ref().map_or(joint.element.span(), |name| name.span);
        if named.is_some() && name != wanted {
            self.report.error(span, "duplicate-name", format!("two joints have the name `{wanted}`"));
        }
        At::new(name, span)
    }

    /// Position of a joint in its body's frame.
    fn anchor(&mut self, joint: &Placed<'a>) -> Pose {
        let position =
            self.vector(self.find(joint, "pos"), "pos").map_or([0.0; 3], |position| position.value);
        let translation = joint.pose.point(&position.map(Formula::Number));
        Pose { translation, ..Pose::identity() }
    }

    /// Adds a hinge or a slide, which has one position.
    fn single(&mut self, joint: &Placed<'a>, name: Name, between: Between, slides: bool) {
        let axis = self.find(joint, "axis");
        let axis = self.direction(axis, "axis").unwrap_or([0.0, 0.0, 1.0]);
        let axis = rotate_numbers(&joint.pose.rotation, &axis);
        let unit = if slides { 1.0 } else { self.compiler.angle };
        let reference = unit * or(self.number(self.find(joint, "ref"), "ref"), 0.0);
        let anchor = self.anchor(joint);
        let back = anchor.translation.clone().map(Formula::negation);
        // The frames in the file are at the joint's reference; gelenk's frames are at position 0.
        let displacement = match slides {
            true => Pose { translation: axis.map(|x| Formula::Number(-reference * x)), ..Pose::identity() },
            false => Pose { rotation: by_axis(axis, -reference), ..Pose::identity() },
        };
        let armature = or(self.number(self.find(joint, "armature"), "armature"), 0.0);
        let known =
            KnownJoint { name: name.clone(), reference, has_quaternion: false, is_free: false, armature };
        self.joints.insert(name.value.clone(), known);
        let description = JointDescription {
            kind: Some(if slides { JointKind::Prismatic } else { JointKind::Revolute }),
            parent: Some(between.parent),
            child: Some(between.child),
            origin: Some(between.frame.then(&anchor).then(&displacement)),
            link_frame: Some(Pose { translation: back, ..Pose::identity() }),
            axis: Some(axis),
            limits: self.limits(joint, &name, unit),
            springs: self.spring(joint, unit),
            friction: self.friction(joint, &name, true),
            ..JointDescription::named(name)
        };
        self.robot.joints.push(description);
    }

    /// Adds a free joint. The file may show its body at any pose in the world.
    fn free(&mut self, joint: &Placed<'a>, name: Name, between: Between, is_only: bool) {
        self.require_world(&name, &between.parent, &between.frame, is_only);
        let place = Place {
            parent: Some(between.parent),
            child: Some(between.child),
            origin: None,
            axis: [0.0, 0.0, 1.0],
        };
        self.quaternion(joint, name, QuaternionKind::Floating, place, Pose::identity());
    }

    /// Reports an error if a free joint is not in the world. Adds a note if its initial pose is ignored.
    pub(super) fn require_world(&mut self, name: &Name, parent: &Name, frame: &Pose, is_only: bool) {
        if parent.value != super::WORLD || !is_only {
            let message =
                format!("free joint `{}` must be the only joint of a body in <worldbody>", name.value);
            self.report.error(name.span, "free-joint", message);
            self.report.help(
                "use slide joints and a ball joint, or move the body to <worldbody>, as MuJoCo requires",
            );
        }
        if !frame.is_identity() {
            self.notes.remark(notes::START_POSE, name.span, name.quoted());
        }
    }

    fn ball(&mut self, joint: &Placed<'a>, name: Name, between: Between) {
        let anchor = self.anchor(joint);
        let back =
            Pose { translation: anchor.translation.clone().map(Formula::negation), ..Pose::identity() };
        let place = Place {
            parent: Some(between.parent),
            child: Some(between.child),
            origin: Some(between.frame.then(&anchor)),
            axis: [0.0, 0.0, 1.0],
        };
        self.quaternion(joint, name, QuaternionKind::Spherical, place, back);
    }

    fn quaternion(&mut self, joint: &Placed<'a>, name: Name, kind: QuaternionKind, place: Place, back: Pose) {
        let is_plain = joint.element.tag() == "freejoint";
        let keys = ["armature", "stiffness", "frictionloss", "range"];
        let given = keys
            .iter()
            .filter_map(|key| self.find(joint, key))
            .find(|given| given.text.split_whitespace().any(|word| word.parse() != Ok(0.0)));
        if let Some(given) = given.filter(|_| !is_plain) {
            self.notes.remark(notes::QUATERNION_FORCE, given.span, name.quoted());
        }
        let friction = if is_plain { None } else { self.friction(joint, &name, false) };
        let is_free = kind == QuaternionKind::Floating;
        let known =
            KnownJoint { name: name.clone(), reference: 0.0, has_quaternion: true, is_free, armature: 0.0 };
        self.joints.insert(name.value.clone(), known);
        let values = |_: &'static composite::Part, name: Name| JointDescription {
            friction: friction.clone(),
            ..JointDescription::named(name)
        };
        let mut parts = composite::expand(Composite::Quaternion(kind), &name, place, values);
        if let Some(last) = parts.last_mut() {
            last.link_frame = Some(back);
        }
        let between = parts.iter().rev().skip(1).filter_map(|part| part.child.clone());
        self.robot.links.extend(between);
        self.robot.joints.extend(parts);
    }

    fn limits(&mut self, joint: &Placed<'a>, name: &Name, unit: f64) -> LimitsDescription {
        let range = self.range(joint, "range", "limited");
        let position = range.map(|range| At::new(range.value.map(|x| unit * x), range.span));
        let is_usable = |range: &At<[f64; 2]>| range.value[0] < range.value[1];
        if let Some(range) = position.as_ref().filter(|range| !is_usable(range)) {
            self.notes.remark(notes::RANGE, range.span, name.quoted());
        }
        let force = self.range(joint, "actuatorfrcrange", "actuatorfrclimited");
        if let Some(range) = force.as_ref().filter(|range| range.value[0] != -range.value[1]) {
            self.notes.remark(notes::EFFORT_RANGE, range.span, name.quoted());
        }
        let effort = force.map(|range| At::new(range.value[1].min(-range.value[0]), range.span));
        LimitsDescription {
            position: position.filter(is_usable),
            effort: effort.filter(|effort| effort.value > 0.0),
            ..LimitsDescription::default()
        }
    }

    /// Reads a range as a limit; `None` unless the attribute `switch` or the default makes the range a limit.
    pub(super) fn range(&mut self, placed: &Placed<'a>, key: &str, switch: &str) -> Option<At<[f64; 2]>> {
        let given = self.find(placed, key)?;
        let switch_word = match self.find(placed, switch) {
            Some(word) => self.one_of(word, switch, &["false", "true", "auto"]),
            None => None,
        };
        let is_on = match switch_word {
            Some("true") => true,
            Some("false") => false,
            _ => self.compiler.autolimits,
        };
        self.vector(Some(given), key).filter(|_| is_on)
    }

    /// The force of a joint's spring, `−stiffness (y − springref)` with the position y.
    fn spring(&mut self, joint: &Placed<'a>, unit: f64) -> Option<At<Vec<Formula>>> {
        if let Some(given) = self.find(joint, "springdamper").filter(|given| !is_zero(given.text)) {
            let body = joint.element.node.attribute("name").unwrap_or("a joint");
            self.notes.remark(notes::SPRING_DAMPER, given.span, format!("`{body}`"));
        }
        let stiffness = self.linear(joint, "stiffness")?;
        if stiffness.value < 0.0 {
            let name = joint.element.node.attribute("name").unwrap_or("a joint");
            let stiffness = At::new(stiffness.value, stiffness.span);
            warn_of_negative_stiffness(name, stiffness, self.report);
        }
        let rest = unit * or(self.number(self.find(joint, "springref"), "springref"), 0.0);
        let reach = Formula::difference(Formula::Position, Formula::Number(rest));
        let law = Formula::product(Formula::Number(-stiffness.value), reach);
        Some(At::new(vec![law], stiffness.span))
    }

    /// The linear coefficient of a force law: the first number of the attribute. Other numbers are
    /// coefficients of higher powers and give a remark if they are not 0.
    fn linear(&mut self, joint: &Placed<'a>, key: &str) -> Option<At<f64>> {
        let numbers = self.numbers(self.find(joint, key)?, key)?;
        if numbers.value.iter().skip(1).any(|number| *number != 0.0) {
            let name = joint.element.node.attribute("name").unwrap_or("a joint");
            self.notes.remark(notes::SPRING_DAMPER, numbers.span, format!("`{name}`"));
        }
        let first = *numbers.value.first()?;
        (first != 0.0).then(|| At::new(first, numbers.span))
    }

    fn friction(&mut self, joint: &Placed<'a>, name: &Name, dry: bool) -> Option<At<FrictionDescription>> {
        if self.options.no_friction {
            return None;
        }
        let viscous = self.linear(joint, "damping");
        let loss = self.number(self.find(joint, "frictionloss"), "frictionloss").filter(|_| dry);
        let laws: [(_, TermOf); 2] = [(&viscous, FrictionTerm::viscous), (&loss, FrictionTerm::coulomb)];
        let mut terms = Vec::new();
        for (number, law) in laws {
            let Some(number) = number.as_ref().filter(|number| number.value != 0.0) else { continue };
            if number.value < 0.0 {
                let message = format!("joint `{}` has negative friction {}", name.value, number.value);
                self.report.error(number.span, "negative-friction", message);
            }
            terms.push(law(Formula::Number(number.value)));
        }
        let span = super::span_of(viscous.as_ref().or(loss.as_ref()), name.span);
        (!terms.is_empty()).then(|| At::new(FrictionDescription { terms, load: None }, span))
    }
}

fn is_zero(text: &str) -> bool {
    text.split_whitespace().all(|word| word.parse() == Ok(0.0))
}
