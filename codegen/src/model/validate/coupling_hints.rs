//! Couplings that probably mean something else: joints that stand still, drives that act alike.

use nalgebra::{DMatrix, Vector3};

use super::super::description::RobotDescription;
use super::super::pose::rotate_numbers;
use super::super::{Drive, Follower, Joint, JointKind, Model, Motion};
use crate::diagnostic::{Report, Span};
use crate::wording::list;

/// Directions and ratios are written numbers.
const ROUNDING: f64 = 1e-9;

/// Notes on probable mistakes in joints that follow others and in drives.
pub(super) fn note(robot: &RobotDescription, model: &Model, report: &mut Report) {
    let described: Vec<f64> = model.parameters.iter().map(|parameter| parameter.default).collect();
    for follower in &model.followers {
        note_stillness(robot, model, follower, &described, report);
    }
    if model.drives.iter().any(|drive| drive.stands_apart) {
        note_alike(robot, model, &described, report);
    }
}

/// A joint that undoes the motion of the one which carries it, as fingers do whose `parent` is missing.
fn note_stillness(
    robot: &RobotDescription,
    model: &Model,
    follower: &Follower,
    described: &[f64],
    report: &mut Report,
) {
    let (Some(joint), [term]) = (&model.links[follower.link].joint, &follower.follows[..]) else { return };
    let Some(carrying) = model.links[joint.parent].joint.as_ref() else { return };
    let ratio = term.ratio.evaluate(described, 0.0, 0.0);
    let is_followed = carrying.motion == Motion::Coordinate(term.coordinate);
    if !is_followed || !undoes(carrying, joint, ratio, described) {
        return;
    }
    let (name, carrying) = (&joint.name, &carrying.name);
    let message = format!(
        "joint `{name}` is carried by `{carrying}` and undoes its motion: the link of `{name}` does not move relative to the link that carries `{carrying}`"
    );
    let Some(described) = robot.joints.iter().find(|described| described.name.value == *name) else { return };
    report.note(Some(described.name.span), "follower-stands-still", message);
    report.help("the joint before it carries a joint without `parent`; the second finger of a gripper has the `parent` of the first");
}

/// Whether two motions cancel that follow one coordinate by 1 and by the ratio.
fn undoes(carrying: &Joint, joint: &Joint, ratio: f64, described: &[f64]) -> bool {
    let slides = |joint: &Joint| joint.kind == JointKind::Prismatic;
    let turns = |joint: &Joint| matches!(joint.kind, JointKind::Revolute | JointKind::Continuous);
    let axis = Vector3::from(rotate_numbers(&joint.origin.rotation, &joint.axis));
    let carrying_axis = Vector3::from(carrying.axis);
    if (carrying_axis + axis * ratio).norm() > ROUNDING {
        return false;
    }
    let arm = Vector3::from(joint.origin.translation.each_ref().map(|x| x.evaluate(described, 0.0, 0.0)));
    slides(carrying) && slides(joint)
        || turns(carrying) && turns(joint) && arm.cross(&carrying_axis).norm() <= ROUNDING
}

/// Drives whose torques act on the coordinates alike: what they exert together does not tell what each exerts.
fn note_alike(robot: &RobotDescription, model: &Model, described: &[f64], report: &mut Report) {
    let drives: Vec<&Drive> = model.input_drives().collect();
    let coordinates = drives.iter().flat_map(|drive| &drive.acts_on).map(|term| term.coordinate + 1).max();
    let mut directions = DMatrix::<f64>::zeros(coordinates.unwrap_or(0), drives.len());
    for (column, drive) in drives.iter().enumerate() {
        for term in &drive.acts_on {
            directions[(term.coordinate, column)] += term.ratio.evaluate(described, 0.0, 0.0);
        }
        let norm = directions.column(column).norm();
        if norm > 0.0 {
            directions.column_mut(column).unscale_mut(norm);
        }
    }
    // Unlike singular values, these are found in a fixed number of steps, also of no drives.
    let triangle = directions.clone().col_piv_qr().unpack_r();
    let alike = (0..triangle.nrows()).filter(|&k| triangle[(k, k)] > ROUNDING).count();
    if alike == drives.len() {
        return;
    }
    let pair = pairs(drives.len())
        .find(|(a, b)| directions.column(*a).dot(&directions.column(*b)).abs() > 1.0 - ROUNDING);
    let who = match pair {
        Some((a, b)) => {
            format!("drives {} act alike", list([a, b].map(|at| drives[at].name.as_str()).into_iter()))
        }
        None => format!("{} drives move the joints in {alike} ways only", drives.len()),
    };
    let last = pair.map_or(drives.len() - 1, |(_, b)| b);
    let message =
        format!("{who}: forces at the joints do not determine their torques, and B has no left inverse");
    report.note(Some(place(robot, drives[last])), "drives-alike", message);
    report.help("weights of opposite signs (`on = { pitch = 1, roll = -1 }`) make a differential; a joint that `[[drives]]` moves \
         needs no `drive` of its own");
}

fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(|a| (0..a).map(move |b| (b, a)))
}

fn place(robot: &RobotDescription, drive: &Drive) -> Span {
    let apart = robot.drives.iter().map(|described| &described.name);
    let joints = robot.joints.iter().map(|joint| &joint.name);
    let mut names = apart.chain(joints);
    names.find(|name| name.value == drive.name).unwrap_or(&robot.name).span
}
