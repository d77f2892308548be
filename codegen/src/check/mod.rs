//! Converts a [`RobotDescription`] to a [`Model`], or reports all errors of the description.

mod build;
mod checks;
mod couplings;
mod dependent_limits;
mod driven_joints;
mod drives;
mod force_laws;
mod frame_forces;
mod frame_names;
mod hints;
mod inertias;
mod inner_links;
mod names;
mod quaternion_joints;
mod range;
mod tree;

use crate::description::RobotDescription;
use crate::diagnostic::Report;
use crate::lint;
use crate::model::Model;
use build::Builder;
use names::Identifiers;

/// Checks the description and builds the model. Returns `None` if there are errors.
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
    let pivots = model.as_mut().map(|model| lint::check(robot, model, report));
    published.report(pivots.as_ref(), report);
    model.filter(|_| !report.has_errors())
}
