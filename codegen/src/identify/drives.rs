//! Identified drives as TOML of a description.

use super::words::{number, text, weighted};
use crate::model::{Drive, Input, Joint, Model, RotorCoupling};
use crate::wording::toml_text;
use gelenk_formula::Formula;
use gelenk_identification::result::FrictionResult;
use gelenk_identification::result::description::{comment_lines, friction_value};

/// Identified values of a drive.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct IdentifiedDrive<'a> {
    /// Friction of the shaft; `None` keeps the friction of the description. If the shaft moves only one
    /// joint, its friction is part of the joint's friction.
    pub friction: Option<&'a FrictionResult>,
    /// Inertia of the rotor about its axis in kg m²; `None` if the equations of motion have no parameter for
    /// this rotor.
    pub rotor: Option<f64>,
    /// Inertia that is added at the shaft or the joint, in kg m² or kg; `None` if the description has a rotor
    /// or a gear.
    pub added: Option<f64>,
    /// Motor constant K_M in N m/A; `None` if it was not identified.
    pub motor_constant: Option<f64>,
}

/// Identified drives as TOML of a description.
#[derive(Debug, Default)]
pub struct WrittenDrives {
    /// Lines with the key `drive`, with the name of the joint that has this key.
    pub of_joints: Vec<(String, String)>,
    /// Tables `[[drives]]`.
    pub tables: Vec<String>,
}

/// Returns all drives with identified values as TOML. If no friction law of a drive's joint was found, the
/// described friction of the joint follows. Otherwise friction at the drive would be lost.
///
/// - `model`: model of the identified robot
/// - `described`: model with the friction of the description
/// - `identified`: returns the identified values of a drive, and whether a friction law of its joint was found
///
/// # Errors
/// [`IdentificationError`](gelenk_identification::IdentificationError) if a description cannot express a
/// friction law.
pub fn write_drives<'a>(
    model: &'a Model,
    described: &Model,
    identified: impl Fn(&'a Drive) -> (IdentifiedDrive<'a>, bool),
) -> gelenk_identification::Result<WrittenDrives> {
    let mut written = WrittenDrives::default();
    for drive in model.input_drives() {
        let (found, has_law) = identified(drive);
        if found == IdentifiedDrive::default() {
            continue;
        }
        let joint = drive.coordinate().and_then(|coordinate| model.joints().nth(coordinate));
        let kept = joint.filter(|_| !has_law).and_then(|joint| joint_friction(described, &joint.name));
        if drive.stands_apart {
            written.tables.extend(drive_table(described, &drive.name, &found)?);
            let table = |(joint, friction): (&Joint, String)| {
                format!("[[joints]]\nname = {}\n{friction}\n", toml_text(&joint.name))
            };
            written.tables.extend(joint.zip(kept).map(table));
        } else if let Some(joint) = joint {
            let key = format!("drive = {{ {} }}", entries(model, drive, &found).join(", "));
            let lines: Vec<String> = std::iter::once(key).chain(kept).collect();
            written.of_joints.push((joint.name.clone(), lines.join("\n")));
        }
    }
    Ok(written)
}

/// Returns the table `[[drives]]` of an identified drive, including all other keys of its description;
/// `None` if the description has no table for this drive.
///
/// - `described`: model with the friction of the description
fn drive_table(
    described: &Model,
    name: &str,
    found: &IdentifiedDrive<'_>,
) -> gelenk_identification::Result<Option<String>> {
    let is_meant = |drive: &&Drive| drive.stands_apart && drive.name == name;
    let Some(drive) = described.input_drives().find(is_meant) else { return Ok(None) };
    let names: Vec<&str> = described.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
    let joints: Vec<&str> =
        described.joints().chain(described.driven_joints()).map(|joint| joint.name.as_str()).collect();
    let on = drive.acts_on.iter().filter_map(|moved| {
        Some(format!("{} = {}", toml_text(joints.get(moved.coordinate)?), text(&moved.ratio, &names)))
    });
    let on: Vec<String> = on.collect();
    let mut lines = entries(described, drive, found);
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

/// Returns the key `friction` of a joint as in the description, including friction at the shaft of its
/// drive; `None` if there is no friction.
fn joint_friction(described: &Model, name: &str) -> Option<String> {
    let joint = described.joints().find(|joint| joint.name == name)?;
    let names: Vec<&str> = described.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
    let load = (!joint.load_friction.is_empty())
        .then(|| format!("load = {}", weighted(&joint.load_friction, &names)));
    let terms =
        (!joint.friction.is_empty()).then(|| format!("terms = {}", weighted(&joint.friction, &names)));
    let keys: Vec<String> = terms.into_iter().chain(load).collect();
    (!keys.is_empty()).then(|| format!("friction = {{ {} }}", keys.join(", ")))
}

/// Returns the keys of a drive with their values, except friction and the joints on which the drive acts. An
/// inertia that was found for a drive without a gear and without a rotor does not belong to a body that
/// turns with a carrier, so it enters only the diagonal of the mass matrix.
fn entries(model: &Model, drive: &Drive, found: &IdentifiedDrive<'_>) -> Vec<String> {
    let names: Vec<&str> = model.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
    let formula = |described: &Formula| text(described, &names);
    let inertia = found.rotor.or(found.added).map_or_else(|| formula(&drive.rotor_inertia), number);
    let is_added = found.rotor.is_none() && found.added.is_some();
    let mut entries = vec![
        format!("name = {}", toml_text(&drive.name)),
        format!("gear_ratio = {}", formula(&drive.gear_ratio)),
        format!("rotor_inertia = {inertia}"),
    ];
    match drive.coupling {
        RotorCoupling::Body if !is_added => entries.extend(mounting(model, drive)),
        _ => entries.push("coupling = \"diagonal\"".to_owned()),
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
    let constant = found.motor_constant.map(number).or(described);
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
