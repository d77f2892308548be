//! Holds joints at fixed positions: joints whose names match a pattern, and joints that follow only held
//! joints.

use crate::description::{FollowsDescription, Name, RobotDescription};
use crate::diagnostic::{At, Report, nearest};
use crate::wording::list;
use gelenk_formula::Hold;
use std::collections::BTreeMap;

/// Holds the joints whose names match a pattern. A joint that follows other joints must follow only held
/// joints to be held.
pub(super) fn apply(robot: &mut RobotDescription, holds: &[At<Hold>], report: &mut Report) {
    for At { value: hold, span } in holds {
        let mut is_unknown = true;
        for joint in robot.joints.iter_mut().filter(|joint| hold.matches(&joint.name.value)) {
            if joint.is_follower() {
                robot.resting.push(At::new(joint.name.value.clone(), *span));
            } else if joint.moves() || joint.held.is_some() {
                joint.held = Some(hold.position);
            } else {
                continue;
            }
            is_unknown = false;
        }
        if is_unknown {
            let message = format!("no moving joint has the name `{}`, so it cannot be held", hold.pattern);
            report.error(*span, "unknown-joint", message);
            let names = robot.joints.iter().filter(|joint| joint.moves());
            let near = nearest(&hold.pattern, names.map(|joint| joint.name.value.as_str()));
            report.help(near.unwrap_or_else(|| "no joint moves".to_owned()));
        }
    }
    let held = |name: &Name| {
        let mut joints = robot.joints.iter().filter(|joint| joint.name.value == name.value);
        joints.any(|joint| joint.held.is_some()) && holds.iter().any(|hold| hold.value.matches(&name.value))
    };
    if let Some(mut coordinates) = robot.coordinates.take() {
        coordinates.retain(|name| !held(name));
        robot.coordinates = Some(coordinates);
    }
}

/// Holds joints that follow only held joints. Their position is Σ ratio · position + offset.
pub(super) fn settle(robot: &mut RobotDescription, report: &mut Report) {
    let defaults: Vec<f64> = robot.parameters.iter().map(|parameter| parameter.value.default).collect();
    let at_rest = robot.joints.iter().filter_map(|joint| Some((joint.name.value.clone(), joint.held?)));
    let mut positions: BTreeMap<String, f64> = at_rest.collect();
    loop {
        let before = positions.len();
        for joint in robot.joints.iter_mut().filter(|joint| joint.is_follower()) {
            let follows = joint.follows.iter().flat_map(|follows| &follows.value);
            let parts: Option<Vec<f64>> = follows.map(|term| part(term, &positions, &defaults)).collect();
            let Some(parts) = parts.filter(|parts| !parts.is_empty()) else { continue };
            let offset = joint.offset.take().map_or(0.0, |offset| offset.value);
            let position = parts.iter().sum::<f64>() + offset;
            (joint.follows, joint.held) = (None, Some(position));
            positions.insert(joint.name.value.clone(), position);
        }
        if positions.len() == before {
            break;
        }
    }
    for name in std::mem::take(&mut robot.resting) {
        let mut joints = robot.joints.iter().filter(|joint| joint.is_follower());
        let Some(joint) = joints.find(|joint| joint.name.value == name.value) else { continue };
        let moving =
            joint.follows.iter().flat_map(|follows| &follows.value).map(|term| &term.joint.value[..]);
        let moving: Vec<&str> = moving.filter(|joint| !positions.contains_key(*joint)).collect();
        let masters = list(moving.iter().copied());
        let message = format!("joint `{}` follows {masters}, so it cannot be held alone", name.value);
        report.error(name.span, "follows-moving", message);
        report.help(format!("hold {masters} too: followers are then at rest"));
    }
}

/// The product `ratio · position` for a followed joint that is held; `None` if the joint is not held or the
/// product depends on parameters.
fn part(term: &FollowsDescription, positions: &BTreeMap<String, f64>, defaults: &[f64]) -> Option<f64> {
    let position = *positions.get(&term.joint.value)?;
    let ratio = &term.ratio.value;
    let value = ratio.evaluate(defaults, 0.0, 0.0);
    let is_constant = ratio.as_number().is_some() || position == 0.0;
    (is_constant && value.is_finite() && value != 0.0).then_some(value * position)
}
