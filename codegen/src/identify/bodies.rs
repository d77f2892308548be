//! Conversion of identified inertial parameters to bodies of a description.

use std::fmt::Write;

use super::parameters::{derive, free, result};
use super::words::number;
use crate::diagnostic::Diagnostics;
use crate::dynamics::parameters::regressor::PER_LINK;
use crate::model::{Model, Motion};
use crate::wording::toml_text;

/// A body of a description, with identified values. The axes of its inertia matrix are parallel to those of
/// the link's frame.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyValues {
    /// Name of the body in the description.
    pub name: String,
    /// Name of the link that carries the body (key `link`); `None` if the key is not written.
    pub link: Option<String>,
    /// Mass of the body in kg.
    pub mass: f64,
    /// Centre of mass in the link's frame, in m.
    pub center_of_mass: [f64; 3],
    /// Entries xx, yy, zz, xy, xz, yz of the inertia matrix about the centre of mass, in kg m².
    pub inertia: [f64; 6],
}

impl BodyValues {
    /// Creates a body from the ten inertial parameters of a link: mass m, first moments m c with the centre
    /// of mass c, and the entries xx, xy, yy, xz, yz, zz of the inertia matrix I_o. I_o is about the origin
    /// of the link's frame. The inertia about the centre of mass is `I_c = I_o − m (cᵀc 1 − c cᵀ)` (parallel
    /// axis theorem).
    #[must_use]
    pub fn of_link(name: String, link: Option<String>, parameters: &[f64]) -> Self {
        let &[mass, hx, hy, hz, xx, xy, yy, xz, yz, zz] = parameters else {
            unreachable!("a link has {PER_LINK} inertial parameters");
        };
        let center_of_mass = [hx, hy, hz].map(|h| if mass == 0.0 { 0.0 } else { h / mass });
        let (about_origin, of_point) = ([xx, yy, zz, xy, xz, yz], point_inertia(mass, center_of_mass));
        let inertia = std::array::from_fn(|k| about_origin[k] - of_point[k]);
        Self { name, link, mass, center_of_mass, inertia }
    }

    /// Returns the ten inertial parameters of a link that consists of this body, in the order of
    /// [`Self::of_link`].
    #[must_use]
    pub fn parameters(&self) -> [f64; PER_LINK] {
        let of_point = point_inertia(self.mass, self.center_of_mass);
        let [xx, yy, zz, xy, xz, yz] = std::array::from_fn(|k| self.inertia[k] + of_point[k]);
        let [hx, hy, hz] = self.center_of_mass.map(|place| self.mass * place);
        [self.mass, hx, hy, hz, xx, xy, yy, xz, yz, zz]
    }

    /// Returns the table `[[bodies]]` of the description as TOML.
    #[must_use]
    pub fn toml(&self) -> String {
        let mut text = format!("[[bodies]]\nname = {}\n", toml_text(&self.name));
        if let Some(link) = &self.link {
            let _ = writeln!(text, "link = {}", toml_text(link));
        }
        let [x, y, z] = self.center_of_mass.map(number);
        let _ = writeln!(text, "mass = {}\ncenter_of_mass = [{x}, {y}, {z}]", number(self.mass));
        let names = ["xx", "yy", "zz", "xy", "xz", "yz"];
        let entries =
            names.iter().zip(self.inertia).map(|(name, value)| format!("{name} = {}", number(value)));
        let _ = writeln!(text, "inertia = {{ {} }}", entries.collect::<Vec<_>>().join(", "));
        text
    }
}

/// Returns the entries xx, yy, zz, xy, xz, yz of the inertia matrix of a point with a mass, about the origin.
fn point_inertia(mass: f64, [x, y, z]: [f64; 3]) -> [f64; 6] {
    [y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z].map(|entry| mass * entry)
}

/// Bodies of a moving link, with identified parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkBodies {
    /// First body of the link, which has all identified parameters of the link.
    pub body: BodyValues,
    /// Other bodies of the link, without mass and inertia.
    pub emptied: Vec<BodyValues>,
    /// Part of the link's inertial parameters that comes from rotors of held joints, not from bodies.
    pub fixed: Vec<f64>,
}

impl LinkBodies {
    /// Returns the tables `[[bodies]]` of the description as TOML.
    pub fn toml(&self) -> impl Iterator<Item = String> + '_ {
        std::iter::once(&self.body).chain(&self.emptied).map(BodyValues::toml)
    }
}

/// Returns bodies that give the moving links of a description the inertial parameters `parameters`. These
/// are ten for each link, in the order of the moving joints.
///
/// All bodies that are fixed to a moving link, directly or by held joints, are one rigid body in the
/// equations of motion. The first body of the link gets all parameters, and the other bodies become
/// massless.
///
/// # Errors
/// The errors are those of [`InterpretedRobot::new`](super::InterpretedRobot::new).
pub fn bodies(model: &Model, parameters: &[f64]) -> Result<Vec<LinkBodies>, Diagnostics> {
    let mut bare = model.clone();
    bare.links.iter_mut().for_each(|link| link.bodies.clear());
    let [fixed] = derive(&bare, ["inertial_parameters"])?;
    let fixed = result(&fixed, &[], &free(&bare));
    let carriers: Vec<Option<usize>> = (0..model.links.len()).map(|link| carrier(model, link)).collect();
    let links = parameters.chunks_exact(PER_LINK).zip(fixed.chunks_exact(PER_LINK)).enumerate();
    let carrying_joints = model.carrying_joints();
    let of_joint = |(place, (all, fixed)): (usize, (&[f64], &[f64]))| {
        let joint = carrying_joints[place].index;
        let own: Vec<f64> = all.iter().zip(fixed).map(|(all, fixed)| all - fixed).collect();
        let moving = &model.links[carrying_joints[place].moving.link];
        let first = moving.bodies.first().map_or(&moving.name, |body| &body.name).clone();
        let link = (first != moving.name).then(|| moving.name.clone());
        let carried = (0..model.links.len()).filter(|link| carriers[*link] == Some(joint));
        let described = carried.flat_map(|link| model.links[link].bodies.iter());
        let emptied = described.filter(|body| body.name != first).map(|body| BodyValues {
            name: body.name.clone(),
            link: None,
            mass: 0.0,
            center_of_mass: [0.0; 3],
            inertia: [0.0; 6],
        });
        let emptied: Vec<BodyValues> = emptied.collect();
        LinkBodies { body: BodyValues::of_link(first, link, &own), emptied, fixed: fixed.to_vec() }
    };
    Ok(links.map(of_joint).collect())
}

/// Returns the index of the moving joint that carries a link; `None` for links on the base.
fn carrier(model: &Model, link: usize) -> Option<usize> {
    let joint = model.links[link].joint.as_ref()?;
    match joint.motion {
        Motion::Coordinate(joint) | Motion::Follower(joint) => Some(joint),
        Motion::Fixed | Motion::Held(_) => carrier(model, joint.parent),
    }
}
