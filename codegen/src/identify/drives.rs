//! Identified drives as TOML of a description.

use super::words::{number, text, weighted};
use crate::dynamics::parameters::regressor::drives_with_rotor;
use crate::model::{Drive, Input, Model, RotorCoupling};
use crate::wording::toml_text;
use gelenk_formula::Formula;

/// Identified values of a joint's drive.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct IdentifiedDrive {
    /// Inertia of the rotor about its axis in kg m²; `None` if the equations of motion have no parameter for
    /// this rotor.
    pub rotor: Option<f64>,
    /// Inertia that the drive adds to its joint (reflected inertia), in kg m² or kg; `None` if the description
    /// has a rotor or a gear.
    pub reflected: Option<f64>,
    /// Motor constant K_M in N m/A; `None` if it was not identified.
    pub motor_constant: Option<f64>,
}

/// Returns the rotor inertia J_R of an identified drive in kg m², and how it enters the mass matrix.
///
/// - `rotor`: inertia as a parameter of the equations. Every drive with a gear or a described rotor has
///   this parameter.
/// - `added`: inertia that was found for a drive without a gear and without a rotor. It does not belong to
///   a body that turns with a carrier, so it enters only the diagonal.
pub(super) fn found_rotor(
    drive: &Drive,
    rotor: Option<f64>,
    added: Option<f64>,
) -> (Option<f64>, RotorCoupling) {
    let coupling = if rotor.is_none() && added.is_some() { RotorCoupling::Diagonal } else { drive.coupling };
    (rotor.or(added), coupling)
}

/// Returns lines of TOML for each joint whose drive was identified, with the joint's name. The first line
/// is the key `drive`. If no friction law of the joint was found, the key `friction` of the description
/// follows. Otherwise friction at the drive would be lost. Drives in the table `[[drives]]` are written by
/// [`super::drive_table`].
///
/// - `model`: model of the identified robot
/// - `described`: model with the friction of the description
/// - `identified`: identified values of each coordinate's drive
/// - `has_law`: for each coordinate, whether a friction law was found
#[must_use]
pub fn drives(
    model: &Model,
    described: &Model,
    identified: &[IdentifiedDrive],
    has_law: &[bool],
) -> Vec<(String, String)> {
    let written = model.input_drives().filter_map(|drive| {
        let coordinate = drive.coordinate().filter(|_| !drive.stands_apart)?;
        let found = identified.get(coordinate).filter(|found| **found != IdentifiedDrive::default())?;
        let joint = model.joints().nth(coordinate)?;
        let (inertia, coupling) = found_rotor(drive, found.rotor, found.reflected);
        let keys = entries(model, drive, inertia, coupling, found.motor_constant).join(", ");
        let friction = (!has_law[coordinate]).then(|| joint_friction(described, &joint.name)).flatten();
        let lines = std::iter::once(format!("drive = {{ {keys} }}"));
        Some((joint.name.clone(), lines.chain(friction).collect::<Vec<_>>().join("\n")))
    });
    written.collect()
}

/// Returns the key `friction` of a joint as in the description, including friction at the shaft of its
/// drive; `None` if there is no friction.
pub(super) fn joint_friction(described: &Model, name: &str) -> Option<String> {
    let joint = described.joints().find(|joint| joint.name == name)?;
    let names: Vec<&str> = described.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
    let load = (!joint.load_friction.is_empty())
        .then(|| format!("load = {}", weighted(&joint.load_friction, &names)));
    let terms =
        (!joint.friction.is_empty()).then(|| format!("terms = {}", weighted(&joint.friction, &names)));
    let keys: Vec<String> = terms.into_iter().chain(load).collect();
    (!keys.is_empty()).then(|| format!("friction = {{ {} }}", keys.join(", ")))
}

/// Returns for each coordinate the index of its drive's rotor among the rotor parameters; `None` if there
/// is no rotor.
#[must_use]
pub fn rotors(model: &Model) -> Vec<Option<usize>> {
    let place = |coordinate| {
        let mut drives = drives_with_rotor(model);
        drives.position(|drive| drive.coordinate() == Some(coordinate) && drive.input != Input::None)
    };
    (0..model.coordinates.len()).map(place).collect()
}

/// Returns the keys of a drive with their values, except friction and the joints on which the drive acts.
///
/// - `inertia`: inertia of the rotor in kg m²; `None` keeps the described inertia
/// - `coupling`: how the inertia enters the mass matrix
pub(super) fn entries(
    model: &Model,
    drive: &Drive,
    inertia: Option<f64>,
    coupling: RotorCoupling,
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
    entries.extend(drive.speed.map(|speed| format!("speed = {speed:?}")));
    entries.extend(drive.line.iter().flat_map(|line| {
        let (torque, speed) = (line.stall_torque, line.no_load_speed);
        [format!("stall_torque = {torque:?}"), format!("no_load_speed = {speed:?}")]
    }));
    let described = match &drive.input {
        Input::Torque | Input::None => None,
        Input::Current(constant) => Some(formula(constant)),
    };
    let constant = motor_constant.map(number).or(described);
    entries.extend(constant.map(|constant| format!("motor_constant = {constant}")));
    entries
}

/// Returns the keys that describe how a rotor is mounted: carrier and axis.
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
