//! A [`RobotDescription`] becomes a [`Model`], or everything that is wrong with it.

mod build;
mod checks;
mod coupling_hints;
mod couplings;
mod dead_centres;
mod dependent_limits;
mod driven_joints;
mod drives;
mod force_laws;
mod frame_forces;
mod frame_names;
mod hints;
mod idle_inputs;
mod inertias;
mod inner_links;
mod inputs_alike;
mod mass_matrix;
mod motion_limits;
mod names;
mod quaternion_joints;
mod range;
mod torque_speed;

use super::Model;
use super::description::RobotDescription;
use super::regularity::Pivots;
use super::tree;
use crate::diagnostic::Report;
use build::Builder;
use names::Identifiers;

/// Checks everything and builds the model; with errors in the report there is none.
pub(super) fn model(robot: &RobotDescription, report: &mut Report) -> Option<Model> {
    let identifiers = Identifiers::new(robot, report);
    let defaults: Vec<f64> = robot.parameters.iter().map(|parameter| parameter.value.default).collect();
    for joint in &robot.joints {
        checks::joint(joint, report);
        force_laws::check(joint, &defaults, report);
    }
    quaternion_joints::check(robot, report);
    driven_joints::check(robot, report);
    for body in &robot.bodies {
        checks::body(body, &defaults, report);
    }
    names::report_duplicates(robot.bodies.iter().map(|body| &body.name), "bodies", report);
    let tree = tree::build(robot, report);
    identifiers.note(robot, report);
    if let Some(tree) = &tree {
        hints::note(robot, tree, &defaults, report);
        frame_names::check(robot, tree, report);
    }
    let published = inertias::check(robot, tree.as_ref(), &defaults, report);
    let model = tree.and_then(|tree| {
        let mut builder = Builder { robot, report, identifiers, defaults, tree, offsets: Vec::new() };
        builder.build()
    });
    let mut model = model.filter(|_| !report.has_errors());
    if let Some(model) = &mut model {
        motion_limits::narrow(robot, model, report);
        torque_speed::check(robot, model, report);
        frame_forces::check(robot, model, report);
        coupling_hints::note(robot, model, report);
        inputs_alike::note(robot, model, report);
    }
    let pivots = model.as_ref().map(Pivots::of);
    published.report(pivots.as_ref(), report);
    if let (Some(model), Some(pivots)) = (&model, &pivots) {
        mass_matrix::check(robot, model, pivots, report);
        mass_matrix::warn_of_skipped_rotors(robot, model, report);
    }
    model.filter(|_| !report.has_errors())
}
