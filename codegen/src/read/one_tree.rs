//! Selection of one kinematic tree of a scene.

use crate::description::{Name, RobotDescription};
use crate::diagnostic::{Report, Span, nearest};
use std::collections::BTreeSet;

/// Keeps the tree that contains a link, from the base outwards. Removes other robots and objects from the
/// scene.
///
/// - `base`: link that carries all trees
/// - `wanted`: the link, and `span` the place of the request
pub(super) fn keep(robot: &mut RobotDescription, base: &str, wanted: &str, span: Span, report: &mut Report) {
    if wanted == base || !robot.links.iter().any(|link| link.value == wanted) {
        report.error(span, "unknown-link", format!("no body has the name `{wanted}`"));
        let others = robot.links.iter().map(|link| link.value.as_str()).filter(|link| *link != base);
        report.help(nearest(wanted, others).unwrap_or_else(|| "there are no bodies".to_owned()));
        return;
    }
    let edges = edges(robot);
    let mut root = wanted.to_owned();
    while let Some((parent, _)) = edges.iter().find(|(parent, child)| *child == root && parent != base) {
        root.clone_from(parent);
    }
    cut(robot, base, root);
}

/// Parent and child of each joint.
fn edges(robot: &RobotDescription) -> Vec<(String, String)> {
    let ends = |joint: &crate::description::JointDescription| {
        Some((joint.parent.as_ref()?.value.clone(), joint.child.as_ref()?.value.clone()))
    };
    robot.joints.iter().filter_map(ends).collect()
}

/// Keeps the link `root`, the links that it carries, and the frames of the base.
pub(super) fn cut(robot: &mut RobotDescription, base: &str, root: String) {
    // Parents are described before their children.
    let mut kept = BTreeSet::from([root]);
    for (parent, child) in edges(robot) {
        if kept.contains(&parent) {
            kept.insert(child);
        }
    }
    let is_kept = |link: &Name| kept.contains(&link.value);
    robot.joints.retain(|joint| joint.child.as_ref().is_some_and(is_kept));
    let joints: BTreeSet<String> = robot.joints.iter().map(|joint| joint.name.value.clone()).collect();
    robot.links.retain(|link| is_kept(link) || link.value == base);
    robot.bodies.retain(|body| is_kept(&body.link));
    robot.weightless_shapes.retain(is_kept);
    robot.frames.retain(|frame| is_kept(&frame.link) || frame.link.value == base);
    let frames: BTreeSet<String> = robot.frames.iter().map(|frame| frame.name.value.clone()).collect();
    robot.wrench_inputs.retain(|input| is_kept(&input.frame) || frames.contains(&input.frame.value));
    robot.drives.retain(|drive| drive.on.iter().any(|term| joints.contains(&term.joint.value)));
}
