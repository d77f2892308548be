//! Rotors of a URDF that cannot be assigned to a joint.

use crate::description::RobotDescription;
use crate::diagnostic::Report;
use crate::model::Model;
use crate::model::regularity::diagonal_at_zero;
use crate::wording::{as_written, listed, three_digits};
use gelenk_findings::Rule;

/// Sees: the rotor of a `<transmission>` that does not have exactly one joint and one gear ratio.
/// Matters: its inertia is not in the mass matrix.
/// Example: a transmission of two joints.
/// Fixture: `codegen/tests/snapshots/foreign/transmissions.urdf.snap`.
const SKIPPED: Rule = Rule::warning("rotor-skipped");

/// Warns of rotors of a URDF that cannot be assigned to a joint, with the terms that the mass matrix lacks.
pub(super) fn warn(robot: &RobotDescription, model: &Model, report: &mut Report) {
    if robot.skipped_rotors.is_empty() {
        return;
    }
    let diagonal = diagonal_at_zero(model);
    for rotor in &robot.skipped_rotors {
        let inertia = rotor.inertia.value;
        let ratio = rotor.ratios.first().copied().unwrap_or(1.0);
        let entries = model.joints().zip(&diagonal).filter(|(joint, _)| rotor.joints.contains(&joint.name));
        let entries: Vec<String> =
            entries.map(|(joint, entry)| format!("{} at `{}`", three_digits(*entry), joint.name)).collect();
        let message = format!(
            "a rotor of {} kg m² was skipped because {}. The mass matrix M lacks i² J = {} kg m²{}",
            as_written(inertia),
            match (rotor.joints.len(), rotor.ratios.len()) {
                (1, 1) => "its joint has no coordinate of its own, or has a quaternion",
                (1, 0) => "its transmission has no gear ratio",
                (1, _) => "its transmission has several gear ratios",
                _ => "its transmission does not have exactly one joint",
            },
            three_digits(ratio * ratio * inertia),
            if entries.is_empty() {
                String::new()
            } else {
                format!(". Without it, the diagonal of M is {}", listed(entries.into_iter()))
            },
        );
        report.push(Some(rotor.inertia.span), SKIPPED.found(message));
        report.help(format!(
            "add the rotor in a TOML file with `urdf = \"…\"`: `[[joints]]`, `name = \"{}\"`, `drive = {{ \
             gear_ratio = {}, rotor_inertia = {}, coupling = \"diagonal\" }}`",
            rotor.joints.first().map_or("…", String::as_str),
            as_written(ratio),
            as_written(inertia),
        ));
    }
}
