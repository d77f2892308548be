//! Reading of actuators, tendons and armatures. Actuators become drives, fixed tendons become drives on
//! several joints, and armatures become rotors.

use std::collections::BTreeMap;

use super::files::{Element, Given};
use super::schema::Place;
use super::{Placed, Reader, notes, or};
use crate::description::{
    DriveChoice, DriveDescription, FollowsDescription, JointDescription, Name, SharedDriveDescription,
    WrenchInputDescription,
};
use crate::diagnostic::{At, Span, nearest};
use crate::model::{FrictionTerm, Input, MotorTorque};
use gelenk_formula::Formula;

/// The length of a fixed tendon: a weighted sum of joint positions.
type Sum = Vec<FollowsDescription>;

/// Weighted sums of joint positions for all fixed tendons, by the tendons' names.
pub(super) type Sums = BTreeMap<String, Sum>;

/// Attributes of a general actuator, with the values for which its force is proportional to its input.
const SERVO: [(&str, &[&str]); 3] =
    [("gaintype", &["fixed"]), ("biastype", &["none"]), ("dyntype", &["none"])];

/// Motor of an actuator, without its transmission.
struct Motor {
    gear: f64,
    rotor_inertia: f64,
    friction: Vec<FrictionTerm>,
    input: Input,
    torque: MotorTorque,
    span: Span,
}

impl Motor {
    fn description(self, name: Option<Name>) -> DriveDescription {
        let friction = (!self.friction.is_empty()).then(|| At::new(self.friction, self.span));
        DriveDescription {
            name,
            gear_ratio: At::new(Formula::Number(self.gear), self.span),
            input: self.input,
            torque: self.torque,
            friction,
            ..DriveDescription::at_joint(At::new(Formula::Number(self.rotor_inertia), self.span))
        }
    }
}

impl<'a> Reader<'_, 'a> {
    pub(super) fn tendons(&mut self, section: Element<'a>, sums: &mut Sums) {
        for element in self.known_children(Place::Tendons, section) {
            self.tendon(element, sums);
        }
    }

    pub(super) fn actuators(&mut self, section: Element<'a>, sums: &Sums) {
        for element in self.known_children(Place::Actuators, section) {
            let class = self.class(element, "class", 0);
            self.actuator(&Placed::outside(element, class), sums);
        }
    }

    fn tendon(&mut self, element: Element<'a>, sums: &mut Sums) {
        let name = self.name(element, "name");
        let owner = name.as_ref().map_or("a tendon".to_owned(), Name::quoted);
        let class = self.class(element, "class", 0);
        let find = |reader: &Self, key: &str| -> Option<Given<'a>> {
            element.attribute(key).or_else(|| reader.classes.attribute(class, "tendon", key))
        };
        let is_zero = |given: &Given<'a>| given.text.split_whitespace().all(|word| word.parse() == Ok(0.0));
        let lost =
            ["stiffness", "range"].iter().filter_map(|key| find(self, key)).find(|given| !is_zero(given));
        if let Some(given) = lost {
            self.notes.remark(notes::TENDON_FORCE, given.span, owner.clone());
        }
        if element.tag() != "fixed" {
            return self.notes.remark(notes::TENDON_FORCE, element.span(), owner);
        }
        let mut sum = Sum::new();
        for part in self.known_children(Place::Tendon, element) {
            let Some(joint) = self.joint_of(part, "joint") else { continue };
            let factor = or(self.number(part.attribute("coef"), "coef"), 0.0);
            if self.joints.get(&joint).is_some_and(|joint| joint.has_quaternion) {
                return self.notes.remark(notes::TENDON_FORCE, part.span(), owner);
            }
            if factor != 0.0 {
                let ratio = At::new(Formula::Number(factor), part.span());
                sum.push(FollowsDescription { joint: At::new(joint, part.span()), ratio });
            }
        }
        let [armature, viscous, dry] = ["armature", "damping", "frictionloss"].map(|key| {
            let given = find(self, key);
            let numbers = given.and_then(|given| self.numbers(given, key));
            numbers.and_then(|numbers| numbers.value.first().copied()).unwrap_or(0.0)
        });
        if armature != 0.0 && self.is_branched(&sum) {
            self.notes.remark(notes::TENDON_BRANCHES, element.span(), owner);
        }
        let friction = if self.options.no_friction { Vec::new() } else { friction(viscous, dry) };
        let is_plain = armature == 0.0 && friction.is_empty();
        if !is_plain && !sum.is_empty() {
            let span = element.span();
            let motor = Motor { rotor_inertia: armature, friction, ..Motor::passive(span) };
            let wanted = name.as_ref().map_or("tendon".to_owned(), |name| name.value.clone());
            self.shared(wanted, sum.clone(), motor);
        }
        if let Some(name) = name {
            sums.insert(name.value, sum);
        }
    }

    /// Whether two joints of a weighted sum are on different branches of the tree.
    fn is_branched(&self, sum: &Sum) -> bool {
        let joints = || sum.iter().map(|part| part.joint.value.as_str());
        joints().any(|a| joints().any(|b| !self.carries(a, b) && !self.carries(b, a)))
    }

    /// Whether a joint carries the link of another joint, directly or through other links, or is the same
    /// joint.
    fn carries(&self, joint: &str, other: &str) -> bool {
        let joints = &self.robot.joints;
        let parent = |at: &&JointDescription| {
            let link = at.parent.as_ref()?;
            joints.iter().find(|joint| joint.child.as_ref().is_some_and(|child| child.value == link.value))
        };
        let last = joints.iter().find(|joint| joint.name.value == other);
        std::iter::successors(last, parent).any(|at| at.name.value == joint)
    }

    fn actuator(&mut self, placed: &Placed<'a>, sums: &Sums) {
        let element = placed.element;
        let name = self.name(element, "name");
        let owner = name.as_ref().map_or_else(|| format!("<{}>", element.tag()), Name::quoted);
        let gear = self.find(placed, "gear").and_then(|given| self.numbers(given, "gear"));
        let gear = gear.map_or(vec![1.0], |gear| gear.value);
        let first = gear.first().copied().unwrap_or(1.0);
        if let Some(site) = element.attribute("site") {
            return self.wrench(placed, site, name, &gear);
        }
        let joint = ["joint", "jointinparent"].into_iter().find(|key| element.attribute(key).is_some());
        let target = match (joint, element.attribute("tendon")) {
            (Some(key), _) => match self.joint_of(element, key) {
                Some(joint) if !self.joints.get(&joint).is_some_and(|joint| joint.has_quaternion) => {
                    Ok(joint)
                }
                Some(_) => return self.notes.remark(notes::ACTUATOR, element.span(), owner),
                None => return,
            },
            (None, Some(tendon)) => match sums.get(tendon.text) {
                Some(sum) if !sum.is_empty() => Err(sum.clone()),
                _ => return self.notes.remark(notes::ACTUATOR, tendon.span, owner),
            },
            (None, None) => return self.notes.remark(notes::ACTUATOR, element.span(), owner),
        };
        if first == 0.0 {
            return self.notes.remark(notes::ACTUATOR, element.span(), owner);
        }
        let motor = self.motor(placed, first, &owner);
        match target {
            Ok(joint) => self.on_joint(name, joint, motor),
            Err(sum) => {
                let wanted = name.map_or_else(|| "tendon".to_owned(), |name| name.value);
                self.shared(wanted, sum, motor);
            }
        }
    }

    fn motor(&mut self, placed: &Placed<'a>, gear: f64, owner: &str) -> Motor {
        let element = placed.element;
        let is_servo = match element.tag() {
            "motor" => false,
            "general" => SERVO
                .iter()
                .any(|(key, plain)| self.find(placed, key).is_some_and(|given| !plain.contains(&given.text))),
            _ => true,
        };
        if is_servo {
            self.notes.remark(notes::SERVO, element.span(), owner.to_owned());
        }
        let gain = match element.tag() {
            "general" => self.find(placed, "gainprm").and_then(|given| self.numbers(given, "gainprm")),
            _ => None,
        };
        let gain = gain.and_then(|gain| gain.value.first().copied()).unwrap_or(1.0);
        let force = self.range(placed, "forcerange", "forcelimited").map(|range| (range, 1.0));
        let mut control = || self.range(placed, "ctrlrange", "ctrllimited").map(|range| (range, gain));
        let range = match force {
            None if !is_servo => control(),
            force => force,
        };
        let mut torque = MotorTorque::default();
        if let Some((range, gain)) = range {
            let [low, high] = range.value;
            match low == -high && high * gain.abs() > 0.0 {
                true => torque.nominal = Some(high * gain.abs()),
                false => self.notes.remark(notes::ACTUATOR_RANGE, range.span, owner.to_owned()),
            }
        }
        let [rotor_inertia, damping] =
            ["armature", "damping"].map(|key| or(self.number(self.find(placed, key), key), 0.0));
        let damping = if self.options.no_friction { 0.0 } else { damping };
        let friction = friction(damping, 0.0);
        Motor { gear, rotor_inertia, friction, input: Input::Torque, torque, span: element.span() }
    }

    /// Adds a motor. The first motor on a joint becomes the `drive` of the joint and gets the joint's armature, so
    /// that an extending description can replace it.
    fn on_joint(&mut self, name: Option<Name>, joint: String, mut motor: Motor) {
        let wanted = name.as_ref().map_or_else(|| joint.clone(), |name| name.value.clone());
        let described = self.robot.joints.iter().position(|other| other.name.value == joint);
        let free = described.filter(|&index| {
            let joint = &self.robot.joints[index];
            joint.drive.is_none() && joint.follows.is_none()
        });
        let Some(index) = free else {
            let span = motor.span;
            let on = FollowsDescription { joint: At::new(joint, span), ratio: At::new(Formula::ONE, span) };
            return self.shared(wanted, vec![on], motor);
        };
        if let Some(known) = self.joints.get_mut(&joint) {
            motor.rotor_inertia += std::mem::take(&mut known.armature) / (motor.gear * motor.gear);
        }
        let span = name.as_ref().map_or(motor.span, |name| name.span);
        let name = At::new(self.drive_names.take(&wanted), span);
        let drive = DriveChoice::Motor(Box::new(motor.description(Some(name))));
        self.robot.joints[index].drive = Some(At::new(drive, span));
    }

    fn shared(&mut self, wanted: String, on: Sum, motor: Motor) {
        let name = At::new(self.drive_names.take(&wanted), motor.span);
        let motor = motor.description(None);
        self.robot.drives.push(SharedDriveDescription { name, on, motor });
    }

    /// Adds the armatures of joints without an actuator as rotors.
    pub(super) fn armatures(&mut self) {
        let open = std::mem::take(&mut self.joints);
        for (joint, known) in open.into_iter().filter(|(_, known)| known.armature != 0.0) {
            let span = known.name.span;
            let on = FollowsDescription {
                joint: At::new(joint.clone(), span),
                ratio: At::new(Formula::ONE, span),
            };
            let motor = Motor { rotor_inertia: known.armature, ..Motor::passive(span) };
            self.shared(joint, vec![on], motor);
        }
    }

    /// Adds an actuator on a site. Its gear is a force and a moment in the site's frame.
    fn wrench(&mut self, placed: &Placed<'a>, site: Given<'a>, name: Option<Name>, gear: &[f64]) {
        let element = placed.element;
        let owner = name.as_ref().map_or_else(|| format!("<{}>", element.tag()), Name::quoted);
        if !self.sites.contains(site.text) {
            self.report.error(site.span, "unknown-frame", format!("unknown site `{}`", site.text));
            match self.sites.is_empty() {
                true => self.report.help("no body has a named site: add a site with this name"),
                false => self
                    .report
                    .help(nearest(site.text, self.sites.iter().map(String::as_str)).unwrap_or_default()),
            }
            return;
        }
        let mut wrench = [0.0; 6];
        wrench.iter_mut().zip(gear).for_each(|(entry, gear)| *entry = *gear);
        if element.attribute("refsite").is_some() || wrench == [0.0; 6] {
            return self.notes.remark(notes::ACTUATOR, element.span(), owner);
        }
        let range = self.range(placed, "ctrlrange", "ctrllimited");
        let limits = range.filter(|range| range.value[0] <= 0.0 && range.value[1] >= 0.0);
        let wanted = name.map_or_else(|| site.text.to_owned(), |name| name.value);
        self.robot.wrench_inputs.push(WrenchInputDescription {
            name: At::new(self.drive_names.take(&wanted), element.span()),
            frame: At::new(site.text.to_owned(), site.span),
            wrench: At::new(wrench.map(Formula::Number), element.span()),
            limits,
        });
    }
}

impl Motor {
    /// A motor without input, for the rotor inertia and friction of a joint or a tendon.
    fn passive(span: Span) -> Self {
        let torque = MotorTorque::default();
        Self { gear: 1.0, rotor_inertia: 0.0, friction: Vec::new(), input: Input::None, torque, span }
    }
}

/// Friction terms of the law `viscous · v + dry · sign(v)`.
fn friction(viscous: f64, dry: f64) -> Vec<FrictionTerm> {
    let [viscous, dry] = [viscous, dry].map(|value| Some(Formula::Number(value)).filter(|_| value != 0.0));
    viscous.map(FrictionTerm::viscous).into_iter().chain(dry.map(FrictionTerm::coulomb)).collect()
}
