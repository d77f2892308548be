//! The described robot that is identified.

use super::super::arguments::{FrictionPlace, Identify};
use super::super::failure::Failure;
use super::super::print;
use crate::identify::{InterpretedRobot, RobotChoices};
use crate::model::{self, Loaded, ReadOptions};

/// The described robot, its regressors ready.
pub(super) fn read(arguments: &Identify) -> Result<(Loaded, InterpretedRobot), Failure> {
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
pub(super) fn say(sentence: &str) {
    print::err(&format!("gelenk: {sentence}\n"));
}
