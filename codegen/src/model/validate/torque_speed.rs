//! Torque–speed lines that no controller could keep.

use super::super::description::{DriveDescription, RobotDescription};
use super::super::{Drive, Model};
use crate::diagnostic::{Report, Span};

/// Complains about lines that are no constants of the module. The motor of a held joint turns nothing and has none.
pub(super) fn check(robot: &RobotDescription, model: &Model, report: &mut Report) {
    let described: Vec<f64> = model.parameters.iter().map(|parameter| parameter.default).collect();
    let lines = model.limited_inputs(&described);
    for (name, motor) in robot.motors() {
        let mut drives = model.input_drives().enumerate();
        let found = drives.find(|(_, drive)| drive.name == name);
        let (Some(span), Some((input, drive))) = (motor.line.as_ref().map(|line| line.span), found) else {
            continue;
        };
        if !has_known_ratio(drive) {
            refuse_free_ratio(name, motor, report);
        } else if drive.acts_on.iter().any(|moved| moved.coordinate >= model.coordinates.len()) {
            refuse_driven(name, span, report);
        } else if let Some(line) = lines.iter().find(|line| line.input == input) {
            let numbers = line.slopes.iter().chain([&line.limit]);
            if numbers.clone().any(|number| !number.is_finite()) || line.limit == 0.0 {
                let message = format!("the torque–speed line of motor `{name}` is beyond all numbers");
                report.error(span, "torque-speed-line", message);
                report.help("stall torque over no-load speed times gear ratio, in the unit of the input, must be a number");
            }
        }
    }
}

fn has_known_ratio(drive: &Drive) -> bool {
    drive.gear_ratio.value(&[]).is_some()
        && drive.acts_on.iter().all(|moved| moved.ratio.value(&[]).is_some())
}

fn refuse_free_ratio(name: &str, motor: &DriveDescription, report: &mut Report) {
    let message = format!("motor `{name}` has a torque–speed line, and its ratio is a free parameter");
    report.error(motor.gear_ratio.span, "torque-speed-line", message);
    report.help("the line is a limit of the joints' speeds for a known ratio: give the ratio a number, or give controllers the row yourself, `MpcRow::torque_speed_line`");
}

fn refuse_driven(name: &str, span: Span, report: &mut Report) {
    let message = format!("motor `{name}` has a torque–speed line, and turns with a driven joint too");
    report.error(span, "torque-speed-line", message);
    report.help("what the line leaves to the torque would change with the prescribed motion, which no row of a controller has: leave `stall_torque` and `no_load_speed` out, and limit `torque`");
}
