//! Converts numbers and formulas of a model to scalars of a graph.

use nalgebra::Matrix3;

use super::transmission::{Followed, Transmission};
use crate::graph::{Graph, Scalar};
use crate::model::{self, FollowedCoordinate};
use crate::spatial::{Pose, Vector3};
use gelenk_formula::{Formula, Function};

/// Converts a pose of a model to a pose with scalars of the graph.
pub fn lower_pose<'g>(graph: &'g Graph, pose: &model::Pose) -> Pose<Scalar<'g>> {
    Pose {
        rotation: Matrix3::from_fn(|row, column| pose.rotation[row][column]),
        translation: Vector3(pose.translation.each_ref().map(|formula| lower(graph, formula))),
    }
}

/// Converts the coordinates that a joint or a drive follows. The ratios become scalars of the graph.
pub fn lower_followed<'g>(graph: &'g Graph, terms: &[FollowedCoordinate]) -> Transmission<Scalar<'g>> {
    let term = |term: &FollowedCoordinate| Followed {
        coordinate: term.coordinate,
        ratio: lower(graph, &term.ratio),
    };
    Transmission { terms: terms.iter().map(term).collect() }
}

/// Converts a formula without position and velocity to a scalar of the graph.
pub fn lower<'g>(graph: &'g Graph, formula: &Formula) -> Scalar<'g> {
    lower_with(graph, formula, graph.constant(0.0), graph.constant(0.0))
}

/// Converts a formula to a scalar of the graph. `y` and `v` are the position and the velocity of the joint.
pub fn lower_with<'g>(graph: &'g Graph, formula: &Formula, y: Scalar<'g>, v: Scalar<'g>) -> Scalar<'g> {
    let go = |part: &Formula| lower_with(graph, part, y, v);
    match formula {
        Formula::Number(value) => graph.constant(*value),
        Formula::Parameter(index) => graph.parameter(*index),
        Formula::Position => y,
        Formula::Velocity => v,
        Formula::Negate(a) => -go(a),
        Formula::Add(a, b) => go(a) + go(b),
        Formula::Subtract(a, b) => go(a) - go(b),
        Formula::Multiply(a, b) => go(a) * go(b),
        Formula::Divide(a, b) => go(a).divided_by(go(b)),
        Formula::Power(a, exponent) => power(go(a), *exponent),
        Formula::Call(Function::Abs, a) => go(a).call(Function::Abs),
        Formula::Call(function, a) => go(a).call(*function),
    }
}

/// Raises `base` to an integer power by repeated squaring.
fn power(base: Scalar<'_>, exponent: u32) -> Scalar<'_> {
    match exponent {
        0 => base.constant(1.0),
        1 => base,
        n if n % 2 == 0 => power(base.squared(), n / 2),
        n => base * power(base, n - 1),
    }
}
