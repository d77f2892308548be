//! Drives whose effects on the joints are linearly dependent.

use nalgebra::DMatrix;

use super::levers::ROUNDING;
use crate::description::RobotDescription;
use crate::diagnostic::{Report, Span};
use crate::model::{Drive, Model};
use crate::wording::list;
use gelenk_findings::Rule;

/// Sees: drives of several joints whose torques act on the coordinates in the same way.
/// Matters: forces at the joints do not determine the torques of these drives.
/// Example: two motors of a differential whose weights have the same signs.
/// Fixture: `drives_that_act_alike_are_noted` in `codegen/tests/meaning.rs`.
const DRIVES_ALIKE: Rule = Rule::note("drives-alike");

/// Adds a note if the torques of drives on the coordinates are linearly dependent, so that forces at the
/// joints do not determine the torques.
pub(super) fn note(robot: &RobotDescription, model: &Model, report: &mut Report) {
    if !model.drives.iter().any(|drive| drive.stands_apart) {
        return;
    }
    let described = model.described_parameters();
    let drives: Vec<&Drive> = model.input_drives().collect();
    let coordinates = drives.iter().flat_map(|drive| &drive.acts_on).map(|term| term.coordinate + 1).max();
    let mut directions = DMatrix::<f64>::zeros(coordinates.unwrap_or(0), drives.len());
    for (column, drive) in drives.iter().enumerate() {
        for term in &drive.acts_on {
            directions[(term.coordinate, column)] += term.ratio.evaluate(&described, 0.0, 0.0);
        }
        let norm = directions.column(column).norm();
        if norm > 0.0 {
            directions.column_mut(column).unscale_mut(norm);
        }
    }
    // A QR decomposition takes a fixed number of steps, unlike singular values, and also exists without drives.
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
        None => format!("{} drives move the joints in only {alike} independent ways", drives.len()),
    };
    let last = pair.map_or(drives.len() - 1, |(_, b)| b);
    let message = format!(
        "{who}. Forces at the joints do not determine the torques of these drives, so the input matrix B has no left inverse"
    );
    report.push(Some(place(robot, drives[last])), DRIVES_ALIKE.found(message));
    report.help(
        "a differential has weights of opposite signs, as in `on = { pitch = 1, roll = -1 }`. A joint moved by `[[drives]]` needs \
         no key `drive`",
    );
}

fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(|a| (0..a).map(move |b| (b, a)))
}

fn place(robot: &RobotDescription, drive: &Drive) -> Span {
    let apart = robot.drives.iter().map(|described| &described.name);
    let joints = robot.joints.iter().map(|joint| &joint.name);
    robot.place_among(apart.chain(joints), &drive.name)
}
