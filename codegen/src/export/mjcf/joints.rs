//! Writes the joints of MJCF and the equalities between joints.

use super::writer::{Tendon, Writer};
use crate::export::names::slide_name;
use crate::export::numbers::{Affine, Friction};
use crate::export::xml::{Attributes, numbers};
use crate::model::{FollowedCoordinate, Joint, JointKind, Motion, QuaternionJoint};

/// Text about lost friction laws and springs. MJCF only has linear damping, linear springs, and a bound on dry
/// friction.
const OTHER_FRICTION: &str =
    "has only viscous and dry friction. Other laws (Stribeck, tanh, position) are omitted at";
const OTHER_SPRINGS: &str = "has only linear springs and dampers. Other laws are omitted at";
const LOAD: &str = "has no load-dependent friction. It is omitted at";
pub(super) const SPEED: &str = "has no limits of speed, acceleration or jerk. They are omitted at";
const EFFORT: &str = "has one force limit per joint. Only the peak limit is written at";
const RANGE: &str = "has no range with a single position. It is omitted at";
const QUATERNION_FRICTION: &str = "has one damping value for all velocities of a ball or free joint. Friction that differs \
                                   between the velocities, or is not viscous, is omitted at";

impl Writer<'_> {
    /// Writes the joint that carries a link. Returns whether the joint moves.
    pub(super) fn joint(&mut self, link: usize) -> bool {
        let Some(joint) = &self.model.links[link].joint else { return false };
        let coordinate = match joint.motion {
            Motion::Coordinate(coordinate) => Some(coordinate),
            Motion::Follower(_) => None,
            Motion::Fixed | Motion::Held(_) => return false,
        };
        let axis = numbers(&joint.axis);
        if let JointKind::Helical { pitch } = joint.kind {
            let slide = slide_name(self.model, &joint.name);
            let attributes = vec![("name", slide.clone()), ("type", "slide".into()), ("axis", axis.clone())];
            self.xml.element("joint", attributes);
            self.equal(&slide, vec![(joint.name.clone(), pitch)], 0.0);
        }
        let mut attributes = vec![("name", joint.name.clone())];
        attributes.extend(joint.slides().then(|| ("type", "slide".into())));
        attributes.push(("axis", axis));
        attributes.extend(self.range(joint));
        attributes.extend(self.effort(joint));
        attributes.extend(self.forces(joint));
        let armature = coordinate.map_or(0.0, |coordinate| self.joint_armature(coordinate));
        attributes.extend((armature != 0.0).then(|| ("armature", numbers(&[armature]))));
        self.xml.element("joint", attributes);
        true
    }

    fn range(&mut self, joint: &Joint) -> Option<(&'static str, String)> {
        if joint.limits.velocity.or(joint.limits.acceleration).or(joint.limits.jerk).is_some() {
            self.losses.add(SPEED, &joint.name);
        }
        let [low, high] = joint.limits.position?;
        if low >= high {
            self.losses.add(RANGE, &joint.name);
            return None;
        }
        Some(("range", numbers(&[low, high])))
    }

    fn effort(&mut self, joint: &Joint) -> Option<(&'static str, String)> {
        let limits = &joint.limits;
        if limits.effort.is_some() && limits.peak_effort.is_some() {
            self.losses.add(EFFORT, &joint.name);
        }
        let most = limits.peak_effort.or(limits.effort)?;
        Some(("actuatorfrcrange", numbers(&[-most, most])))
    }

    /// Attributes for friction and springs of a joint.
    fn forces(&mut self, joint: &Joint) -> Attributes {
        let friction = self.values.friction(&joint.friction);
        if friction.has_others {
            self.losses.add(OTHER_FRICTION, &joint.name);
        }
        if !joint.load_friction.is_empty() {
            self.losses.add(LOAD, &joint.name);
        }
        let spring = self.spring(joint);
        let stiffness = -spring.position;
        let damping = friction.viscous - spring.velocity;
        let mut attributes = Vec::new();
        if stiffness != 0.0 {
            attributes.push(("stiffness", numbers(&[stiffness])));
            attributes.push(("springref", numbers(&[spring.constant / stiffness])));
        }
        attributes.extend((damping != 0.0).then(|| ("damping", numbers(&[damping]))));
        attributes.extend((friction.dry != 0.0).then(|| ("frictionloss", numbers(&[friction.dry]))));
        attributes
    }

    /// Sum of the joint's springs that are linear and pull back.
    fn spring(&mut self, joint: &Joint) -> Affine {
        let mut sum = Affine::default();
        for law in &joint.springs {
            let fits = |law: &Affine| {
                let is_pull = law.position == 0.0 && law.constant != 0.0;
                law.position <= 0.0 && law.velocity <= 0.0 && !is_pull
            };
            match self.values.affine(law).filter(fits) {
                Some(law) => {
                    sum.constant += law.constant;
                    sum.position += law.position;
                    sum.velocity += law.velocity;
                }
                None => self.losses.add(OTHER_SPRINGS, &joint.name),
            }
        }
        sum
    }

    /// Writes a spherical or floating joint as a ball or free joint. Returns true, because it moves.
    pub(super) fn quaternion_joint(&mut self, joint: &QuaternionJoint) -> bool {
        let parts: Vec<&Joint> = self.model.joints().collect();
        let parts = &parts[joint.coordinates()];
        let frictions: Vec<Friction> = parts.iter().map(|part| self.damping(part)).collect();
        let first = frictions[0];
        let is_alike = frictions.iter().all(|friction| *friction == first) && first.dry == 0.0;
        if !is_alike || first.has_others {
            self.losses.add(QUATERNION_FRICTION, &joint.name);
        }
        let kind = if parts.len() == 6 { "free" } else { "ball" };
        let mut attributes = vec![("name", joint.name.clone()), ("type", kind.into())];
        attributes.extend((is_alike && first.viscous > 0.0).then(|| ("damping", numbers(&[first.viscous]))));
        self.xml.element("joint", attributes);
        for part in parts {
            if part.limits.velocity.or(part.limits.acceleration).or(part.limits.jerk).is_some() {
                self.losses.add(SPEED, &part.name);
            }
            if part.limits.effort.or(part.limits.peak_effort).is_some() {
                self.losses.add(
                    "has no force limits for single velocities of a joint with a quaternion. They are omitted at",
                    &part.name,
                );
            }
        }
        true
    }

    /// Friction and dampers of one velocity of a joint with a quaternion.
    fn damping(&self, part: &Joint) -> Friction {
        let mut friction = self.values.friction(&part.friction);
        for law in &part.springs {
            match self.values.affine(law).filter(|law| law.constant == 0.0 && law.velocity <= 0.0) {
                Some(law) => friction.viscous -= law.velocity,
                None => friction.has_others = true,
            }
        }
        friction
    }

    pub(super) fn followers(&mut self) {
        let model = self.model;
        for follower in &model.followers {
            let Some(joint) = &model.links[follower.link].joint else { continue };
            let leaders = self.leaders(&follower.follows, 1.0);
            self.equal(&joint.name, leaders, follower.offset);
        }
    }

    /// Names of the joints whose coordinates are followed, with ratios times `factor`.
    pub(super) fn leaders(&self, follows: &[FollowedCoordinate], factor: f64) -> Vec<(String, f64)> {
        let terms = follows.iter();
        terms.map(|term| (self.joint_name(term), factor * self.values.number(&term.ratio))).collect()
    }

    /// Writes the equation `joint = offset + Σ ratio · leader` as an equality of joints, or as a tendon
    /// `joint − Σ ratio · leader` with the length `offset`. Leaders are the followed joints.
    ///
    /// MuJoCo computes the softness of a joint equality without the ratio, and the softness of a tendon
    /// equality with the ratio. With a ratio below 1 the joint equality is softer. For a rack with 0.01
    /// m/rad, accelerations deviated by 115 % with a joint equality and by 0.03 % with a tendon.
    pub(super) fn equal(&mut self, joint: &str, leaders: Vec<(String, f64)>, offset: f64) {
        if let [(leader, ratio)] = &leaders[..]
            && ratio.abs() >= 1.0
        {
            let joints = vec![("joint1", joint.to_owned()), ("joint2", leader.clone())];
            return self.equality("joint", joints, [offset, *ratio, 0.0, 0.0, 0.0]);
        }
        let leaders = leaders.into_iter().map(|(leader, ratio)| (leader, -ratio));
        let joints = [(joint.to_owned(), 1.0)].into_iter().chain(leaders).collect();
        let name = self.tendon_name(joint);
        self.tendons.push(Tendon::fixed(name.clone(), joints, vec![]));
        self.equality("tendon", vec![("tendon1", name)], [offset, 0.0, 0.0, 0.0, 0.0]);
    }

    /// Adds an equality with the highest stiffness that MuJoCo accepts. Accelerations of
    /// models/palletizer.toml deviate by 36 % with MuJoCo's default and by 0.06 % with this stiffness
    /// (`tests/mujoco/compare.py`).
    fn equality(&mut self, tag: &'static str, mut attributes: Attributes, polynomial: [f64; 5]) {
        attributes.push(("polycoef", numbers(&polynomial)));
        attributes.push(("solimp", numbers(&[0.9999, 0.9999, 0.001])));
        self.equalities.push((tag, attributes));
    }

    pub(super) fn joint_name(&self, followed: &FollowedCoordinate) -> String {
        let link = &self.model.links[self.model.coordinates[followed.coordinate]];
        link.joint.as_ref().map_or(String::new(), |joint| joint.name.clone())
    }
}
