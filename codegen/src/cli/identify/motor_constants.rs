//! Motor constants that logs of currents give.

use gelenk_identification::estimation::Uncertain;
use gelenk_identification::identify::Identification;
use serde_json::{Value, json};

use crate::model::{Drive, Input, Model};

/// The motor constant of a drive [N m/A].
///
/// - `gain`: as estimated, of the described input: one of a described current is right where this is one
pub(super) fn motor_constant(model: &Model, drive: &Drive, gain: f64) -> f64 {
    described(model, drive) * gain
}

/// Motor constant by which currents are forces already; one where the input is described as a torque.
fn described(model: &Model, drive: &Drive) -> f64 {
    let free: Vec<f64> = model.parameters.iter().map(|parameter| parameter.default).collect();
    match &drive.input {
        Input::Current(constant) => constant.value(&free).unwrap_or(1.0),
        _ => 1.0,
    }
}

/// The motor constant of a joint with its interval, where it was estimated.
fn of_joint(model: &Model, found: &Identification, joint: usize) -> Option<Uncertain> {
    let Uncertain { value, standard_error, interval } = found.estimate.joints[joint].gain?;
    let drive = model.input_drives().find(|drive| drive.coordinate() == Some(joint));
    let factor = drive.map_or(1.0, |drive| described(model, drive));
    Some(Uncertain {
        value: factor * value,
        standard_error: factor.abs() * standard_error,
        interval: interval.map(|end| factor * end),
    })
}

/// What was found, as sentences.
pub(super) fn sentences(model: &Model, found: &Identification) -> Vec<String> {
    let level = 100.0 * found.estimate.confidence;
    let joints = found.estimate.joints.iter().enumerate().filter(|(_, joint)| joint.moves);
    let sentence = |(index, joint): (usize, &gelenk_identification::estimation::JointEstimate)| {
        let Uncertain { value, interval: [low, high], .. } = of_joint(model, found, index)?;
        let name = &joint.name;
        Some(format!(
            "{name}: motor constant {value:.4} N·m/A, {level:.0} % interval {low:.4} to {high:.4}, where the described masses and centres are right"
        ))
    };
    joints.filter_map(sentence).collect()
}

/// The motor constant of a joint for programs.
pub(super) fn as_json(model: &Model, found: &Identification, joint: usize) -> Value {
    let constant = of_joint(model, found, joint);
    constant.map_or(
        Value::Null,
        |p| json!({"value": p.value, "standard_error": p.standard_error, "interval": p.interval}),
    )
}
