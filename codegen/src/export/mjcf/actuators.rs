//! Writes the inputs of a model as MJCF motors on joints, tendons and sites.

use super::joints::SPEED;
use super::writer::{Tendon, Writer};
use crate::export::losses::LINE;
use crate::export::names::distinct;
use crate::export::numbers::{Placed, Values};
use crate::export::xml::{Attributes, numbers};
use crate::model::{Attachment, Drive, ForceEffect, Input};

const TORQUES: &str = "has one range per input. Only the peak torque is written at";
const POINT_FORCE: &str = "has only linear springs and dampers between sites. Other laws are omitted at";
const SHAFT: &str = "has only viscous and dry friction of tendons. Other laws are omitted at the drive";

impl Writer<'_> {
    /// Writes the motors in the order of the inputs.
    pub(super) fn actuators(&mut self) {
        let model = self.model;
        for drive in &model.drives {
            if drive.line.is_some() {
                self.losses.add(LINE, &drive.name);
            }
        }
        for drive in model.input_drives() {
            let (key, target, gear) = self.transmission(drive);
            let mut attributes = vec![("name", drive.name.clone()), (key, target), ("gear", gear)];
            attributes.extend(self.torque_range(drive));
            self.actuators.push(attributes);
        }
        let inputless = model.moving_drives().filter(|drive| drive.input == Input::None);
        for drive in inputless.filter(|drive| drive.coordinate().is_none()) {
            self.weighted_sum(drive);
        }
        for input in &model.force_inputs {
            let (key, target, gear) = match &input.effect {
                ForceEffect::Wrench { at, wrench } => {
                    ("site", self.site(at), numbers(&self.values.numbers(wrench)))
                }
                ForceEffect::Pull(between) => {
                    ("tendon", self.distance(&input.name, between, vec![]), numbers(&[-1.0]))
                }
            };
            let mut attributes = vec![("name", input.name.clone()), (key, target), ("gear", gear)];
            attributes.extend(input.limits.map(|range| ("ctrlrange", numbers(&range))));
            self.actuators.push(attributes);
        }
    }

    /// Attribute, name and `gear` of the joint, tendon or site on which a drive's motor acts.
    fn transmission(&mut self, drive: &Drive) -> (&'static str, String, String) {
        let factor = match &drive.input {
            Input::Torque | Input::None => 1.0,
            Input::Current(constant) => self.values.number(constant),
        };
        let gear = self.values.number(&drive.gear_ratio) * factor;
        let quaternion = drive.coordinate().and_then(|coordinate| {
            let joint = self.model.quaternion_joint_of(coordinate)?;
            Some((joint, coordinate - joint.first))
        });
        if let Some((joint, index)) = quaternion {
            // Velocities are in the body's frame, as forces at a site are. Forces of a motor on a free joint
            // are in the world's frame.
            let link = self.model.coordinates[joint.coordinates().end - 1];
            let site = self.site_at(link, &joint.name, Placed::IDENTITY);
            let mut wrench = [0.0; 6];
            wrench[index + 6 - joint.coordinates().len()] = gear;
            return ("site", site, numbers(&wrench));
        }
        match (drive.coordinate(), &drive.acts_on[..]) {
            (Some(_), [only]) => ("joint", self.joint_name(only), numbers(&[gear])),
            _ => ("tendon", self.weighted_sum(drive), numbers(&[gear])),
        }
    }

    /// Adds the tendon of a drive on several coordinates, with rotor and friction of the drive. Returns its
    /// name.
    fn weighted_sum(&mut self, drive: &Drive) -> String {
        let ratio = self.values.number(&drive.gear_ratio);
        if drive.speed.is_some() {
            self.losses.add(SPEED, &drive.name);
        }
        let friction = self.values.friction(&drive.friction);
        if friction.has_others {
            self.losses.add(SHAFT, &drive.name);
        }
        let further = [
            ("armature", self.armature(drive)),
            ("damping", ratio * ratio * friction.viscous),
            ("frictionloss", ratio.abs() * friction.dry),
        ];
        let further = further.into_iter().filter(|(_, value)| *value != 0.0);
        let further = further.map(|(key, value)| (key, numbers(&[value]))).collect();
        let joints = drive.acts_on.iter();
        let joints = joints.map(|term| (self.joint_name(term), self.values.number(&term.ratio))).collect();
        let name = self.tendon_name(&drive.name);
        self.tendons.push(Tendon::fixed(name.clone(), joints, further));
        name
    }

    fn torque_range(&mut self, drive: &Drive) -> Option<(&'static str, String)> {
        if drive.torque.nominal.is_some() && drive.torque.peak.is_some() {
            self.losses.add(TORQUES, &drive.name);
        }
        let torque = drive.torque.peak.or(drive.torque.nominal)?;
        let most = match &drive.input {
            Input::Torque | Input::None => torque,
            Input::Current(constant) => (torque / self.values.number(constant)).abs(),
        };
        Some(("ctrlrange", numbers(&[-most, most])))
    }

    /// Writes the forces between frames as tendons.
    pub(super) fn point_forces(&mut self) {
        let model = self.model;
        for force in &model.point_forces {
            match spring(&self.values, &force.law) {
                Some(further) if further.is_empty() => {}
                Some(further) => {
                    self.distance(&force.name, &force.between, further);
                }
                None => self.losses.add(POINT_FORCE, &force.name),
            }
        }
    }

    /// Adds a tendon to the file whose length is the distance between two frames. Returns its name.
    fn distance(&mut self, name: &str, between: &[Attachment; 2], further: Attributes) -> String {
        let sites = between.each_ref().map(|at| self.site(at));
        let name = self.tendon_name(name);
        self.tendons.push(Tendon::spatial(name.clone(), sites, further));
        name
    }

    pub(super) fn tendon_name(&self, name: &str) -> String {
        let is_name = |tendon: &Tendon, name: &str| tendon.attributes.iter().any(|(_, value)| value == name);
        distinct(name, |name| self.tendons.iter().any(|tendon| is_name(tendon, name)))
    }
}

/// Attributes of a linear force law `k (l − l₀) + c l̇` over the distance l with stiffness k, rest length l₀
/// and damping c. A positive force pulls. `None` for other laws.
fn spring(values: &Values, law: &gelenk_formula::Formula) -> Option<Attributes> {
    let law = values.affine(law)?;
    let rest = if law.position == 0.0 { 0.0 } else { -law.constant / law.position };
    let fits = law.position >= 0.0 && law.velocity >= 0.0 && rest >= 0.0;
    let is_pull = law.position == 0.0 && law.constant != 0.0;
    if !fits || is_pull {
        return None;
    }
    let mut attributes = Vec::new();
    if law.position > 0.0 {
        attributes.push(("stiffness", numbers(&[law.position])));
        attributes.push(("springlength", numbers(&[rest])));
    }
    attributes.extend((law.velocity > 0.0).then(|| ("damping", numbers(&[law.velocity]))));
    Some(attributes)
}
