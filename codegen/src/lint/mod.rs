//! Lints: probable mistakes that need the numeric geometry of the whole model, and limits that follow from
//! the geometry.
//!
//! A lint is a [`Rule`](gelenk_findings::Rule) in the file of its detector. `codegen/docs/findings.md` is
//! generated from the comments of the rules.

mod dead_centres;
mod distances;
mod drives_alike;
mod followers;
mod forces_alike;
mod frame_forces;
mod idle_inputs;
mod inputs_alike;
mod levers;
mod mass_matrix;
mod motion_limits;
mod skipped_rotors;
mod torque_speed;

use crate::description::RobotDescription;
use crate::diagnostic::Report;
use crate::model::Model;
use crate::model::regularity::Pivots;

/// Reports all lints: probable mistakes that need the geometry of the whole model. Narrows the limits of
/// coordinates to the limits that drives and cylinders imply. Returns the pivots of the mass matrix.
pub(super) fn check(robot: &RobotDescription, model: &mut Model, report: &mut Report) -> Pivots {
    motion_limits::narrow(robot, model, report);
    torque_speed::check(robot, model, report);
    frame_forces::check(robot, model, report);
    followers::note(robot, model, report);
    drives_alike::note(robot, model, report);
    forces_alike::note(robot, model, report);
    inputs_alike::note(robot, model, report);
    let pivots = Pivots::of(model);
    mass_matrix::check(robot, model, &pivots, report);
    skipped_rotors::warn(robot, model, report);
    pivots
}
