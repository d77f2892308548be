//! Writes a model as MJCF, the format of MuJoCo.
//!
//! Links become bodies, and frames become sites. Joints that follow other joints are separate joints with an
//! equality constraint, so MuJoCo's mass matrix M_mujoco has rows for all joints. With the ratios G of the
//! joints to the coordinates, the mass matrix of the model is `Gᵀ M_mujoco G`.

mod actuators;
mod joints;
mod rotors;
mod writer;

use super::format::Format;
use super::losses::Losses;
use super::names::distinct;
use super::numbers::{Lump, Placed, Values, quaternion};
use super::xml::{Attributes, Xml, numbers};
use crate::model::{Attachment, Link, Model, QuaternionJoint, principal_axes};
use writer::{Site, Writer};

/// Smallest mass (kg) and principal moment (kg m²) that are written for a moving body. MuJoCo rejects 1e-15
/// and less.
const LEAST: f64 = 2e-15;

const LEAST_INERTIA: &str = "requires mass and inertia of moving bodies. The least that MuJoCo accepts, 2e-15 kg or kg m², is \
                             written for";

/// Relative rounding error of published moments of inertia, which have about six digits.
const ROUNDED: f64 = 1e-5;

const RAISED: &str =
    "requires moments that satisfy the triangle inequality after rounding. The smaller moments are raised at";

const TRIANGLE: &str =
    "has bodies whose largest principal moment exceeds the sum of the others. MuJoCo rejects";

pub(super) fn export(model: &Model, source: &str) -> (String, Losses) {
    let mut writer = Writer {
        model,
        values: Values::of(model),
        xml: Xml::new(source),
        losses: Losses::new(Format::Mjcf),
        sites: Vec::new(),
        tendons: Vec::new(),
        equalities: Vec::new(),
        actuators: Vec::new(),
        rotors: Vec::new(),
    };
    writer.frames();
    writer.find_rotors();
    writer.actuators();
    writer.point_forces();
    writer.followers();
    writer.lost();
    writer.file();
    (writer.xml.finish(), writer.losses)
}

impl Writer<'_> {
    fn frames(&mut self) {
        let frames = self.model.frames.iter().map(|frame| Site {
            link: frame.link,
            name: frame.name.clone(),
            placed: self.values.placed(&frame.pose),
        });
        self.sites = frames.collect();
    }

    /// Name of the site at the frame of a force. A new site is added if there is none at this place.
    fn site(&mut self, at: &Attachment) -> String {
        let placed = self.values.placed(&at.pose);
        self.site_at(at.link, &at.name, placed)
    }

    fn site_at(&mut self, link: usize, name: &str, placed: Placed) -> String {
        let known = self.sites.iter().find(|site| site.link == link && site.placed == placed);
        if let Some(site) = known {
            return site.name.clone();
        }
        let name = distinct(name, |name| self.sites.iter().any(|site| site.name == name));
        self.sites.push(Site { link, name: name.clone(), placed });
        name
    }

    fn file(&mut self) {
        let model = self.model;
        self.xml.open("mujoco", vec![("model", model.name.clone())]);
        self.xml.element("compiler", vec![("angle", "radian".into()), ("autolimits", "true".into())]);
        let gravity = self.values.numbers(&model.gravity);
        self.xml.element("option", vec![("gravity", numbers(&gravity))]);
        self.xml.open("worldbody", vec![]);
        self.base(&model.links[0]);
        self.bodies();
        self.xml.close();
        self.sections();
    }

    /// Writes the base link. If it has masses they become a body, because the world has no mass in MuJoCo.
    fn base(&mut self, base: &Link) {
        self.link_sites(0);
        self.rotors_on(0);
        if !base.bodies.is_empty() {
            let taken = |name: &str| name == "world" || self.model.links[1..].iter().any(|l| l.name == name);
            self.xml.open("body", vec![("name", distinct(&base.name, taken))]);
            let lump = self.values.lump(self.model, 0);
            if lump != Lump::default() {
                self.inertial(lump, &base.name, false);
            }
            self.xml.close();
        }
    }

    /// Writes all links except the base. Each body is inside the body of its parent.
    fn bodies(&mut self) {
        let mut children = vec![Vec::new(); self.model.links.len()];
        for (link, joint) in self.model.links.iter().enumerate() {
            if let Some(joint) = &joint.joint {
                children[joint.parent].push(link);
            }
        }
        let mut stack: Vec<Option<usize>> = children[0].iter().rev().map(|&link| Some(link)).collect();
        while let Some(step) = stack.pop() {
            match step {
                None => self.xml.close(),
                Some(link) => {
                    let link = self.body(link);
                    stack.push(None);
                    stack.extend(children[link].iter().rev().map(|&link| Some(link)));
                }
            }
        }
    }

    /// Opens the body of a link and returns the link. For the first link of a joint with a quaternion, the
    /// body of the joint's last link is opened instead, and that link is returned.
    fn body(&mut self, first: usize) -> usize {
        let model = self.model;
        let chain = model.quaternion_joints.iter().find(|joint| model.coordinates[joint.first] == first);
        let last = chain.map_or(first, |joint| model.coordinates[joint.coordinates().end - 1]);
        let Some(joint) = &model.links[first].joint else { return last };
        let mut attributes = vec![("name", model.links[last].name.clone())];
        attributes.extend(place(&self.values.resting(joint)));
        self.xml.open("body", attributes);
        let moves = match chain {
            Some(chain) => self.quaternion_joint(chain),
            None => self.joint(first),
        };
        let lump = self.lump(last);
        if moves || lump != Lump::default() {
            self.inertial(lump, &model.links[last].name, moves);
        }
        self.link_sites(last);
        self.rotors_on(last);
        last
    }

    fn link_sites(&mut self, link: usize) {
        for site in self.sites.iter().filter(|site| site.link == link) {
            let mut attributes = vec![("name", site.name.clone())];
            attributes.extend(place(&site.placed));
            self.xml.element("site", attributes);
        }
    }

    /// Writes the inertia of a body. If the body moves, mass and moments are raised to the smallest values
    /// that MuJoCo accepts. If rounded moments violate the triangle inequality, the smaller moments are
    /// raised.
    fn inertial(&mut self, mut lump: Lump, name: &str, moves: bool) {
        if moves && lump.mass < LEAST {
            lump.mass = LEAST;
            self.losses.of_robot(LEAST_INERTIA, name);
        }
        let (mut moments, axes) = principal_axes(lump.inertia);
        if moves && moments.iter().any(|moment| *moment < LEAST) {
            moments = moments.map(|moment| moment.max(LEAST));
            self.losses.of_robot(LEAST_INERTIA, name);
        }
        let largest = moments.iter().fold(0.0, |most: f64, moment| most.max(*moment));
        let lacking = 2.0 * largest - moments.iter().sum::<f64>();
        if lacking > ROUNDED * largest {
            self.losses.refused(TRIANGLE, name);
        } else if lacking > -8.0 * f64::EPSILON * largest {
            let raised = |moment: f64| moment + lacking.max(0.0) + 4.0 * f64::EPSILON * largest;
            moments = moments.map(|moment| if moment == largest { moment } else { raised(moment) });
            self.losses.of_robot(RAISED, name);
        }
        self.xml.element("inertial", inertial(&lump, moments, &axes));
    }

    fn sections(&mut self) {
        let tendons = std::mem::take(&mut self.tendons);
        self.section("tendon", tendons, |writer, tendon| tendon.write(&mut writer.xml));
        let equalities = std::mem::take(&mut self.equalities);
        self.section("equality", equalities, |writer, (tag, attributes)| writer.xml.element(tag, attributes));
        let actuators = std::mem::take(&mut self.actuators);
        self.section("actuator", actuators, |writer, attributes| writer.xml.element("motor", attributes));
    }

    fn section<T>(&mut self, tag: &'static str, entries: Vec<T>, write: impl Fn(&mut Self, T)) {
        if !entries.is_empty() {
            self.xml.open(tag, vec![]);
            entries.into_iter().for_each(|entry| write(self, entry));
            self.xml.close();
        }
    }

    /// Records the parts of the model that no element of MJCF represents.
    fn lost(&mut self) {
        for wrench in &self.model.wrenches {
            self.losses.add("has no wrench arguments. Use `xfrc_applied` instead of", &wrench.name);
        }
        for parameter in &self.model.parameters {
            self.losses.add("has no free parameters. The described values are written for", &parameter.name);
        }
        for joint in &self.model.quaternion_joints {
            self.check_floating(joint);
        }
    }

    /// Records a loss if a floating joint is not on the base, because MuJoCo rejects it there. Also records a
    /// loss if the frame of the joint is not the base frame, because MuJoCo's positions are in the base frame.
    fn check_floating(&mut self, joint: &QuaternionJoint) {
        let first = &self.model.links[self.model.coordinates[joint.first]];
        let is_free = joint.coordinates().len() == 6;
        if let Some(carrier) = first.joint.as_ref().filter(|_| is_free) {
            if carrier.parent != 0 {
                self.losses.refused("has floating joints only at the base. MuJoCo rejects", &joint.name);
            } else if self.values.placed(&carrier.origin) != Placed::IDENTITY {
                self.losses.of_robot(
                    "has floating joints with positions in the base frame. The positions differ at",
                    &joint.name,
                );
            }
        }
    }
}

/// Attributes for a body's position and attitude, if they differ from those of the parent.
fn place(placed: &Placed) -> Attributes {
    let position = (placed.origin != [0.0; 3]).then(|| ("pos", numbers(&placed.origin)));
    let attitude = placed.is_turned().then(|| ("quat", numbers(&placed.quaternion())));
    position.into_iter().chain(attitude).collect()
}

/// Attributes for a body's inertia with principal moments, because MuJoCo would compute these with fewer
/// digits.
fn inertial(lump: &Lump, moments: [f64; 3], axes: &[[f64; 3]; 3]) -> Attributes {
    let mut attributes = vec![("pos", numbers(&lump.center))];
    if *axes != Placed::IDENTITY.rotation {
        attributes.push(("quat", numbers(&quaternion(axes))));
    }
    attributes.push(("mass", numbers(&[lump.mass])));
    attributes.push(("diaginertia", numbers(&moments)));
    attributes
}
