//! Reads the description of the robot to be identified.

use gelenk_identification::log::ColumnOptions;

use super::super::arguments::{FrictionPlace, Identify};
use super::super::failure::Failure;
use super::super::print;
use crate::identify::{InterpretedRobot, RobotChoices};
use crate::model::Model;
use crate::read::{self, Loaded, ReadOptions};

/// Reads the description, and derives the robot's functions for the identification.
pub(super) fn read(arguments: &Identify) -> Result<(Loaded, InterpretedRobot), Failure> {
    let at_fault = |problems| Failure::Descriptions(vec![problems]);
    let loaded = read::read(&arguments.description, &arguments.reading.options()).map_err(at_fault)?;
    if !loaded.notes.is_empty() {
        print::err(&format!("{}\n\n", loaded.notes));
    }
    let driven: Vec<String> = loaded.model.driven_joints().map(|joint| joint.name.clone()).collect();
    let of = |model: &Model| {
        let unmeasured = driven.iter().cloned().chain(held(arguments, model)?).collect();
        let friction_at_joints = arguments.friction_on == FrictionPlace::Joints;
        InterpretedRobot::with(model, &RobotChoices { friction_at_joints, unmeasured }).map_err(at_fault)
    };
    if driven.is_empty() {
        let robot = of(&loaded.model)?;
        return Ok((loaded, robot));
    }
    // A log contains the motion of all joints, but not the forces that move driven joints.
    let options = ReadOptions { free_driven: true, ..arguments.reading.options() };
    let freed = read::read(&arguments.description, &options).map_err(at_fault)?;
    let robot = of(&freed.model)?;
    Ok((loaded, robot))
}

/// Returns the options of the command line about the columns of logs.
pub(super) fn stated(arguments: &Identify) -> ColumnOptions {
    ColumnOptions { columns: arguments.columns.clone(), ..ColumnOptions::default() }
}

/// Returns the names of the joints that are held because they are not in the logs.
fn held(arguments: &Identify, model: &Model) -> Result<Vec<String>, Failure> {
    let names: Vec<String> = model.joints().map(|joint| joint.name.clone()).collect();
    let held = stated(arguments).held(&names)?;
    Ok(names.into_iter().zip(held).filter(|(_, held)| held.is_some()).map(|(name, _)| name).collect())
}

/// Prints the progress on standard error.
pub(super) fn say(sentence: &str) {
    print::err(&format!("gelenk: {sentence}\n"));
}
