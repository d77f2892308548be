//! Check that the mass matrix is positive definite.

use crate::description::RobotDescription;
use crate::diagnostic::{Report, Span};
use crate::model::regularity::{Pivots, STATES};
use crate::model::{Joint, Model};
use crate::wording::list;
use gelenk_findings::Rule;

/// Sees: a mass matrix with a negative eigenvalue, in a robot that the user accepts as unphysical.
/// Matters: forces can accelerate joints backwards.
/// Example: a URDF with a negative inertia, and `--accept-unphysical`.
/// Fixture: `a_mass_matrix_that_is_not_positive_definite_is_refused` in `codegen/tests/wild_urdf.rs`.
const INDEFINITE: Rule = Rule::warning("mass-matrix-not-positive-definite");

/// Sees: joints, or sums of joints, without any inertia.
/// Matters: the mass matrix is singular, so functions with its inverse are missing.
/// Example: the last joint of an arm whose hand has no body.
/// Fixture: `codegen/tests/snapshots/bad/massless_leaf.toml.snap`.
const SINGULAR: Rule = Rule::warning("joints-without-inertia");

/// Checks the pivots of the mass matrix, whose signs are those of its eigenvalues. A negative pivot is an
/// error, unless the robot is accepted as unphysical. A zero pivot is a warning, because only some functions
/// need the inverse.
pub(super) fn check(robot: &RobotDescription, model: &Model, pivots: &Pivots, report: &mut Report) {
    let (negative, zero) = (model.joints_of(&pivots.negative), model.joints_of(&pivots.zero));
    if let Some(first) = negative.first() {
        report_indefinite(robot, place(robot, first), &negative, pivots, report);
    }
    if let Some(first) = zero.first() {
        warn_of_singular(place(robot, first), &pivots.free_motions(model), report);
    }
}

fn place(robot: &RobotDescription, joint: &Joint) -> Span {
    robot.place_among(robot.joints.iter().map(|joint| &joint.name), &joint.name)
}

fn report_indefinite(
    robot: &RobotDescription,
    span: Span,
    joints: &[&Joint],
    pivots: &Pivots,
    report: &mut Report,
) {
    let message = format!(
        "the mass matrix is not positive definite at {} of {STATES} pseudo-random states. A force can accelerate {} against its direction",
        pivots.indefinite_states,
        list(joints.iter().map(|joint| joint.name.as_str())),
    );
    if robot.accept_unphysical {
        report.push(Some(span), INDEFINITE.found(message));
        return;
    }
    report.error(span, INDEFINITE.code, message);
    report.help(
        "correct the bodies that these joints move, or accept the model by `--accept-unphysical`, or by `accept_unphysical = \
         true` at the top of a TOML file",
    );
}

fn warn_of_singular(span: Span, motions: &[String], report: &mut Report) {
    let motions = motions.join(", ");
    let message = format!("the mass matrix is singular: no inertia moves with {motions}");
    report.push(Some(span), SINGULAR.found(message));
    report.help(
        "give mass or inertia to the links that these joints move, give rotor inertia to the drives, or fix or hold the joints",
    );
}
