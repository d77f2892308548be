//! Several force laws between the same two points.

use super::levers::ROUNDING;
use crate::description::RobotDescription;
use crate::diagnostic::Report;
use crate::model::{Attachment, Model};
use gelenk_findings::Rule;
use gelenk_formula::Formula;

/// Sees: two force laws between the same two points.
/// Matters: the forces add up. One law may have been described twice.
/// Example: a spring of the base file that the extension repeats with another name.
/// Fixture: `springs_between_the_same_points_are_noted` in `codegen/tests/doubts.rs`.
const FORCES_ALIKE: Rule = Rule::note("forces-alike");

/// Adds a note about force laws between the same two points.
pub(super) fn note(robot: &RobotDescription, model: &Model, report: &mut Report) {
    let described = model.described_parameters();
    for (index, force) in model.point_forces.iter().enumerate() {
        let mut before = model.point_forces[..index].iter();
        let Some(other) = before.find(|other| are_between(&other.between, &force.between, &described)) else {
            continue;
        };
        let Some(place) = robot.point_forces.iter().find(|one| one.name.value == force.name) else {
            continue;
        };
        let message = format!(
            "forces `{}` and `{}` act between the same points, so they add up",
            other.name, force.name
        );
        report.push(Some(place.name.span), FORCES_ALIKE.found(message));
        report.help("remove one of the forces if the same spring was described twice");
    }
}

/// Whether two pairs of frames are at the same two points, in either order.
fn are_between([a, b]: &[Attachment; 2], [c, d]: &[Attachment; 2], described: &[f64]) -> bool {
    let value = |x: &Formula| x.evaluate(described, 0.0, 0.0);
    let same = |one: &Attachment, other: &Attachment| {
        let mut pairs = one.pose.translation.iter().zip(&other.pose.translation);
        one.link == other.link && pairs.all(|(x, y)| (value(x) - value(y)).abs() < ROUNDING)
    };
    same(a, c) && same(b, d) || same(a, d) && same(b, c)
}
