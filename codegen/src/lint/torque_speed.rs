//! Torque–speed lines that no controller can keep, or that contradict other limits.

use crate::description::{DriveDescription, RobotDescription};
use crate::diagnostic::{At, Report, Span};
use crate::model::{Drive, Model, TorqueSpeedLine};
use crate::wording::{as_written, three_digits};
use gelenk_findings::Rule;

/// Sees: a torque limit of a motor, or an effort limit of its joint, above the stall torque of the motor.
/// Matters: the described limit is never reached.
/// Example: `torque = 1.5` next to `stall_torque = 1.2`.
/// Fixture: `limits_beyond_a_torque_speed_line_are_told` in `codegen/tests/doubts.rs`.
const BEYOND_STALL: Rule = Rule::warning("beyond-stall-torque");

/// Sees: a speed limit of a motor above its no-load speed.
/// Matters: the motor has no torque at this limit and cannot reach it alone.
/// Example: `speed = 700` next to `no_load_speed = 600`.
/// Fixture: `limits_beyond_a_torque_speed_line_are_told` in `codegen/tests/doubts.rs`.
const BEYOND_SPEED: Rule = Rule::note("beyond-no-load-speed");

/// Relative tolerance for rounded decimal numbers of a description.
const ROUNDING: f64 = 1e-9;

/// Reports torque–speed lines that cannot be constants of the module, and limits that contradict a line.
/// Motors of held joints are skipped.
pub(super) fn check(robot: &RobotDescription, model: &Model, report: &mut Report) {
    let described = model.described_parameters();
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
                let message = format!("the torque–speed line of motor `{name}` is not finite");
                report.error(span, "torque-speed-line", message);
                report.help("stall torque times gear ratio divided by no-load speed must be finite");
            }
            doubt_limits(name, motor, report);
            note_effort(name, drive, model, span, report);
        }
    }
}

/// Reports limits of a motor that it cannot reach because of its torque–speed line.
fn doubt_limits(name: &str, motor: &DriveDescription, report: &mut Report) {
    let Some(At { value: TorqueSpeedLine { stall_torque, no_load_speed }, span }) = &motor.line else {
        return;
    };
    let beyond = |torque: Option<f64>| torque.filter(|torque| torque > stall_torque);
    let told = |kind: &str, torque: f64| {
        let [torque, stall] = [torque, *stall_torque].map(as_written);
        format!(
            "the {kind}torque limit of motor `{name}` is {torque} N m, but its stall torque allows at most {stall} N m"
        )
    };
    if let Some(torque) = beyond(motor.torque.nominal) {
        report.push(Some(*span), BEYOND_STALL.found(told("", torque)));
        report.help(
            "`torque` and `stall_torque` are torques at the motor's shaft. Only a braking motor exceeds its stall torque",
        );
    } else if let Some(torque) = beyond(motor.torque.peak) {
        report.note(Some(*span), BEYOND_STALL.code, told("peak ", torque));
        report.help(
            "the torque–speed line is the tighter limit unless the motor brakes, so the peak torque limits only a braking motor",
        );
    }
    if let Some(speed) = motor.speed.as_ref().filter(|speed| speed.value > *no_load_speed) {
        let [most, free] = [speed.value, *no_load_speed].map(as_written);
        let message = format!(
            "motor `{name}` has no torque at its `no_load_speed` of {free} rad/s, but its `speed` allows {most} rad/s"
        );
        report.push(Some(speed.span), BEYOND_SPEED.found(message));
        report.help("above its no-load speed, a motor only brakes. Both values are in rad/s at the shaft");
    }
}

/// Adds a note about an effort limit of a joint that its motor cannot reach.
fn note_effort(name: &str, drive: &Drive, model: &Model, span: Span, report: &mut Report) {
    let joint = drive.coordinate().and_then(|coordinate| model.joints().nth(coordinate));
    let effort = joint.and_then(|joint| joint.limits.effort);
    let (Some(joint), Some(effort), Some(line)) = (joint, effort, drive.line) else { return };
    let most = line.stall_torque * drive.gear_ratio.value(&[]).unwrap_or(f64::INFINITY).abs();
    if effort > most * (1.0 + ROUNDING) {
        let unit = joint.kind.effort_unit();
        let message = format!(
            "joint `{}` has an effort limit of {} {unit}, but its motor `{name}` gives at most {} {unit}, at rest",
            joint.name,
            as_written(effort),
            three_digits(most)
        );
        report.note(Some(span), BEYOND_STALL.code, message);
        report.help(
            "`effort` is at the joint, `stall_torque` at the motor. `stall_torque` times the gear ratio is the tighter limit",
        );
    }
}

fn has_known_ratio(drive: &Drive) -> bool {
    drive.gear_ratio.value(&[]).is_some()
        && drive.acts_on.iter().all(|moved| moved.ratio.value(&[]).is_some())
}

fn refuse_free_ratio(name: &str, motor: &DriveDescription, report: &mut Report) {
    let message = format!("motor `{name}` has a torque–speed line, but its ratio is a free parameter");
    report.error(motor.gear_ratio.span, "torque-speed-line", message);
    report.help("give the ratio as a number, or add `MpcRow::torque_speed_line` to the controller");
}

fn refuse_driven(name: &str, span: Span, report: &mut Report) {
    let message = format!(
        "motor `{name}` has a torque–speed line, but also rotates with a joint whose motion is prescribed"
    );
    report.error(span, "torque-speed-line", message);
    report.help(
        "controllers cannot enforce a torque limit that depends on a prescribed motion. Remove `stall_torque` and \
         `no_load_speed`, and limit `torque`",
    );
}
