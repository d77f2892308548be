//! Writes a model as a URDF.
//!
//! A frame becomes a massless link on a fixed joint, as in ROS. A helical joint becomes a prismatic joint
//! that mimics a revolute joint.

use super::format::Format;
use super::losses::{LINE, Losses};
use super::names::{distinct, slide_name};
use super::numbers::{Placed, Values};
use super::xml::{Attributes, Xml, numbers};
use crate::model::{Frame, Joint, JointKind, Limits, Model, Motion, MovingJoint, QuaternionKind};

/// Number that readers of URDFs treat as no limit. ROS requires limits of effort and velocity, and 0 would
/// forbid all motion.
const UNLIMITED: f64 = 1e31;
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

const ROTOR: &str =
    "has no rotors and gears. M lacks the rotor inertia, and inputs act at the joints instead of the drives";
const IDEAL: &str = "cannot mark a joint without a drive. Most readers assume a drive at";
const OTHER_FRICTION: &str =
    "has only viscous and dry friction. Other laws (Stribeck, tanh, position) are omitted at";
const SPHERICAL: &str =
    "has the type `spherical` only as an extension. urdfdom and Pinocchio reject the whole file because of";
const SEVERAL: &str =
    "supports only joints that follow one joint. These joints follow several and move freely in the file";

struct Writer<'m> {
    model: &'m Model,
    values: Values,
    xml: Xml,
    losses: Losses,
    /// Names of all links in the URDF.
    links: Vec<String>,
}

pub(super) fn export(model: &Model, source: &str) -> (String, Losses) {
    let links = model.links.iter().map(|link| link.name.clone()).collect();
    let losses = Losses::new(Format::Urdf);
    let mut writer = Writer { model, values: Values::of(model), xml: Xml::new(source), losses, links };
    writer.xml.open("robot", vec![("name", model.name.clone())]);
    for link in 0..model.links.len() {
        writer.link(link);
    }
    let moving = model.moving_joints();
    for link in 0..model.links.len() {
        writer.joint(link, &moving);
    }
    for frame in &model.frames {
        writer.frame(frame);
    }
    writer.lost();
    (writer.xml.finish(), writer.losses)
}

impl Writer<'_> {
    fn link(&mut self, index: usize) {
        let link = &self.model.links[index];
        if self.is_within_chain(&link.name) {
            return;
        }
        let name = vec![("name", link.name.clone())];
        if link.bodies.is_empty() {
            return self.xml.element("link", name);
        }
        let lump = self.values.lump(self.model, index);
        let keys = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
        let inertia = keys.iter().zip(lump.inertia).map(|(&key, entry)| (key, numbers(&[entry])));
        self.xml.open("link", name);
        self.xml.open("inertial", vec![]);
        self.xml.element("origin", vec![("xyz", numbers(&lump.center)), ("rpy", numbers(&[0.0; 3]))]);
        self.xml.element("mass", vec![("value", numbers(&[lump.mass]))]);
        self.xml.element("inertia", inertia.collect());
        self.xml.close();
        self.xml.close();
    }

    /// Whether a link is an inner link between the velocities of a joint with a quaternion.
    fn is_within_chain(&self, name: &str) -> bool {
        self.model.quaternion_joints.iter().any(|joint| {
            let inner = joint.first..joint.coordinates().end - 1;
            inner
                .into_iter()
                .any(|coordinate| self.model.links[self.model.coordinates[coordinate]].name == name)
        })
    }

    fn joint(&mut self, link: usize, moving: &[MovingJoint<'_>]) {
        let model = self.model;
        let Some(joint) = &model.links[link].joint else { return };
        let chain = match joint.motion {
            Motion::Coordinate(coordinate) => model.quaternion_joint_of(coordinate),
            _ => None,
        };
        if let Some(chain) = chain {
            if model.coordinates[chain.first] == link {
                let child = model.coordinates[chain.coordinates().end - 1];
                if chain.kind == QuaternionKind::Spherical {
                    self.losses.refused(SPHERICAL, &chain.name);
                }
                self.open(&chain.name, chain.kind.name(), &self.values.resting(joint), [joint.parent, child]);
                self.xml.close();
            }
            self.quaternion_losses(joint);
            return;
        }
        let follows = match joint.motion {
            Motion::Coordinate(index) | Motion::Follower(index) => moving.get(index),
            Motion::Fixed | Motion::Held(_) => None,
        };
        match (joint.kind, follows) {
            (_, None) => {
                self.open(&joint.name, "fixed", &self.values.resting(joint), [joint.parent, link]);
                self.xml.close();
            }
            (JointKind::Helical { pitch }, Some(follows)) => self.screw(joint, pitch, link, follows),
            (_, Some(follows)) => {
                self.open(&joint.name, kind(joint), &self.values.resting(joint), [joint.parent, link]);
                self.moving(joint, follows);
            }
        }
    }

    /// Writes a helical joint as a prismatic joint that mimics the revolute joint after it.
    fn screw(&mut self, joint: &Joint, pitch: f64, link: usize, follows: &MovingJoint<'_>) {
        let name = slide_name(self.model, &joint.name);
        self.xml.element("link", vec![("name", name.clone())]);
        let parent = self.model.links[joint.parent].name.clone();
        self.open_named(&name, "prismatic", &self.values.resting(joint), [&parent, &name]);
        self.xml.element("axis", vec![("xyz", numbers(&joint.axis))]);
        self.limit(&Limits::default(), UNLIMITED, Some([-UNLIMITED, UNLIMITED]));
        self.xml.element("mimic", vec![("joint", joint.name.clone()), ("multiplier", numbers(&[pitch]))]);
        self.xml.close();
        let child = self.model.links[link].name.clone();
        self.open_named(&joint.name, kind(joint), &Placed::IDENTITY, [&name, &child]);
        self.moving(joint, follows);
    }

    fn open(&mut self, name: &str, kind: &str, placed: &Placed, [parent, child]: [usize; 2]) {
        let [parent, child] = [parent, child].map(|link| self.model.links[link].name.clone());
        self.open_named(name, kind, placed, [&parent, &child]);
    }

    fn open_named(&mut self, name: &str, kind: &str, placed: &Placed, [parent, child]: [&str; 2]) {
        self.xml.open("joint", vec![("name", name.to_owned()), ("type", kind.to_owned())]);
        self.xml.element("origin", vec![("xyz", numbers(&placed.origin)), ("rpy", numbers(&placed.rpy()))]);
        self.xml.element("parent", vec![("link", parent.to_owned())]);
        self.xml.element("child", vec![("link", child.to_owned())]);
    }

    /// Writes axis, limits, friction and mimic of a moving joint, and closes its element.
    fn moving(&mut self, joint: &Joint, follows: &MovingJoint<'_>) {
        self.xml.element("axis", vec![("xyz", numbers(&joint.axis))]);
        let range = match joint.kind {
            JointKind::Prismatic => joint.limits.position.or(Some([-UNLIMITED, UNLIMITED])),
            _ => joint.limits.position,
        };
        self.limit(&joint.limits, self.effort(joint), range);
        self.friction(joint);
        if matches!(joint.motion, Motion::Follower(_)) {
            self.mimic(joint, follows);
        }
        self.xml.close();
    }

    /// The smaller value of the joint's effort limit and the largest force of its motor.
    fn effort(&self, joint: &Joint) -> f64 {
        let drives = self.model.drives.iter().filter(
            |drive| matches!(joint.motion, Motion::Coordinate(own) if drive.coordinate() == Some(own)),
        );
        let motors = drives.filter_map(|drive| {
            let torque = drive.torque.peak.or(drive.torque.nominal)?;
            Some(self.values.number(&drive.gear_ratio).abs() * torque)
        });
        let described = joint.limits.peak_effort.or(joint.limits.effort);
        motors.fold(described.unwrap_or(UNLIMITED), f64::min)
    }

    fn limit(&mut self, limits: &Limits, effort: f64, range: Option<[f64; 2]>) {
        let mut attributes = Attributes::new();
        if let Some([low, high]) = range {
            attributes.extend([("lower", numbers(&[low])), ("upper", numbers(&[high]))]);
        }
        attributes.push(("effort", numbers(&[effort])));
        attributes.push(("velocity", numbers(&[limits.velocity.unwrap_or(UNLIMITED)])));
        let further = [("acceleration", limits.acceleration), ("jerk", limits.jerk)];
        attributes.extend(further.into_iter().filter_map(|(key, limit)| Some((key, numbers(&[limit?])))));
        self.xml.element("limit", attributes);
    }

    fn friction(&mut self, joint: &Joint) {
        let friction = self.values.friction(&joint.friction);
        if friction.viscous > 0.0 || friction.dry > 0.0 {
            let attributes =
                vec![("damping", numbers(&[friction.viscous])), ("friction", numbers(&[friction.dry]))];
            self.xml.element("dynamics", attributes);
        }
        let losses = &mut self.losses;
        let limits = &joint.limits;
        for (is_lost, what) in [
            (friction.has_others, OTHER_FRICTION),
            (!joint.load_friction.is_empty(), "has no load-dependent friction. It is omitted at"),
            (!joint.springs.is_empty(), "has no springs. They are omitted at"),
            (
                limits.effort.is_some() && limits.peak_effort.is_some(),
                "has one force limit per joint. Only the peak limit is written at",
            ),
        ] {
            if is_lost {
                losses.add(what, &joint.name);
            }
        }
    }

    fn quaternion_losses(&mut self, part: &Joint) {
        if !part.friction.is_empty() || !part.springs.is_empty() {
            self.losses.add(
                "has no friction or dampers at joints with a quaternion. They are omitted at",
                &part.name,
            );
        }
        if part.limits != Limits::default() {
            self.losses.add("has no limits at joints with a quaternion. They are omitted at", &part.name);
        }
    }

    fn mimic(&mut self, joint: &Joint, moving: &MovingJoint<'_>) {
        let [only] = &moving.follows[..] else {
            return self.losses.of_robot(SEVERAL, &joint.name);
        };
        let leader = self.model.joints().nth(only.coordinate).map_or("", |leader| &leader.name);
        let ratio = self.values.number(&only.ratio);
        let mut attributes = vec![("joint", leader.to_owned()), ("multiplier", numbers(&[ratio]))];
        attributes.push(("offset", numbers(&[moving.offset])));
        self.xml.element("mimic", attributes);
    }

    /// Writes a frame as a link, unless it is equal to a link with the same name.
    fn frame(&mut self, frame: &Frame) {
        let placed = self.values.placed(&frame.pose);
        let carrier = self.model.links[frame.link].name.clone();
        if carrier == frame.name && placed == Placed::IDENTITY {
            return;
        }
        let name = distinct(&frame.name, |name| self.links.iter().any(|link| link == name));
        if name != frame.name {
            self.losses.add(
                "has links instead of frames. A link has the same name, so another name is used for",
                &frame.name,
            );
        }
        self.xml.element("link", vec![("name", name.clone())]);
        let joint = distinct(&format!("{name}_joint"), |joint| {
            self.model.links.iter().any(|link| link.joint.as_ref().is_some_and(|known| known.name == joint))
        });
        self.open_named(&joint, "fixed", &placed, [&carrier, &name]);
        self.xml.close();
        self.links.push(name);
    }

    fn lost(&mut self) {
        let model = self.model;
        let losses = &mut self.losses;
        if self.values.numbers(&model.gravity) != GRAVITY {
            losses.add("has no gravity. Readers assume (0, 0, -9.81) instead of the gravity of", &model.name);
        }
        for parameter in &model.parameters {
            losses.add("has no free parameters. The described values are written for", &parameter.name);
        }
        for drive in &model.drives {
            let has_gear = self.values.number(&drive.gear_ratio) != 1.0;
            if has_gear || self.values.number(&drive.rotor_inertia) != 0.0 {
                losses.of_robot(ROTOR, &drive.name);
            }
            if drive.acts_on.len() > 1 {
                losses.add("has no drives that act on several joints. They are omitted", &drive.name);
            } else if drive.line.is_some() {
                losses.add(LINE, &drive.name);
            }
        }
        for (coordinate, joint) in model.joints().enumerate() {
            let is_driven = model.input_drives().any(|drive| drive.coordinate() == Some(coordinate));
            if !is_driven && model.quaternion_joint_of(coordinate).is_none() {
                losses.add(IDEAL, &joint.name);
            }
        }
        for force in &model.point_forces {
            losses.add("has no forces between frames. They are omitted", &force.name);
        }
        for input in &model.force_inputs {
            losses.add("has no inputs at frames. They are omitted", &input.name);
        }
        for wrench in &model.wrenches {
            losses.add("has no wrenches at frames. They are omitted", &wrench.name);
        }
    }
}

/// Type of a joint in URDF. A revolute joint without limits is continuous.
fn kind(joint: &Joint) -> &'static str {
    match joint.kind {
        JointKind::Prismatic => "prismatic",
        _ if joint.limits.position.is_some() => "revolute",
        _ => "continuous",
    }
}
