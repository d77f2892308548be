//! Identified drives as a description writes them.

use super::bodies::number;
use crate::dynamics::parameters::regressor::drives_with_rotor;
use crate::formula::Formula;
use crate::model::{Drive, Input, Model, RotorCoupling};
use crate::wording::toml_text;

/// What was identified of the drive of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct IdentifiedDrive {
    /// Axial inertia of the rotor [kg m²], where the description has one.
    pub rotor: Option<f64>,
    /// Inertia that the drive adds to its joint [kg m²], where the description has no rotor.
    pub reflected: Option<f64>,
    /// Motor constant K_M [N m/A].
    pub motor_constant: Option<f64>,
}

/// The value of the key `drive` of each joint whose drive was identified, by the joint's name. Drives that are described by
/// themselves are [`super::drive_table`]'s.
///
/// - `identified`: by coordinate
#[must_use]
pub fn drives(model: &Model, identified: &[IdentifiedDrive]) -> Vec<(String, String)> {
    let written = model.input_drives().filter_map(|drive| {
        let coordinate = drive.coordinate().filter(|_| !drive.stands_apart)?;
        let found = identified.get(coordinate).filter(|found| **found != IdentifiedDrive::default())?;
        let joint = model.joints().nth(coordinate)?;
        Some((joint.name.clone(), toml(model, drive, found)))
    });
    written.collect()
}

/// For each coordinate, the place of its rotor among the parameters of rotors.
#[must_use]
pub fn rotors(model: &Model) -> Vec<Option<usize>> {
    let place =
        |coordinate| drives_with_rotor(model).position(|drive| drive.coordinate() == Some(coordinate));
    (0..model.coordinates.len()).map(place).collect()
}

fn toml(model: &Model, drive: &Drive, found: &IdentifiedDrive) -> String {
    let coupling = if found.reflected.is_some() { RotorCoupling::Diagonal } else { drive.coupling };
    let inertia = found.rotor.or(found.reflected);
    format!("{{ {} }}", entries(model, drive, (inertia, coupling), found.motor_constant).join(", "))
}

/// Keys of a drive with their values, without those of its friction and of what it acts on.
///
/// - `inertia`: identified inertia of the rotor, and how it counts
pub(super) fn entries(
    model: &Model,
    drive: &Drive,
    (inertia, coupling): (Option<f64>, RotorCoupling),
    motor_constant: Option<f64>,
) -> Vec<String> {
    let names: Vec<&str> = model.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
    let formula = |described: &Formula| text(described, &names);
    let inertia = inertia.map_or_else(|| formula(&drive.rotor_inertia), number);
    let mut entries = vec![
        format!("name = {}", toml_text(&drive.name)),
        format!("gear_ratio = {}", formula(&drive.gear_ratio)),
        format!("rotor_inertia = {inertia}"),
    ];
    match coupling {
        RotorCoupling::Diagonal => entries.push("coupling = \"diagonal\"".to_owned()),
        RotorCoupling::Body => entries.extend(mounting(model, drive)),
    }
    entries.extend(torques(drive));
    let described = match &drive.input {
        Input::Torque | Input::None => None,
        Input::Current(constant) => Some(formula(constant)),
    };
    let constant = motor_constant.map(number).or(described);
    entries.extend(constant.map(|constant| format!("motor_constant = {constant}")));
    entries
}

/// Where a rotor sits.
fn mounting(model: &Model, drive: &Drive) -> [String; 2] {
    let [x, y, z] = drive.axis.map(|x| format!("{x:?}"));
    [format!("carrier = {}", toml_text(&model.links[drive.carrier].name)), format!("axis = [{x}, {y}, {z}]")]
}

fn torques(drive: &Drive) -> Option<String> {
    let torques = [("nominal", drive.torque.nominal), ("peak", drive.torque.peak)];
    let known = torques.iter().filter_map(|(name, value)| Some(format!("{name} = {:?}", (*value)?)));
    let known: Vec<String> = known.collect();
    (!known.is_empty()).then(|| format!("torque = {{ {} }}", known.join(", ")))
}

/// A number as it is, a formula in quotes.
pub(super) fn text(formula: &Formula, parameters: &[&str]) -> String {
    let text = formula.text(parameters);
    match text.parse::<f64>() {
        Ok(value) => format!("{value:?}"),
        Err(_) => toml_text(&text),
    }
}
