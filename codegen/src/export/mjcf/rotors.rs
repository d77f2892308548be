//! Rotors: armatures, and bodies of their own if an armature is another robot.
//!
//! A rotor with the axial inertia J, which turns by Ω relative to its carrier, has the energy `J/2 (a · ω + Ω)²`; ω is the
//! velocity of its carrier and a its axis. An armature has `J/2 Ω²`, which is the same if the carrier rests. Otherwise the rotor is a
//! body on its carrier whose joint follows those of its drive. MuJoCo takes no body without inertia across the axis: the
//! rotor has some, and its carrier has that much less.

use super::writer::{Rotor, Writer};
use super::{LEAST, inertial};
use crate::export::names::unlike_others;
use crate::export::numbers::Lump;
use crate::export::xml::numbers;
use crate::model::{Drive, FollowedCoordinate, Model, Motion, RotorCoupling, principal_axes};
use gelenk_formula::Formula;

const ROTOR: &str = "has no rotors in carriers with less inertia than they, and none that follow joints with quaternions; their \
                     effect on moving carriers was left out at";

/// Inertia across the axis, in units of the axial one: a disc has half, the least of a rigid body.
const ACROSS: f64 = 0.5 + 1e-6;

impl Writer<'_> {
    /// Decides which rotors have bodies on moving links: none of a link if it has too little inertia.
    pub(super) fn find_rotors(&mut self) {
        let model = self.model;
        let carrier = |drive: &Drive| if self.moves_its_carrier(drive) { drive.carrier } else { 0 };
        self.rotors = model.drives.iter().map(|drive| self.rotor(drive, carrier(drive))).collect();
        for link in 1..model.links.len() {
            let carried = |rotor: &Option<Rotor>| rotor.as_ref().is_some_and(|rotor| rotor.carrier == link);
            if self.rotors.iter().any(carried) && !self.is_body(link) {
                for (place, drive) in model.drives.iter().enumerate() {
                    if carried(&self.rotors[place]) {
                        self.rotors[place] = self.rotor(drive, 0);
                    }
                }
            }
        }
        for (drive, rotor) in model.drives.iter().zip(&self.rotors) {
            let is_on_its_carrier = rotor.as_ref().is_some_and(|rotor| rotor.carrier == drive.carrier);
            let is_lost =
                self.follows_quaternion(drive) || self.moves_its_carrier(drive) && !is_on_its_carrier;
            if is_lost && self.values.number(&drive.rotor_inertia) != 0.0 {
                self.losses.of_robot(ROTOR, &drive.name);
            }
        }
    }

    /// The body of a rotor on a link, 0 for one at rest; `None` if an armature is the same.
    fn rotor(&self, drive: &Drive, carrier: usize) -> Option<Rotor> {
        let model = self.model;
        let inertia = self.values.number(&drive.rotor_inertia);
        let is_armature = carrier == 0 && is_chain(model, drive);
        (ACROSS * inertia > LEAST && !is_armature && !self.follows_quaternion(drive)).then(|| Rotor {
            name: unlike_others(model, &format!("{}_rotor", drive.name)),
            carrier,
            axis: drive.axis,
            inertia,
        })
    }

    fn moves_its_carrier(&self, drive: &Drive) -> bool {
        drive.coupling == RotorCoupling::Body
            && !drive.acts_on.is_empty()
            && is_moving(self.model, drive.carrier)
    }

    fn follows_quaternion(&self, drive: &Drive) -> bool {
        drive.acts_on.iter().any(|term| self.model.quaternion_joint_of(term.coordinate).is_some())
    }

    /// Tells whether MuJoCo takes the inertia of a link without that of its rotors across their axes.
    fn is_body(&self, link: usize) -> bool {
        let (moments, _) = principal_axes(self.lump(link).inertia);
        let largest = moments.iter().fold(0.0, |most: f64, moment| most.max(*moment));
        moments.iter().all(|moment| *moment > LEAST) && 2.0 * largest <= moments.iter().sum::<f64>()
    }

    /// The bodies of a link as one: with the rotors of held joints, and without the inertia of other rotors across their axes.
    pub(super) fn lump(&self, link: usize) -> Lump {
        let mut lump = self.values.lump(&self.model.links[link].bodies);
        let mut add =
            |moments: [f64; 6]| lump.inertia = std::array::from_fn(|k| lump.inertia[k] + moments[k]);
        for rotor in self.rotors.iter().flatten().filter(|rotor| rotor.carrier == link) {
            add(moments(rotor.axis, 0.0, -ACROSS * rotor.inertia));
        }
        for drive in self.model.drives.iter().filter(|drive| drive.carrier == link && is_held(drive)) {
            add(moments(drive.axis, self.values.number(&drive.rotor_inertia), 0.0));
        }
        lump
    }

    /// `i² J_R` of a drive without a body for its rotor.
    pub(super) fn armature(&self, drive: &Drive) -> f64 {
        let place = self.model.drives.iter().position(|other| std::ptr::eq(other, drive));
        if place.is_some_and(|place| self.rotors[place].is_some()) {
            return 0.0;
        }
        let ratio = self.values.number(&drive.gear_ratio);
        ratio * ratio * self.values.number(&drive.rotor_inertia)
    }

    /// `Σ i² J_R` of the drives on one coordinate.
    pub(super) fn joint_armature(&self, coordinate: usize) -> f64 {
        let drives = self.model.drives.iter().filter(|drive| drive.coordinate() == Some(coordinate));
        drives.map(|drive| self.armature(drive)).sum()
    }

    /// Bodies of the rotors that a link carries. Each joint follows those of its drive.
    pub(super) fn rotors_on(&mut self, link: usize) {
        let model = self.model;
        for (place, drive) in model.drives.iter().enumerate() {
            let Some(rotor) = self.rotors[place].as_ref().filter(|rotor| rotor.carrier == link) else {
                continue;
            };
            let (name, axis) = (rotor.name.clone(), numbers(&rotor.axis));
            let (moments, axes) = principal_axes(moments(rotor.axis, rotor.inertia, ACROSS * rotor.inertia));
            let lump = Lump { mass: LEAST, ..Lump::default() };
            self.xml.open("body", vec![("name", name.clone())]);
            self.xml.element("joint", vec![("name", name.clone()), ("axis", axis)]);
            self.xml.element("inertial", inertial(&lump, moments, &axes));
            self.xml.close();
            self.follow(&name, drive);
        }
    }

    fn follow(&mut self, name: &str, drive: &Drive) {
        let gear = self.values.number(&drive.gear_ratio);
        let scaled = |term: &FollowedCoordinate| FollowedCoordinate {
            ratio: Formula::Number(gear * self.values.number(&term.ratio)),
            ..term.clone()
        };
        let follows: Vec<FollowedCoordinate> = drive.acts_on.iter().map(scaled).collect();
        self.follow_all(name, &follows, 0.0);
    }
}

/// The inertia with these moments along and across an axis: xx, xy, xz, yy, yz, zz.
fn moments([x, y, z]: [f64; 3], along: f64, across: f64) -> [f64; 6] {
    let own = [x * x, x * y, x * z, y * y, y * z, z * z];
    let unit = [1.0, 0.0, 0.0, 1.0, 0.0, 1.0];
    std::array::from_fn(|k| across * unit[k] + (along - across) * own[k])
}

/// Tells whether a rotor is a part of its carrier, since its joint is held.
fn is_held(drive: &Drive) -> bool {
    drive.coupling == RotorCoupling::Body && drive.acts_on.is_empty()
}

/// Tells whether of any two joints that a drive acts on one carries the other: MuJoCo's M has no entries for others, and the
/// armature of a tendon would lose them.
fn is_chain(model: &Model, drive: &Drive) -> bool {
    let carries = |link: usize, mut other: usize| loop {
        match &model.links[other].joint {
            _ if other == link => return true,
            Some(joint) => other = joint.parent,
            None => return false,
        }
    };
    let links: Vec<usize> = drive.acts_on.iter().map(|term| model.coordinates[term.coordinate]).collect();
    links.iter().all(|&a| links.iter().all(|&b| carries(a, b) || carries(b, a)))
}

/// Tells whether a link moves.
fn is_moving(model: &Model, mut link: usize) -> bool {
    while let Some(joint) = &model.links[link].joint {
        if matches!(joint.motion, Motion::Coordinate(_) | Motion::Follower(_)) {
            return true;
        }
        link = joint.parent;
    }
    false
}
