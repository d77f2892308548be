//! `gelenk identify`.

mod logs;
mod moments;
mod plan;

use std::process::ExitCode;

use super::Failure;
use super::arguments::{Format, FrictionPlace, Identify};
use super::print;
use crate::identify::{InterpretedRobot, RobotChoices};
use crate::model::{self, Loaded, ReadOptions};

/// Identifies a robot from its logs or their moments, reduces logs to moments, or plans a motion to record.
pub(super) fn identify(arguments: &Identify, format: Format) -> Result<ExitCode, Failure> {
    match arguments {
        Identify { plan: true, .. } => plan::write(arguments, format),
        Identify { reduce: true, .. } => moments::write_reduced(arguments, format),
        Identify { merge: true, .. } => moments::write_merged(arguments, format),
        _ => logs::write(arguments, format),
    }
}

/// The described robot, its regressors ready.
fn read(arguments: &Identify) -> Result<(Loaded, InterpretedRobot), Failure> {
    let at_fault = |problems| Failure::Descriptions(vec![problems]);
    let loaded = model::read(&arguments.description, &arguments.reading.options()).map_err(at_fault)?;
    if !loaded.notes.is_empty() {
        print::err(&format!("{}\n\n", loaded.notes));
    }
    let driven: Vec<String> = loaded.model.driven_joints().map(|joint| joint.name.clone()).collect();
    let choices = RobotChoices {
        friction_at_joints: arguments.friction_on == FrictionPlace::Joints,
        unmeasured: driven,
    };
    if choices.unmeasured.is_empty() {
        let robot = InterpretedRobot::with(&loaded.model, &choices).map_err(at_fault)?;
        return Ok((loaded, robot));
    }
    // A log has the motion of all joints. What moves these is not in it.
    let options = ReadOptions { free_driven: true, ..arguments.reading.options() };
    let freed = model::read(&arguments.description, &options).map_err(at_fault)?;
    let robot = InterpretedRobot::with(&freed.model, &choices).map_err(at_fault)?;
    Ok((loaded, robot))
}

/// Says on standard error what is being done.
fn say(sentence: &str) {
    print::err(&format!("gelenk: {sentence}\n"));
}
