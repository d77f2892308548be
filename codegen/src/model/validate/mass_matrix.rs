//! Is the mass matrix positive definite?

use super::super::description::RobotDescription;
use super::super::regularity::{Pivots, STATES, diagonal_at_zero};
use super::super::{Joint, Model};
use crate::diagnostic::{Report, Span};
use crate::wording::{as_written, list, listed, three_digits};

/// A negative pivot is an error, unless the robot is wanted as it is; a zero one is a warning, since only
/// some functions need the inverse.
pub(super) fn check(robot: &RobotDescription, model: &Model, pivots: &Pivots, report: &mut Report) {
    let (negative, zero) = (model.joints_of(&pivots.negative), model.joints_of(&pivots.zero));
    if let Some(first) = negative.first() {
        report_indefinite(robot, place(robot, first), &negative, pivots, report);
    }
    if let Some(first) = zero.first() {
        warn_of_singular(place(robot, first), &pivots.free_motions(model), report);
    }
}

/// Warns of the rotors of a URDF whose place is not clear, with their terms in M.
pub(super) fn warn_of_skipped_rotors(robot: &RobotDescription, model: &Model, report: &mut Report) {
    if robot.skipped_rotors.is_empty() {
        return;
    }
    let diagonal = diagonal_at_zero(model);
    for rotor in &robot.skipped_rotors {
        let inertia = rotor.inertia.value;
        let ratio = rotor.ratios.first().copied().unwrap_or(1.0);
        let entries = model.joints().zip(&diagonal).filter(|(joint, _)| rotor.joints.contains(&joint.name));
        let entries: Vec<String> =
            entries.map(|(joint, entry)| format!("{} of `{}`", three_digits(*entry), joint.name)).collect();
        let message = format!(
            "a rotor of {} kg m² was skipped, {}: i² J = {} kg m²{}",
            as_written(inertia),
            match (rotor.joints.len(), rotor.ratios.len()) {
                (1, 1) => "whose joint is not a coordinate with one position",
                (1, 0) => "whose transmission has no gear ratio",
                (1, _) => "whose transmission has several gear ratios",
                _ => "whose transmission has not one joint",
            },
            three_digits(ratio * ratio * inertia),
            if entries.is_empty() {
                String::new()
            } else {
                format!(" next to M's {}", listed(entries.into_iter()))
            },
        );
        report.warning(rotor.inertia.span, "rotor-skipped", message);
        report.help(format!(
            "a TOML file with `urdf = \"…\"` says it: `[[joints]]`, `name = \"{}\"`, `drive = {{ gear_ratio = {}, rotor_inertia = {}, \
             coupling = \"diagonal\" }}`",
            rotor.joints.first().map_or("…", String::as_str),
            as_written(ratio),
            as_written(inertia),
        ));
    }
}

fn place(robot: &RobotDescription, joint: &Joint) -> Span {
    let mut names = robot.joints.iter().map(|joint| &joint.name);
    let name = names.find(|name| name.value == joint.name);
    name.unwrap_or(&robot.name).span
}

fn report_indefinite(
    robot: &RobotDescription,
    span: Span,
    joints: &[&Joint],
    pivots: &Pivots,
    report: &mut Report,
) {
    const CODE: &str = "mass-matrix-not-positive-definite";
    let message = format!(
        "the mass matrix is not positive definite at {} of {STATES} seeded states: forces can accelerate {} backwards",
        pivots.indefinite_states,
        list(joints.iter().map(|joint| joint.name.as_str())),
    );
    if robot.accept_unphysical {
        report.warning(span, CODE, message);
        return;
    }
    report.error(span, CODE, message);
    report.help(
        "correct the bodies that these joints move, or accept the model as it is: `--accept-unphysical`, or \
         `accept_unphysical = true` at the top of a TOML file",
    );
}

fn warn_of_singular(span: Span, motions: &[String], report: &mut Report) {
    let motions = motions.join(", ");
    let message = format!("the mass matrix is singular: nothing that has inertia moves with {motions}");
    report.warning(span, "joints-without-inertia", message);
    report.help(
        "give the links that move there mass or inertia, give the drives a rotor inertia, or make the joints fixed or held",
    );
}
