//! Notes on the effects of friction and springs on the generated functions.

use crate::diagnostic::Diagnostic;
use crate::function_names::FORWARD_DYNAMICS;
use crate::functions::composition::Composition;
use crate::functions::function::Function;
use crate::functions::size::MOST_OPERATIONS;
use crate::functions::{catalogue, selection};
use crate::model::Model;
use crate::rates::{self, Mode};
use crate::wording::{list, three_digits};
use gelenk_findings::counted;
use gelenk_formula::Function as Call;

/// Longest usual period of a control loop \[s\].
const LONGEST_PERIOD: f64 = 0.02;
/// Shortest usual period of a control loop \[s\].
const SHORTEST_PERIOD: f64 = 0.001;

/// Stability limit of the classical Runge–Kutta method of order 4 for the product of step length and rate
/// (Hairer and Wanner 1996, section IV.2).
const UNSTABLE: f64 = 2.785_3;

/// Returns notes about exact `sign` functions if Jacobians are generated, and about stiff friction if `step` is
/// generated.
pub fn notes(model: &Model, functions: &[Function], compositions: &[Composition]) -> Vec<Diagnostic> {
    let mut names = functions.iter().map(|function| &function.name);
    let has_derivatives = names.any(|name| catalogue::differentiates_friction(name));
    let steps = compositions.iter().any(|each| each.has_substeps());
    let jumps = has_derivatives.then(|| jumps(model)).flatten();
    let stiff = steps.then(|| stiff(model, functions)).flatten();
    jumps.into_iter().chain(stiff).collect()
}

/// Returns the note about force laws with an exact `sign`.
fn jumps(model: &Model) -> Option<Diagnostic> {
    let moving = model.moving_joints();
    let joints = moving.iter().filter(|moving| moving.joint.jumps()).map(|moving| moving.joint.name.as_str());
    let shafts = model.drives.iter().filter(|drive| drive.jumps()).map(|drive| drive.name.as_str());
    let at_frames = model.point_forces.iter().filter(|force| force.law.calls(Call::Sign));
    let names: Vec<&str> = joints.chain(shafts).chain(at_frames.map(|force| force.name.as_str())).collect();
    if names.is_empty() {
        return None;
    }
    let message = format!(
        "the force laws of {} have an exact `sign`, whose derivative is 0 in Jacobians and linearizations",
        list(names.into_iter())
    );
    let note = Diagnostic::note("sign-derivative", message);
    Some(note.help(
        "for control with derivatives replace sign(v) by tanh(100 v): `--smooth-sign 100`, or `smooth_sign \
         = 100` in [generate]",
    ))
}

/// Returns the note about friction, dampers and springs that make Runge–Kutta steps of usual periods unstable at
/// standstill.
fn stiff(model: &Model, functions: &[Function]) -> Option<Diagnostic> {
    let joints = model.moving_joints();
    let is_free = joints.iter().all(|moving| {
        let joint = moving.joint;
        joint.friction.is_empty() && joint.load_friction.is_empty() && joint.springs.is_empty()
    });
    if is_free && model.rubbing_drives().next().is_none() && model.point_forces.is_empty() {
        return None;
    }
    let forward = functions.iter().find(|function| function.name == FORWARD_DYNAMICS).cloned();
    let derived =
        || selection::derive_functions(model, &[FORWARD_DYNAMICS.to_owned()], MOST_OPERATIONS).ok()?.pop();
    let forward = forward.or_else(derived)?;
    let Mode { rate, coordinate } = rates::fastest(model, &forward)?;
    let substeps = model.options.substeps.unwrap_or(1);
    let longest = UNSTABLE * substeps as f64 / rate;
    if longest >= LONGEST_PERIOD {
        return None;
    }
    let joint = joints.get(coordinate)?.joint;
    let message = format!(
        "friction, dampers and springs give the motion of `{}` an eigenvalue of magnitude {} 1/s at standstill{}; with {}, \
         `step` is unstable for periods longer than {} ms",
        joint.name,
        three_digits(rate),
        if joint.load_friction.is_empty() { "" } else { " with inputs at the effort limits" },
        counted(substeps, "substep", "substeps"),
        three_digits(1000.0 * longest),
    );
    let needed = |period: f64| (rate * period / UNSTABLE).ceil();
    let note = Diagnostic::note("stiff-friction", message);
    Some(note.help(format!(
        "set `substeps` in [generate] to at least {} for {} ms or {} for {} ms, or reduce the slopes of \
         friction, damping or stiffness; `discretize` has no such limit",
        needed(SHORTEST_PERIOD),
        1000.0 * SHORTEST_PERIOD,
        needed(LONGEST_PERIOD),
        1000.0 * LONGEST_PERIOD,
    )))
}
