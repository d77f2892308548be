//! Motor constants that logs of currents give.

use gelenk_identification::estimation::Uncertain;
use gelenk_identification::identify::Identification;
use gelenk_identification::numeric::digits::{plain, rounded};
use serde_json::{Value, json};

use crate::model::{Drive, Input, Model};
use gelenk_findings::{Finding, Rule};

/// Sees: motor constants that logs of currents give.
/// Matters: they are right if the described masses are.
/// Example: 0.12 N·m/A.
/// Fixture: `codegen/tests/external_arm/main.rs`.
const ESTIMATED: Rule = Rule::note("motor-constant");

/// Sees: a motor constant that is negative, far from the described one, or none that motors have.
/// Matters: the current is in another unit, or the masses are described wrong.
/// Example: 300 N·m/A.
/// Fixture: `codegen/tests/external_arm/units.rs`.
const DOUBTFUL_CONSTANT: Rule = Rule::warning("motor-constant-doubtful");

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

/// Motor constants with their intervals.
pub(super) fn findings(model: &Model, found: &Identification) -> Vec<Finding> {
    let level = 100.0 * found.estimate.confidence;
    let joints = found.estimate.joints.iter().enumerate().filter(|(_, joint)| joint.moves);
    let finding = |(index, joint): (usize, &gelenk_identification::estimation::JointEstimate)| {
        let Uncertain { value, interval: [low, high], .. } = of_joint(model, found, index)?;
        let (name, error) = (&joint.name, Some(0.5 * (high - low)));
        let [value, low, high] = [value, low, high].map(|x| rounded(x, error));
        let message = format!(
            "its motor constant is {value} N·m/A, {level:.0} % interval {low} to {high}, if the described masses and centres are right"
        );
        Some(ESTIMATED.found(message).joint(name))
    };
    joints.filter_map(finding).collect()
}

/// Ratio to the described constant beyond which one of them is doubted.
const DOUBTFUL: f64 = 2.0;
/// Constants that motors of turning joints have, with gears that the description does not have [N m/A].
const USUAL: [f64; 2] = [1e-3, 100.0];

/// Adds doubts about motor constants to the warnings of an estimate: those that are far from the described ones, and where
/// none is described, those that no motor has.
pub(super) fn add_doubts(model: &Model, found: &mut Identification) {
    let joints = 0..found.estimate.joints.len();
    let doubts: Vec<Finding> = joints.filter_map(|joint| doubt(model, found, joint)).collect();
    found.estimate.findings.extend(doubts);
}

fn doubt(model: &Model, found: &Identification, joint: usize) -> Option<Finding> {
    let estimate = &found.estimate.joints[joint];
    let constant = of_joint(model, found, joint).filter(|_| estimate.moves)?;
    let Uncertain { value, interval: [low, high], .. } = constant;
    let said = |doubt: String| {
        let message = format!("its motor constant of {} N·m/A {doubt}", plain(value, 4));
        Some(DOUBTFUL_CONSTANT.found(message).joint(&estimate.name).with("motor constant", value, "N·m/A"))
    };
    // That it is not known at all, the estimate says.
    if low <= 0.0 && high >= 0.0 {
        return None;
    }
    if value < 0.0 {
        return said("is negative: current and position count in opposite directions".to_owned());
    }
    let drive = model.input_drives().find(|drive| drive.coordinate() == Some(joint))?;
    match &drive.input {
        Input::Current(_) => {
            let described = described(model, drive);
            let ratio = value / described;
            let is_close = (1.0 / DOUBTFUL..=DOUBTFUL).contains(&ratio);
            let described = plain(described, 4);
            (!is_close).then(|| said(format!(
                "is {} times the described one of {described}. More than a factor of {DOUBTFUL} says that the constant, the gear, the \
                 masses or the unit of the current are described wrong", plain(ratio, 3)
            )))?
        }
        _ if estimate.unit == "N·m" && !(USUAL[0]..=USUAL[1]).contains(&value) => said(format!(
            "is none that motors have ({} to {}): is the current in another unit, as in --columns 'current=…[mA]'? The \
             gear or the masses may be described wrong, too",
            USUAL[0], USUAL[1]
        )),
        _ => None,
    }
}

/// The motor constant of a joint for programs.
pub(super) fn as_json(model: &Model, found: &Identification, joint: usize) -> Value {
    let constant = of_joint(model, found, joint);
    constant.map_or(
        Value::Null,
        |p| json!({"value": p.value, "standard_error": p.standard_error, "interval": p.interval}),
    )
}
