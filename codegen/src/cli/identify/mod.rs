//! `gelenk identify`.

mod logs;
mod moments;
mod plan;

use std::process::ExitCode;

use super::Failure;
use super::arguments::{Format, Identify};
use super::print;
use crate::identify::InterpretedRobot;
use crate::model::{self, Loaded};

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
    let robot = InterpretedRobot::new(&loaded.model).map_err(at_fault)?;
    Ok((loaded, robot))
}

/// Says on standard error what is being done.
fn say(sentence: &str) {
    print::err(&format!("gelenk: {sentence}\n"));
}
