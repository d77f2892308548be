//! Drives that act on several joints: their shafts, whose friction is identified, and their tables in a
//! description.

use gelenk_identification::result::FrictionResult;
use gelenk_identification::result::description::{comment_lines, friction_value};
use gelenk_identification::shafts::{JointTerm, Shaft};

use super::drives::{entries, found_rotor, joint_friction};
use super::seats::seats;
use super::words::{number, text, weighted};
use crate::dynamics::parameters::regressor::drives_with_rotor;
use crate::model::{Drive, FrictionTerm, Model};
use crate::wording::toml_text;

/// Returns the drives on several coordinates whose shafts replace joints in the fit
/// ([`gelenk_identification::shafts`]).
///
/// - `unmeasured`: names of the joints that are moved from outside
pub(super) fn shafts(model: &Model, unmeasured: &[String], free: &[f64]) -> Vec<Shaft> {
    let shared: Vec<&Drive> = shared_drives(model).collect();
    let ratios: Vec<Vec<f64>> = shared.iter().map(|drive| ratios(model, drive, free)).collect();
    let mut may = vec![true; model.coordinates.len()];
    for drive in model.input_drives().filter(|drive| drive.acts_on.len() == 1) {
        drive.acts_on.iter().for_each(|only| may[only.coordinate] = false);
    }
    model.quaternion_joints.iter().flat_map(|joint| joint.coordinates()).for_each(|row| may[row] = false);
    let moved = model.joints().zip(&mut may).filter(|(joint, _)| unmeasured.contains(&joint.name));
    moved.for_each(|(_, may)| *may = false);
    let seats = seats(&ratios, &may);
    let shaft = |((drive, ratios), joint): ((&Drive, Vec<f64>), Option<usize>)| {
        let torque = drive.torque.peak.or(drive.torque.nominal).unwrap_or(f64::INFINITY);
        Some(Shaft { name: drive.name.clone(), joint: joint?, ratios, torque })
    };
    shared.into_iter().zip(ratios).zip(seats).filter_map(shaft).collect()
}

/// Returns the drives with an input that act on several coordinates.
pub(super) fn shared_drives(model: &Model) -> impl Iterator<Item = &Drive> {
    model.input_drives().filter(|drive| drive.acts_on.len() > 1)
}

/// Returns the angle of a drive's shaft for a unit displacement of each coordinate.
fn ratios(model: &Model, drive: &Drive, free: &[f64]) -> Vec<f64> {
    let gear = drive.gear_ratio.evaluate(free, 0.0, 0.0);
    let mut ratios = vec![0.0; model.coordinates.len()];
    for moved in &drive.acts_on {
        ratios[moved.coordinate] += gear * moved.ratio.evaluate(free, 0.0, 0.0);
    }
    ratios
}

/// Returns the terms of the described friction of the joints whose equations in the fit are replaced by those
/// of shafts.
pub(super) fn joint_terms(model: &Model, shafts: &[Shaft], free: &[f64]) -> Vec<(JointTerm, FrictionTerm)> {
    let names: Vec<&str> = model.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
    let taken = model.joints().enumerate().filter(|(row, _)| shafts.iter().any(|shaft| shaft.joint == *row));
    let term = |joint: usize, term: &FrictionTerm| {
        let coefficient = term.coefficient.evaluate(free, 0.0, 0.0);
        (JointTerm { joint, basis: term.basis.text(&names), coefficient }, term.clone())
    };
    taken.flat_map(|(row, joint)| joint.friction.iter().map(move |of_joint| term(row, of_joint))).collect()
}

/// Returns tables `[[joints]]` with friction terms, whose coefficients are scaled by the estimated factors.
#[must_use]
pub fn joint_tables(model: &Model, terms: &[(&JointTerm, f64)]) -> Vec<String> {
    let joints = model.joints().enumerate();
    let table = |(row, joint): (usize, &crate::model::Joint)| {
        let own = terms.iter().filter(|(term, _)| term.joint == row);
        let pairs = own.map(|(term, factor)| format!("[{}, {}]", toml_text(&term.basis), number(*factor)));
        let pairs: Vec<String> = pairs.collect();
        (!pairs.is_empty()).then(|| {
            let name = toml_text(&joint.name);
            format!("[[joints]]\nname = {name}\nfriction = {{ terms = [{}] }}\n", pairs.join(", "))
        })
    };
    joints.filter_map(table).collect()
}

/// Returns the table `[[joints]]` with the described friction of the joint that a drive moves; `None` if
/// there is no friction. Friction at the drive is included, because it would be lost if the drive is
/// replaced.
#[must_use]
pub fn kept_friction(model: &Model, described: &Model, drive: &Drive) -> Option<String> {
    let joint = model.joints().nth(drive.coordinate()?)?;
    let friction = joint_friction(described, &joint.name)?;
    Some(format!("[[joints]]\nname = {}\n{friction}\n", toml_text(&joint.name)))
}

/// Identified values of a drive that has its own table in the description.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct IdentifiedShaft<'a> {
    /// Name of the drive in the description.
    pub name: &'a str,
    /// Friction of the shaft; `None` keeps the friction of the description. If the shaft moves only one
    /// joint, its friction is part of the joint's friction.
    pub friction: Option<&'a FrictionResult>,
    /// Inertia of the rotor about its axis in kg m², as a parameter of the equations of motion; `None` if the
    /// description has no rotor.
    pub rotor: Option<f64>,
    /// Inertia that is added at the shaft, in kg m²; `None` if the description has a rotor.
    pub added: Option<f64>,
    /// Motor constant K_M in N m/A; `None` if it was not identified.
    pub motor_constant: Option<f64>,
}

/// Returns the index of a drive's rotor among the rotor parameters; `None` if the drive has no rotor.
#[must_use]
pub fn shaft_rotor(model: &Model, name: &str) -> Option<usize> {
    drives_with_rotor(model).position(|drive| drive.name == name)
}

/// Returns the table `[[drives]]` of an identified drive, including all other keys of its description;
/// `None` if the description has no table for this drive.
///
/// - `described`: model with the friction of the description
///
/// # Errors
/// [`IdentificationError`](gelenk_identification::IdentificationError) if a description cannot express the
/// friction law.
pub fn drive_table(
    described: &Model,
    found: &IdentifiedShaft,
) -> gelenk_identification::Result<Option<String>> {
    let is_meant = |drive: &&Drive| drive.stands_apart && drive.name == found.name;
    let Some(drive) = described.input_drives().find(is_meant) else { return Ok(None) };
    let names: Vec<&str> = described.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
    let joints: Vec<&str> =
        described.joints().chain(described.driven_joints()).map(|joint| joint.name.as_str()).collect();
    let on = drive.acts_on.iter().filter_map(|moved| {
        Some(format!("{} = {}", toml_text(joints.get(moved.coordinate)?), text(&moved.ratio, &names)))
    });
    let on: Vec<String> = on.collect();
    let (inertia, coupling) = found_rotor(drive, found.rotor, found.added);
    let mut lines = entries(described, drive, inertia, coupling, found.motor_constant);
    lines.insert(1, format!("on = {{ {} }}", on.join(", ")));
    let friction = match found.friction {
        Some(result) => Some(friction_value(result)?),
        None => (!drive.friction.is_empty())
            .then(|| format!("{{ terms = {} }}", weighted(&drive.friction, &names))),
    };
    lines.extend(friction.map(|friction| format!("friction = {friction}")));
    let comments = found.friction.map(comment_lines).unwrap_or_default();
    Ok(Some(format!("[[drives]]\n{comments}{}\n", lines.join("\n"))))
}
