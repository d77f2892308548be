//! Mass and inertia of a body, from `<inertial>` or from its geoms.

use std::f64::consts::PI;

use super::compiler::FromGeoms;
use super::files::Element;
use super::place::z_to;
use super::{Placed, Reader, notes, or};
use crate::description::{BodyDescription, Name};
use crate::diagnostic::At;
use crate::model::Pose;
use crate::model::inertia::principal_axes;
use crate::model::pose::{Rotation, Unsaid, rotate_inertia};
use crate::numeric::length;
use gelenk_formula::Formula;

/// Density of water, the default of MuJoCo (kg/m³).
const DENSITY: f64 = 1000.0;

/// Types of geoms whose shape is a mesh file.
const MESHES: [&str; 2] = ["mesh", "sdf"];
const FLAT: [&str; 2] = ["plane", "hfield"];

/// Mass, centre of mass, and inertia about the centre of mass with the entries xx, xy, xz, yy, yz, zz.
#[derive(Debug, Clone, Copy)]
struct Lump {
    mass: f64,
    center: [f64; 3],
    inertia: [f64; 6],
}

/// Mass and inertia that a geom adds to its body.
enum Share {
    Nothing,
    Lump(Lump),
    /// A mesh whose mass and inertia cannot be computed, with the reason.
    Unknown(String),
}

/// A solid: volume, and principal moments about its centre for a unit of mass.
#[derive(Debug, Clone, Copy)]
struct Solid {
    volume: f64,
    moments: [f64; 3],
}

impl<'a> Reader<'_, 'a> {
    pub(super) fn inertia(&mut self, name: &Name, body: Element<'a>, contents: &[Placed<'a>]) {
        let described = contents.iter().find(|placed| placed.element.tag() == "inertial");
        let lump = match (self.compiler.inertia_from_geoms, described) {
            (FromGeoms::Never | FromGeoms::WithoutInertial, Some(inertial)) => {
                self.described(inertial, &format!("inertia of `{}`", name.value))
            }
            (FromGeoms::Never, None) => None,
            _ => self.of_geoms(name, contents),
        };
        let place = described.map_or(body.span(), |inertial| inertial.element.span());
        if let Some(lump) = self.bounded(lump) {
            self.robot.bodies.push(BodyDescription {
                name: name.clone(),
                link: name.clone(),
                origin: None,
                unsaid: Unsaid::default(),
                mass: Some(At::new(Formula::Number(lump.mass), place)),
                center_of_mass: Some(lump.center.map(Formula::Number)),
                inertia: Some(At::new(lump.inertia.map(Formula::Number), place)),
                accept_unphysical: false,
                is_published: true,
            });
        }
    }

    /// Mass and inertia of an `<inertial>`.
    fn described(&mut self, inertial: &Placed<'a>, owner: &str) -> Option<Lump> {
        let element = inertial.element;
        for key in ["pos", "mass"] {
            if element.attribute(key).is_none() {
                self.report.error(element.span(), "missing-attribute", format!("<inertial> has no `{key}`"));
            }
        }
        let mass = self.number(element.attribute("mass"), "mass")?.value;
        let pose = inertial.pose.then(&self.pose(element, owner));
        let full = self.vector::<6>(element.attribute("fullinertia"), "fullinertia");
        let diagonal = self.vector::<3>(element.attribute("diaginertia"), "diaginertia");
        let inertia = match (full, diagonal) {
            (Some(full), _) => {
                let [xx, yy, zz, xy, xz, yz] = full.value;
                [xx, xy, xz, yy, yz, zz]
            }
            (None, Some(At { value: [xx, yy, zz], .. })) => [xx, 0.0, 0.0, yy, 0.0, zz],
            (None, None) => [0.0; 6],
        };
        Some(Lump { mass, center: origin(&pose), inertia: turned(&pose.rotation, inertia) })
    }

    /// Mass and inertia of all geoms of a body together; `None` if no geom has mass.
    fn of_geoms(&mut self, name: &Name, contents: &[Placed<'a>]) -> Option<Lump> {
        let mut lumps = Vec::new();
        for geom in contents.iter().filter(|placed| placed.element.tag() == "geom") {
            match self.share(geom, name) {
                Share::Nothing => {}
                Share::Lump(lump) => lumps.push(lump),
                Share::Unknown(why) => {
                    let of_body = format!("{} of {}", why, name.quoted());
                    self.notes.remark(notes::MESH_INERTIA, geom.element.span(), of_body);
                }
            }
        }
        (!lumps.is_empty()).then(|| sum(&lumps))
    }

    fn share(&mut self, geom: &Placed<'a>, body: &Name) -> Share {
        let class = self.class(geom.element, "class", geom.class);
        let geom = Placed { class, ..geom.clone() };
        let group = or(self.number(self.find(&geom, "group"), "group"), 0.0);
        let [low, high] = self.compiler.groups;
        if group < low || group > high {
            return Share::Nothing;
        }
        let [mass, density] = ["mass", "density"].map(|key| self.number(self.find(&geom, key), key));
        for given in [&mass, &density].into_iter().flatten().filter(|given| given.value < 0.0) {
            let message =
                format!("a geom of body `{}` has the negative mass or density {}", body.value, given.value);
            self.report.error(given.span, "mass-not-positive", message);
            self.report.help("mass and density must be finite and at least 0");
        }
        let (mass, density) = (mass.map(|mass| mass.value), or(density, DENSITY));
        let is_massless = mass.unwrap_or(density) == 0.0;
        let kind = self.find(&geom, "type");
        let kind = kind.map_or("sphere", |given| given.text);
        if is_massless || FLAT.contains(&kind) {
            return Share::Nothing;
        }
        if let Some(given) = self.find(&geom, "shellinertia").filter(|given| given.text == "true") {
            self.report.error(
                given.span,
                "shell-inertia",
                "the inertia of a hollow geom (`shellinertia`) is not supported",
            );
            self.report
                .help("give the body an <inertial>. `mujoco.mj_saveLastXML` with `saveinertial` writes it");
            return Share::Nothing;
        }
        if let Some(mesh) = self.find(&geom, "mesh") {
            return match kind {
                "mesh" => self.of_mesh(&geom, mesh.text, mass, density, body),
                _ => Share::Unknown(format!("`{}` as a {kind}", mesh.text)),
            };
        }
        if MESHES.contains(&kind) {
            return Share::Unknown(format!("a {kind}"));
        }
        let Some((solid, pose)) = self.solid(&geom, kind, body) else { return Share::Nothing };
        let mass = mass.unwrap_or(density * solid.volume);
        let [xx, yy, zz] = solid.moments.map(|moment| mass * moment);
        let pose = geom.pose.then(&pose);
        let inertia = turned(&pose.rotation, [xx, 0.0, 0.0, yy, 0.0, zz]);
        Share::Lump(Lump { mass, center: origin(&pose), inertia })
    }

    /// Mass and inertia of a mesh with this mass, or with this density if the mass is `None`.
    fn of_mesh(
        &mut self,
        geom: &Placed<'a>,
        mesh: &str,
        mass: Option<f64>,
        density: f64,
        body: &Name,
    ) -> Share {
        let integrals = match self.mesh(mesh) {
            Ok(integrals) => integrals,
            Err(why) => return Share::Unknown(why),
        };
        let pose = geom.pose.then(&self.pose_of(geom, &format!("a geom of `{}`", body.value)));
        let density = mass.map_or(density, |mass| mass / integrals.size);
        let center = Pose { translation: integrals.center.map(Formula::Number), ..Pose::identity() };
        Share::Lump(Lump {
            mass: density * integrals.size,
            center: origin(&pose.then(&center)),
            inertia: turned(&pose.rotation, integrals.inertia.map(|entry| density * entry)),
        })
    }

    /// A geom's primitive shape, and its pose in the body's frame.
    fn solid(&mut self, geom: &Placed<'a>, kind: &str, body: &Name) -> Option<(Solid, Pose)> {
        let ends = self.vector::<6>(self.find(geom, "fromto"), "fromto");
        let given = self.find(geom, "size");
        let mut size =
            given.and_then(|given| self.numbers(given, "size")).map_or(Vec::new(), |size| size.value);
        let pose = match ends {
            Some(At { value: [a, b, c, d, e, f], .. }) => {
                let [x, y, z] = [d - a, e - b, f - c];
                let long = length([x, y, z]);
                size.truncate(1);
                if matches!(kind, "box" | "ellipsoid") {
                    size.extend(size.first().copied());
                }
                size.push(long / 2.0);
                let center = [(a + d) / 2.0, (b + e) / 2.0, (c + f) / 2.0].map(Formula::Number);
                let direction = if long > 0.0 { [x, y, z].map(|x| x / long) } else { [0.0, 0.0, 1.0] };
                Pose { translation: center, rotation: z_to(direction) }
            }
            None => self.pose_of(geom, &format!("a geom of `{}`", body.value)),
        };
        match (solid(kind, &size), self.find(geom, "type")) {
            (Some(solid), _) => Some((solid, pose)),
            (None, Some(given)) if !SOLIDS.contains(&kind) => {
                self.one_of(given, "type", &SOLIDS);
                None
            }
            (None, _) => {
                let span = given.map_or(geom.element.span(), |given| given.span);
                let message = format!("a geom of type `{kind}` lacks a size, or a size is not positive");
                self.report.error(span, "geom-size", message);
                None
            }
        }
    }

    /// The inertia after the bounds of `<compiler>` are applied: smallest mass, smallest moments, triangle
    /// inequality.
    fn bounded(&mut self, lump: Option<Lump>) -> Option<Lump> {
        let compiler = &self.compiler;
        let is_bounded = compiler.least_mass > 0.0 || compiler.least_inertia > 0.0;
        if !is_bounded && !compiler.balances {
            return lump;
        }
        let nothing = is_bounded.then_some(Lump { mass: 0.0, center: [0.0; 3], inertia: [0.0; 6] });
        let mut lump = lump.or(nothing)?;
        lump.mass = lump.mass.max(compiler.least_mass);
        let (moments, axes) = principal_axes(lump.inertia);
        let mut changed = moments.map(|moment| moment.max(compiler.least_inertia));
        let (sum, largest) =
            (changed.iter().sum::<f64>(), changed.iter().fold(0.0, |most: f64, moment| most.max(*moment)));
        if compiler.balances && largest > sum - largest {
            changed = [sum / 3.0; 3];
        }
        if changed != moments {
            let [xx, yy, zz] = changed;
            lump.inertia = turned(&axes, [xx, 0.0, 0.0, yy, 0.0, zz]);
        }
        Some(lump)
    }

    /// Scales all masses so that their sum is the one in `<compiler>`.
    pub(super) fn scale_masses(&mut self) {
        let Some(total) = self.compiler.total_mass else { return };
        let masses = self.robot.bodies.iter().filter_map(|body| body.mass.as_ref()?.value.as_number());
        let factor = Formula::Number(total / masses.sum::<f64>());
        for body in &mut self.robot.bodies {
            if let Some(mass) = &mut body.mass {
                mass.value = Formula::product(factor.clone(), mass.value.clone());
            }
            for entry in body.inertia.iter_mut().flat_map(|inertia| &mut inertia.value) {
                *entry = Formula::product(factor.clone(), entry.clone());
            }
        }
    }
}

const SOLIDS: [&str; 5] = ["sphere", "capsule", "ellipsoid", "cylinder", "box"];

/// Volume and moments of a primitive solid with these sizes: radii and half lengths.
fn solid(kind: &str, size: &[f64]) -> Option<Solid> {
    let count = match kind {
        "sphere" => 1,
        "capsule" | "cylinder" => 2,
        "ellipsoid" | "box" => 3,
        _ => return None,
    };
    let size = size.get(..count).filter(|size| size.iter().all(|x| *x > 0.0))?;
    Some(match *size {
        [r] => ellipsoid([r, r, r]),
        [r, h] if kind == "cylinder" => {
            let across = (3.0 * r * r + 4.0 * h * h) / 12.0;
            Solid { volume: 2.0 * PI * r * r * h, moments: [across, across, r * r / 2.0] }
        }
        [r, h] => capsule(r, h),
        [a, b, c] if kind == "box" => Solid {
            volume: 8.0 * a * b * c,
            moments: [b * b + c * c, a * a + c * c, a * a + b * b].map(|x| x / 3.0),
        },
        [a, b, c] => ellipsoid([a, b, c]),
        _ => return None,
    })
}

fn ellipsoid([a, b, c]: [f64; 3]) -> Solid {
    let moments = [b * b + c * c, a * a + c * c, a * a + b * b].map(|x| x / 5.0);
    Solid { volume: 4.0 / 3.0 * PI * a * b * c, moments }
}

/// A cylinder of half length h between two half balls. The centres of mass of the half balls are 3 r/8 from
/// their flat faces.
fn capsule(r: f64, h: f64) -> Solid {
    let (cylinder, ball) = (2.0 * PI * r * r * h, 4.0 / 3.0 * PI * r * r * r);
    let volume = cylinder + ball;
    let across = cylinder * (3.0 * r * r + 4.0 * h * h) / 12.0 + ball * (0.4 * r * r + h * (h + 0.75 * r));
    let along = cylinder * r * r / 2.0 + ball * 0.4 * r * r;
    Solid { volume, moments: [across, across, along].map(|moment| moment / volume) }
}

fn sum(lumps: &[Lump]) -> Lump {
    let mass: f64 = lumps.iter().map(|lump| lump.mass).sum();
    let center =
        std::array::from_fn(|k| lumps.iter().map(|lump| lump.mass * lump.center[k]).sum::<f64>() / mass);
    let mut inertia = [0.0; 6];
    for lump in lumps {
        let [x, y, z]: [f64; 3] = std::array::from_fn(|k| lump.center[k] - center[k]);
        let moved = [y * y + z * z, -x * y, -x * z, x * x + z * z, -y * z, x * x + y * y];
        inertia = std::array::from_fn(|k| inertia[k] + lump.inertia[k] + lump.mass * moved[k]);
    }
    Lump { mass, center, inertia }
}

fn origin(pose: &Pose) -> [f64; 3] {
    pose.translation.each_ref().map(|entry| entry.as_number().unwrap_or(0.0))
}

fn turned(rotation: &Rotation, inertia: [f64; 6]) -> [f64; 6] {
    let turned = rotate_inertia(rotation, &inertia.map(Formula::Number));
    turned.each_ref().map(|entry| entry.as_number().unwrap_or(0.0))
}
