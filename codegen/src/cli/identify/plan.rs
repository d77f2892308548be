//! The command `gelenk identify --plan`, which plans a motion to record.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use gelenk_files::write_whole;
use gelenk_findings::{Severity, texts};
use gelenk_identification::excitation::{Excitation, Plan, PlanSettings, plan};
use gelenk_identification::robot::Robot;
use serde_json::{Value, json};

use super::super::arguments::{Format, Identify};
use super::super::failure::Failure;
use super::super::{place, print};
use super::read::{read, say};
use crate::identify::InterpretedRobot;
use crate::wording::{as_written, three_digits};

/// Largest number of rows of a planned motion.
const MOST_ROWS: f64 = 1e6;

/// Searches a motion that excites the parameters to be identified, and writes it as CSV.
pub(super) fn write(arguments: &Identify, format: Format) -> Result<ExitCode, Failure> {
    if arguments.seconds * arguments.rate > MOST_ROWS {
        return Err(Failure::Usage(format!(
            "the plan would have more than {MOST_ROWS} rows: use a smaller --rate or --seconds"
        )));
    }
    let (loaded, robot) = read(arguments)?;
    let default = PlanSettings::default();
    let settings = PlanSettings {
        excitation: Excitation {
            period: arguments.seconds,
            harmonics: usize::from(arguments.harmonics),
            seed: arguments.seed,
            ..default.excitation
        },
        position_share: arguments.position_share,
        velocity_share: arguments.speed_share,
        effort_share: arguments.effort_share,
        acceleration: arguments.acceleration,
        turn: arguments.turn,
        start: arguments.start.as_deref().map(|text| posture(text, &robot.joint_names())).transpose()?,
        ..default
    };
    let path = arguments.output.clone().unwrap_or_else(|| PathBuf::from("plan.csv"));
    require_plan_or_nothing(&path, &Plan::header(&robot))?;
    place::require_writable(&path, loaded.files.iter())?;
    let found = print::identified(plan(&robot, &settings, &mut say))?;
    let text = found.csv(&robot, 1.0 / arguments.rate, 1);
    write_whole(&path, text).map_err(|error| Failure::Problem(format!("{}: {error}", path.display())))?;
    print::result(format, || as_json(&found, &robot, &path), || as_text(&found, &robot, &path))
}

/// Parses the positions of all joints from `joint=position,…`.
fn posture(text: &str, names: &[String]) -> Result<Vec<f64>, Failure> {
    let fault = |message: String| Failure::Usage(format!("--start '{text}': {message}"));
    let mut positions = vec![None; names.len()];
    for part in text.split(',').map(str::trim).filter(|part| !part.is_empty()) {
        let (name, value) = part
            .split_once('=')
            .ok_or_else(|| fault(format!("'{part}' does not have the form JOINT=POSITION")))?;
        let place = names.iter().position(|joint| joint == name.trim());
        let place = place.ok_or_else(|| {
            fault(format!("there is no joint '{}'. The joints are {}", name.trim(), names.join(", ")))
        })?;
        let value: Option<f64> = value.trim().parse().ok().filter(|value: &f64| value.is_finite());
        let value = value.ok_or_else(|| fault(format!("'{part}' needs a number in rad or m after `=`")))?;
        if positions[place].replace(value).is_some() {
            return Err(fault(format!("joint {} is given twice: remove one of its positions", name.trim())));
        }
    }
    let without = names.iter().zip(&positions).filter(|(_, position)| position.is_none());
    let without: Vec<&str> = without.map(|(name, _)| name.as_str()).collect();
    match without.as_slice() {
        [] => Ok(positions.into_iter().flatten().collect()),
        missing => Err(fault(format!(
            "a position for each joint is needed: add the positions of {}",
            missing.join(", ")
        ))),
    }
}

/// Returns a sentence about how the robot reaches the beginning of the motion.
fn beginning(plan: &Plan, robot: &InterpretedRobot) -> String {
    let [start, ..] = plan.motion.instant(0.0);
    let joints = robot.joint_names();
    let listed = joints.iter().zip(&start).map(|(name, y)| format!("{name}={y:.4}"));
    let turns = match robot.quaternion_joints().is_empty() {
        true => "",
        false => {
            " (for a joint with a quaternion: the position of its origin if it translates, and the rotation vector)"
        }
    };
    let listed = format!("{}{turns}", listed.collect::<Vec<_>>().join(","));
    match &plan.approach {
        Some(approach) => format!(
            "in the first {:.2} s, the robot moves in joint space straight from the given start to the start of the motion: {listed}\n",
            approach.seconds
        ),
        None => format!("the motion begins at {listed}. Move the robot there first, or give --start\n"),
    }
}

/// Fails if the file exists and is not a plan, so that no log is overwritten.
fn require_plan_or_nothing(path: &Path, header: &str) -> Result<(), Failure> {
    match fs::read(path) {
        Ok(found) if !found.is_empty() && !found.starts_with(header.as_bytes()) => {
            let message =
                "is not a plan for this robot. Name another file with --output, or remove this file first";
            Err(Failure::Problem(format!("{} {message}", path.display())))
        }
        // If the file cannot be read, writing it fails later.
        _ => Ok(()),
    }
}

fn as_text(plan: &Plan, robot: &InterpretedRobot, path: &Path) -> String {
    let [inertial, friction] = plan.parameters;
    let mut text = format!(
        "wrote {}: {} s from rest to rest, for {inertial} base parameters and {friction} friction parameters\n\
         condition number of their equations, with columns of unit length: {:.0}\n",
        path.display(),
        plan.motion.period,
        plan.condition,
    );
    text.push_str(&beginning(plan, robot));
    let [speeds, efforts] = &plan.largest;
    let what = if plan.shafts.is_empty() { "joint" } else { "joint or shaft" };
    let head = [what, "largest speed", "largest effort", "described limit"];
    let row = |name: String, [speed, effort]: [f64; 2], limit: f64, [unit, force]: [&str; 2]| {
        let [speed, effort] = [speed, effort].map(three_digits);
        let limit = if limit.is_finite() { format!("{limit} {force}") } else { "none".to_owned() };
        vec![name, format!("{speed} {unit}/s"), format!("{effort} {force}"), limit]
    };
    let shafts = plan.shafts.iter();
    let shafts =
        shafts.map(|shaft| row(shaft.name.clone(), [shaft.speed, shaft.torque], shaft.limit, ["rad", "N m"]));
    let joints = robot.joint_names().into_iter().zip(robot.position_units()).zip(robot.limits());
    let rows = joints.enumerate().map(|(i, ((name, unit), limits))| {
        let force = if unit == "m" { "N" } else { "N m" };
        row(name, [speeds[i], efforts[i]], limits.effort, [unit, force])
    });
    text.push('\n');
    text.push_str(&print::headed(&head, rows.chain(shafts)));
    text.push('\n');
    text.push_str(&inputs_text(plan, robot));
    text.push_str(&print::lines(&plan.findings));
    text.push_str(
        "note: the plan ignores obstacles and collisions of links. Check the motion before the robot executes it\n",
    );
    text
}

/// Returns a table with the ranges of the inputs along the motion; empty if no input acts at a frame.
fn inputs_text(plan: &Plan, robot: &InterpretedRobot) -> String {
    if plan.inputs.is_empty() {
        return String::new();
    }
    let head = ["input", "lowest", "highest", "described limits"];
    let model = robot.model();
    let rows = plan.inputs.iter().zip(model.inputs()).map(|(input, described)| {
        let (unit, [low, high]) = (model.input_unit(described), input.range);
        let limits = match input.limits.iter().all(|end| end.is_infinite()) {
            true => "none".to_owned(),
            false => {
                format!("{} … {} {unit}", as_written(input.limits[0]), as_written(input.limits[1]))
            }
        };
        let [low, high] = [low, high].map(|end| format!("{} {unit}", three_digits(end)));
        vec![input.name.clone(), low, high, limits]
    });
    format!("{}\n", print::headed(&head, rows))
}

fn as_json(plan: &Plan, robot: &InterpretedRobot, path: &Path) -> Value {
    let [inertial, friction] = plan.parameters;
    let [speeds, efforts] = &plan.largest;
    let mut found = json!({
        "file": path.display().to_string(),
        "period": plan.motion.period,
        "joints": robot.joint_names(),
        "base_parameters": inertial,
        "friction_parameters": friction,
        "condition": plan.condition,
        "largest_speeds": speeds,
        "largest_efforts": efforts,
        "begins_at": plan.motion.instant(0.0)[0],
        "approach": plan.approach.as_ref().map(|approach| json!({
            "from": approach.from, "to": approach.to, "seconds": approach.seconds,
        })),
        "notes": texts(&plan.findings, Severity::Note),
    });
    if !plan.shafts.is_empty() {
        let shafts = plan.shafts.iter().map(
            |shaft| json!({"name": shaft.name, "largest_speed": shaft.speed, "largest_torque": shaft.torque}),
        );
        found["shafts"] = shafts.collect();
    }
    if !plan.inputs.is_empty() {
        let finite = |ends: [f64; 2]| ends.map(|end| end.is_finite().then_some(end));
        let inputs = plan
            .inputs
            .iter()
            .map(|input| json!({"name": input.name, "range": input.range, "limits": finite(input.limits)}));
        found["inputs"] = inputs.collect();
    }
    found
}
