//! Inputs at frames with the same effect as other inputs.

use super::levers::{Levers, ROUNDING};
use crate::description::RobotDescription;
use crate::diagnostic::{Report, Span};
use crate::model::{Actuator, ForceEffect, Model};
use gelenk_findings::Rule;

/// Sees: inputs that act in the same ratio at every position, of which one is at a frame.
/// Matters: forces at the joints do not determine them.
/// Example: two cylinders between the same links.
/// Fixture: `inputs_that_act_alike_are_noted` in `codegen/tests/doubts.rs`.
const INPUTS_ALIKE: Rule = Rule::note("inputs-alike");

/// Adds a note about inputs whose columns of B are parallel at all states.
pub(super) fn note(robot: &RobotDescription, model: &Model, report: &mut Report) {
    if model.force_inputs.is_empty() {
        return;
    }
    let described = model.described_parameters();
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

/// Whether another note covers these inputs: two drives, or a drive and a cylinder.
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
        "inputs `{first}` and `{second}` have the same effect at every position, so forces at the joints do \
         not determine them and B has no left inverse"
    );
    report.push(Some(place(robot, second)), INPUTS_ALIKE.found(message));
    report.help("describe parallel cylinders as one input with the sum of their limits, unless each is commanded separately");
}

fn place(robot: &RobotDescription, input: &str) -> Span {
    let pulls = robot.point_forces.iter().filter_map(|force| force.input.as_ref()).map(|input| &input.name);
    robot.place_among(pulls.chain(robot.wrench_inputs.iter().map(|input| &input.name)), input)
}
