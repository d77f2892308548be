//! Inputs and forces at frames that do the same as others.

use super::super::description::RobotDescription;
use super::super::levers::Levers;
use super::super::{Actuator, Attachment, ForceEffect, Model};
use crate::diagnostic::{Report, Span};
use gelenk_formula::Formula;

/// Directions and places are written numbers.
const ROUNDING: f64 = 1e-9;

/// Notes inputs whose columns of B are parallel at all states, and springs side by side. Whoever means them so loses nothing.
pub(super) fn note(robot: &RobotDescription, model: &Model, report: &mut Report) {
    if model.force_inputs.is_empty() && model.point_forces.len() < 2 {
        return;
    }
    let described: Vec<f64> = model.parameters.iter().map(|parameter| parameter.default).collect();
    note_springs(robot, model, &described, report);
    let levers = Levers::new(model, described);
    let inputs: Vec<(Actuator<'_>, Vec<Vec<f64>>)> =
        model.inputs().map(|input| (input, levers.columns(input))).collect();
    for (index, (input, columns)) in inputs.iter().enumerate() {
        let mut before = inputs[..index].iter().filter(|(other, _)| !are_told_elsewhere(*other, *input));
        if let Some((other, _)) = before.find(|(_, others)| are_parallel(others, columns)) {
            note_inputs(robot, [other.name(), input.name()], report);
        }
    }
}

/// Drives have a note of their own, and so has a drive together with a cylinder.
fn are_told_elsewhere(one: Actuator<'_>, other: Actuator<'_>) -> bool {
    let pulls = |input: Actuator<'_>| matches!(input, Actuator::Force(force) if matches!(force.effect, ForceEffect::Pull(_)));
    one.drive().is_some() && (other.drive().is_some() || pulls(other))
}

fn are_parallel(some: &[Vec<f64>], others: &[Vec<f64>]) -> bool {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    some.iter().zip(others).all(|(a, b)| {
        let sizes = (dot(a, a) * dot(b, b)).sqrt();
        sizes > 0.0 && dot(a, b).abs() > (1.0 - ROUNDING) * sizes
    })
}

fn note_inputs(robot: &RobotDescription, [first, second]: [&str; 2], report: &mut Report) {
    let message = format!(
        "inputs `{first}` and `{second}` act alike at every position: forces at the joints do not determine theirs, and B has no left inverse"
    );
    report.note(Some(place(robot, second)), "inputs-alike", message);
    report.help("cylinders side by side are one input with the sum of their limits, unless each is commanded by itself");
}

fn place(robot: &RobotDescription, input: &str) -> Span {
    let pulls = robot.point_forces.iter().filter_map(|force| force.input.as_ref()).map(|input| &input.name);
    let mut names = pulls.chain(robot.wrench_inputs.iter().map(|input| &input.name));
    names.find(|name| name.value == input).unwrap_or(&robot.name).span
}

/// Laws between the same two points.
fn note_springs(robot: &RobotDescription, model: &Model, described: &[f64], report: &mut Report) {
    for (index, force) in model.point_forces.iter().enumerate() {
        let mut before = model.point_forces[..index].iter();
        let Some(other) = before.find(|other| are_between(&other.between, &force.between, described)) else {
            continue;
        };
        let Some(place) = robot.point_forces.iter().find(|one| one.name.value == force.name) else {
            continue;
        };
        let message =
            format!("forces `{}` and `{}` act between the same points: they add up", other.name, force.name);
        report.note(Some(place.name.span), "forces-alike", message);
        report.help("springs side by side are meant so; one that was described twice counts twice");
    }
}

/// Whether two pairs are the same points, in either order.
fn are_between([a, b]: &[Attachment; 2], [c, d]: &[Attachment; 2], described: &[f64]) -> bool {
    let value = |x: &Formula| x.evaluate(described, 0.0, 0.0);
    let same = |one: &Attachment, other: &Attachment| {
        let mut pairs = one.pose.translation.iter().zip(&other.pose.translation);
        one.link == other.link && pairs.all(|(x, y)| (value(x) - value(y)).abs() < ROUNDING)
    };
    same(a, c) && same(b, d) || same(a, d) && same(b, c)
}
