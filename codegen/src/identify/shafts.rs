//! Drives that act on several joints: their shafts, whose friction is identified, and their tables in a
//! description.

use gelenk_identification::shafts::{JointTerm, Shaft};

use super::seats::seats;
use super::words::number;
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

/// Returns the index of a drive's rotor among the rotor parameters; `None` if the drive has no rotor.
#[must_use]
pub fn shaft_rotor(model: &Model, name: &str) -> Option<usize> {
    drives_with_rotor(model).position(|drive| drive.name == name)
}
