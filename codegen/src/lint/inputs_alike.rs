//! Inputs at frames with the same effect as other inputs.

use super::levers::{ROUNDING, columns};
use crate::description::RobotDescription;
use crate::diagnostic::{Report, Span};
use crate::model::{Actuator, ForceEffect, Model};
use gelenk_findings::Rule;

/// Sees: inputs that act in the same ratio at every position, of which one is at a frame.
/// Matters: forces at the joints do not determine these inputs.
/// Example: two cylinders between the same links.
/// Fixture: `inputs_that_act_alike_are_noted` in `codegen/tests/doubts.rs`.
const INPUTS_ALIKE: Rule = Rule::note("inputs-alike");

/// Adds a note about inputs whose columns of the input matrix are parallel at all states.
pub(super) fn note(robot: &RobotDescription, model: &Model, report: &mut Report) {
    if model.force_inputs.is_empty() {
        return;
    }
    let states = columns(model, &model.described_parameters());
    let inputs: Vec<Actuator<'_>> = model.inputs().collect();
    for (index, input) in inputs.iter().enumerate() {
        let mut before = inputs[..index].iter().enumerate();
        let is_alike = |(earlier, other): &(usize, &Actuator<'_>)| {
            !are_told_elsewhere(**other, *input)
                && states.iter().all(|state| are_parallel(&state[*earlier], &state[index]))
        };
        if let Some((_, other)) = before.find(is_alike) {
            note_inputs(robot, [other.name(), input.name()], report);
        }
    }
}

/// Whether another note covers a pair of inputs: two drives, or a drive and a cylinder.
fn are_told_elsewhere(one: Actuator<'_>, other: Actuator<'_>) -> bool {
    let pulls = |input: Actuator<'_>| matches!(input, Actuator::Force(force) if matches!(force.effect, ForceEffect::Pull(_)));
    one.drive().is_some() && (other.drive().is_some() || pulls(other))
}

fn are_parallel(a: &[[f64; 2]], b: &[[f64; 2]]) -> bool {
    let dot = |a: &[[f64; 2]], b: &[[f64; 2]]| a.iter().zip(b).map(|([a, _], [b, _])| a * b).sum::<f64>();
    let sizes = (dot(a, a) * dot(b, b)).sqrt();
    sizes > 0.0 && dot(a, b).abs() > (1.0 - ROUNDING) * sizes
}

fn note_inputs(robot: &RobotDescription, [first, second]: [&str; 2], report: &mut Report) {
    let message = format!(
        "inputs `{first}` and `{second}` have the same effect at every position. Therefore forces at the joints do not determine \
         the inputs, and the input matrix B has no left inverse"
    );
    report.push(Some(place(robot, second)), INPUTS_ALIKE.found(message));
    report.help("describe parallel cylinders as one input with the sum of their limits, unless each is commanded separately");
}

fn place(robot: &RobotDescription, input: &str) -> Span {
    let pulls = robot.point_forces.iter().filter_map(|force| force.input.as_ref()).map(|input| &input.name);
    robot.place_among(pulls.chain(robot.wrench_inputs.iter().map(|input| &input.name)), input)
}
