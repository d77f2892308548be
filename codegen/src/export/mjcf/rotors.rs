//! Writes rotors as armatures, or as separate bodies if an armature would change the robot.
//!
//! A rotor with the axial inertia J and the speed Ω relative to its carrier has the energy `J/2 (a · ω + Ω)²`.
//! ω is the carrier's angular velocity, and a is the rotor's axis. An armature has the energy `J/2 Ω²`, which
//! is equal if the carrier does not turn. Otherwise the rotor becomes a body on its carrier, with a joint that
//! follows the joints of its drive. MuJoCo requires inertia across the axis, so the rotor gets such an
//! inertia and its carrier gets less.

use super::writer::{Rotor, Writer};
use super::{LEAST, inertial};
use crate::export::names::unlike_others;
use crate::export::numbers::Lump;
use crate::export::xml::numbers;
use crate::model::{Drive, Model, Motion, RotorCoupling, principal_axes};

const ROTOR: &str = "supports a rotor only if its carrier has more inertia and the rotor follows no joint with a quaternion. Its \
                     effect on a moving carrier is omitted at";

/// Inertia of a rotor across its axis, divided by the axial inertia. A disc has 0.5, the smallest value of a
/// rigid body.
const ACROSS: f64 = 0.5 + 1e-6;

impl<'m> Writer<'m> {
    /// Finds the rotors that become bodies of the file. If a link has too little inertia for its rotors, they
    /// are placed on the base.
    pub(super) fn find_rotors(&mut self) {
        let model = self.model;
        for drive in model.moving_drives() {
            let carrier = if self.moves_its_carrier(drive) { drive.carrier } else { 0 };
            self.rotors.extend(self.rotor(drive, carrier));
        }
        for link in 1..model.links.len() {
            if self.rotors.iter().any(|rotor| rotor.carrier == link) && !self.is_body(link) {
                let rotors = std::mem::take(&mut self.rotors).into_iter();
                self.rotors = rotors.filter_map(|rotor| self.not_on(link, rotor)).collect();
            }
        }
        for drive in model.moving_drives().filter(|drive| self.values.number(&drive.rotor_inertia) != 0.0) {
            let carrier = self.rotor_of(drive).map(|rotor| rotor.carrier);
            let is_on_base = self.moves_its_carrier(drive) && carrier != Some(drive.carrier);
            if is_on_base || self.follows_quaternion(drive) {
                self.losses.of_robot(ROTOR, &drive.name);
            }
        }
    }

    /// Returns a rotor on the link `carrier` that becomes a body of the file; `None` if an armature has the
    /// same effect or a body is not possible.
    fn rotor(&self, drive: &'m Drive, carrier: usize) -> Option<Rotor<'m>> {
        let inertia = self.values.number(&drive.rotor_inertia);
        let is_armature = carrier == 0 && is_chain(self.model, drive);
        let is_body = ACROSS * inertia > LEAST && !is_armature && !self.follows_quaternion(drive);
        is_body.then_some(Rotor { drive, inertia, carrier })
    }

    /// Returns the rotor, moved to the base if it is on the given link.
    fn not_on(&self, link: usize, rotor: Rotor<'m>) -> Option<Rotor<'m>> {
        if rotor.carrier == link { self.rotor(rotor.drive, 0) } else { Some(rotor) }
    }

    fn rotor_of(&self, drive: &Drive) -> Option<&Rotor<'m>> {
        self.rotors.iter().find(|rotor| std::ptr::eq(rotor.drive, drive))
    }

    fn moves_its_carrier(&self, drive: &Drive) -> bool {
        drive.coupling == RotorCoupling::Body && is_moving(self.model, drive.carrier)
    }

    fn follows_quaternion(&self, drive: &Drive) -> bool {
        drive.acts_on.iter().any(|term| self.model.quaternion_joint_of(term.coordinate).is_some())
    }

    /// Whether MuJoCo accepts the inertia of a link after the inertia of its rotors across their axes is
    /// subtracted.
    fn is_body(&self, link: usize) -> bool {
        let (moments, _) = principal_axes(self.lump(link).inertia);
        let largest = moments.iter().fold(0.0, |most: f64, moment| most.max(*moment));
        moments.iter().all(|moment| *moment > LEAST) && 2.0 * largest <= moments.iter().sum::<f64>()
    }

    /// Mass and inertia of all bodies of a link together, without the inertia of the link's rotors across
    /// their axes.
    pub(super) fn lump(&self, link: usize) -> Lump {
        let mut lump = self.values.lump(self.model, link);
        for rotor in self.rotors.iter().filter(|rotor| rotor.carrier == link) {
            lump.add_about_axis(rotor.drive.axis, 0.0, -ACROSS * rotor.inertia);
        }
        lump
    }

    /// Armature `i² J_R` of a drive with the gear ratio i and the rotor inertia J_R; 0 if the rotor is a body
    /// of the file.
    pub(super) fn armature(&self, drive: &Drive) -> f64 {
        if self.rotor_of(drive).is_some() {
            return 0.0;
        }
        let ratio = self.values.number(&drive.gear_ratio);
        ratio * ratio * self.values.number(&drive.rotor_inertia)
    }

    /// Armature `Σ i² J_R` of the drives on one coordinate, with gear ratios i and rotor inertias J_R.
    pub(super) fn joint_armature(&self, coordinate: usize) -> f64 {
        let drives = self.model.drives.iter().filter(|drive| drive.coordinate() == Some(coordinate));
        drives.map(|drive| self.armature(drive)).sum()
    }

    /// Writes the bodies of the rotors on a link. The joint of such a body follows the joints of the rotor's
    /// drive.
    pub(super) fn rotors_on(&mut self, link: usize) {
        let rotors = std::mem::take(&mut self.rotors);
        rotors.iter().filter(|rotor| rotor.carrier == link).for_each(|rotor| self.rotor_body(rotor));
        self.rotors = rotors;
    }

    fn rotor_body(&mut self, &Rotor { drive, inertia, .. }: &Rotor<'m>) {
        let name = unlike_others(self.model, &format!("{}_rotor", drive.name));
        let mut lump = Lump { mass: LEAST, ..Lump::default() };
        lump.add_about_axis(drive.axis, inertia, ACROSS * inertia);
        let (moments, axes) = principal_axes(lump.inertia);
        self.xml.open("body", vec![("name", name.clone())]);
        self.xml.element("joint", vec![("name", name.clone()), ("axis", numbers(&drive.axis))]);
        self.xml.element("inertial", inertial(&lump, moments, &axes));
        self.xml.close();
        let leaders = self.leaders(&drive.acts_on, self.values.number(&drive.gear_ratio));
        self.equal(&name, leaders, 0.0);
    }
}

/// Whether all joints of a drive are on one path to the base. MuJoCo's mass matrix has no entries for joints
/// of different branches, so the armature of a tendon would lose them.
fn is_chain(model: &Model, drive: &Drive) -> bool {
    let links: Vec<usize> = drive.acts_on.iter().map(|term| model.coordinates[term.coordinate]).collect();
    let carries = |a: usize, b: usize| to_base(model, b).any(|link| link == a);
    links.iter().all(|&a| links.iter().all(|&b| carries(a, b) || carries(b, a)))
}

fn is_moving(model: &Model, link: usize) -> bool {
    let mut joints = to_base(model, link).filter_map(|link| model.links[link].joint.as_ref());
    joints.any(|joint| matches!(joint.motion, Motion::Coordinate(_) | Motion::Follower(_)))
}

/// The links on the path from a link to the base, including this link.
fn to_base(model: &Model, link: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(link), |&link| Some(model.links[link].joint.as_ref()?.parent))
}
