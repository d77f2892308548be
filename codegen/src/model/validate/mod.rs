//! A [`RobotDescription`] becomes a [`Model`], or everything that is wrong with it.

mod build;
mod checks;
mod force_laws;
mod names;

use super::Model;
use super::description::RobotDescription;
use super::tree;
use crate::diagnostic::Report;
use build::Builder;
use names::{JointNames, Names};

/// Checks everything and builds the model; with errors in the report there is none.
pub(super) fn model(robot: &RobotDescription, report: &mut Report) -> Option<Model> {
    let mut names = Names::default();
    let identifiers = JointNames::new(robot, &mut names, report);
    let defaults: Vec<f64> = robot
        .parameters
        .iter()
        .map(|parameter| parameter.value.default)
        .collect();
    for joint in &robot.joints {
        checks::joint(joint, report);
        force_laws::check(joint, &defaults, report);
    }
    for body in &robot.bodies {
        checks::body(body, &defaults, report);
    }
    names::report_duplicates(robot.bodies.iter().map(|body| &body.name), "bodies", report);
    let name = names.identifier(&robot.name, report);
    let tree = tree::build(robot, report);
    names.note(report);
    let tree = tree?;
    let mut builder = Builder {
        robot,
        report,
        names: identifiers,
        defaults,
        tree,
        offsets: Vec::new(),
    };
    let model = builder.build(name?)?;
    checks::regularity(&model, robot, builder.report, &builder.tree);
    (!report.has_errors()).then_some(model)
}
