//! Inputs at frames without effect: their column of the input matrix is zero.

use super::levers::{ROUNDING, columns};
use crate::description::{Name, RobotDescription, WrenchInputDescription};
use crate::diagnostic::Report;
use crate::model::{ForceEffect, Model};
use crate::random::Random;
use crate::wording::list;
use gelenk_findings::Rule;

/// Sees: an input at a frame that cannot move any joint at the described values of the free parameters.
/// Matters: its column of B is zero.
/// Example: a propeller whose axis intersects the axis of the only joint before it.
/// Fixture: `codegen/tests/snapshots/bad/idle_inputs.toml.snap`.
const MOVES_NOTHING: Rule = Rule::warning("input-moves-nothing");

const SEED: u64 = 0x6964_6c65;

/// Reports wrench inputs that move no joint.
pub(super) fn check_wrenches(robot: &RobotDescription, model: &Model, report: &mut Report) {
    let wrenches = model.force_inputs.iter().enumerate().skip(pulls(model));
    for (input, (index, found)) in robot.wrench_inputs.iter().zip(wrenches) {
        let ForceEffect::Wrench { at, .. } = &found.effect else { continue };
        if !is_moved(at.link, model) {
            refuse_on_driven(&input.name, model, report);
        } else {
            check_levers(input, &at.name, model.input_drives().count() + index, model, report);
        }
    }
}

/// Number of inputs that pull frames together. They precede the other inputs at frames.
fn pulls(model: &Model) -> usize {
    model.force_inputs.iter().filter(|input| matches!(input.effect, ForceEffect::Pull(_))).count()
}

/// Whether a coordinate moves a link, through an independent joint or a joint that follows others.
fn is_moved(link: usize, model: &Model) -> bool {
    let parent = |link: &usize| model.links[*link].joint.as_ref().map(|joint| joint.parent);
    let follows = |link: usize| {
        let mut followers = model.followers.iter().filter(|follower| follower.link == link);
        followers.any(|one| one.follows.iter().any(|term| term.coordinate < model.coordinates.len()))
    };
    std::iter::successors(Some(link), parent).any(|link| model.coordinates.contains(&link) || follows(link))
}

/// Rejects an input that acts only on driven joints, whose motion is prescribed.
pub(super) fn refuse_on_driven(name: &Name, model: &Model, report: &mut Report) {
    let driven: Vec<&str> = model.driven_joints().map(|joint| joint.name.as_str()).collect();
    let driven = list(driven.into_iter());
    let message = format!("input `{}` moves nothing: it acts only on the driven joints {driven}", name.value);
    report.error(name.span, MOVES_NOTHING.code, message);
    report.help(
        "no input changes the motion of a driven joint. Remove the input, or remove `motion` from the joint",
    );
}

/// Warns of a wrench that does no work along any joint, although joints carry its frame.
fn check_levers(
    input: &WrenchInputDescription,
    frame: &str,
    column: usize,
    model: &Model,
    report: &mut Report,
) {
    let acts = |parameters: &[f64]| {
        let mut forces =
            columns(model, parameters).into_iter().flat_map(|mut state| state.swap_remove(column));
        forces.any(|[force, error]| force.abs() > ROUNDING * error)
    };
    let described = model.described_parameters();
    if acts(&described) {
        return;
    }
    let mut random = Random::new(SEED);
    let others: Vec<f64> = described.iter().map(|value| value + random.either_side(0.1, 1.0)).collect();
    let name = &input.name.value;
    let message =
        format!("input `{name}` moves nothing: its wrench at `{frame}` does no work along any joint");
    let help = "a force moves a revolute joint if it has a moment about the axis, and a prismatic joint if it has a component along \
                the axis. A moment moves a revolute joint if it has a component along the axis";
    if acts(&others) {
        let message = format!("{message} at the described values of the free parameters");
        report.push(Some(input.wrench.span), MOVES_NOTHING.found(message));
        report.help(help);
        return;
    }
    report.error(input.wrench.span, MOVES_NOTHING.code, message);
    report.help(format!("{help}. Correct `wrench` or `frame`, or remove the input"));
}
