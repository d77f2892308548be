//! Constant rotations with translations that may hold parameters.

use nalgebra::{Matrix3, Vector3 as Numeric3};

use crate::formula::{Formula, Function};
use crate::graph::{Graph, Scalar, Vector3};
use crate::model::Pose;
use crate::numeric;

/// Entries of a rotation matrix closer than this to 0 or ±1 are meant to be exactly that.
const ROTATION_ROUNDING: f64 = 1e-14;

/// A pose: constant rotation, translation over the graph.
#[derive(Debug, Clone, Copy)]
pub struct ScalarPose<'g> {
    /// Rotation matrix; its columns are the frame's axes.
    pub rotation: Matrix3<f64>,
    /// Origin (m).
    pub translation: Vector3<'g>,
}

impl<'g> ScalarPose<'g> {
    /// The pose that changes nothing.
    pub fn identity(graph: &'g Graph) -> Self {
        Self {
            rotation: Matrix3::identity(),
            translation: Vector3([graph.constant(0.0); 3]),
        }
    }

    /// From the pose of a model.
    pub fn new(graph: &'g Graph, pose: &Pose) -> Self {
        Self {
            rotation: Matrix3::from_fn(|row, column| pose.rotation[row][column]),
            translation: Vector3(
                pose.translation
                    .each_ref()
                    .map(|formula| lower(graph, formula)),
            ),
        }
    }

    /// `self · other`
    pub fn then(self, other: Self) -> Self {
        Self {
            rotation: cleaned(self.rotation * other.rotation),
            translation: self.translation + rotate(&self.rotation, other.translation),
        }
    }

    /// The inverse pose.
    pub fn inverse(self) -> Self {
        let rotation = self.rotation.transpose();
        Self {
            rotation,
            translation: -rotate(&rotation, self.translation),
        }
    }
}

/// A formula without joint variables as a scalar of the graph.
pub fn lower<'g>(graph: &'g Graph, formula: &Formula) -> Scalar<'g> {
    lower_with(graph, formula, graph.constant(0.0), graph.constant(0.0))
}

/// A formula as a scalar of the graph, with the joint's position `y` and velocity `v`.
pub fn lower_with<'g>(
    graph: &'g Graph,
    formula: &Formula,
    y: Scalar<'g>,
    v: Scalar<'g>,
) -> Scalar<'g> {
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

/// `base` to a whole power by repeated squaring.
fn power(base: Scalar<'_>, exponent: u32) -> Scalar<'_> {
    match exponent {
        0 => base.constant(1.0),
        1 => base,
        n if n % 2 == 0 => power(base.squared(), n / 2),
        n => base * power(base, n - 1),
    }
}

/// `rotation · v`
pub fn rotate<'g>(rotation: &Matrix3<f64>, v: Vector3<'g>) -> Vector3<'g> {
    Vector3(std::array::from_fn(|row| {
        v[0] * rotation[(row, 0)] + v[1] * rotation[(row, 1)] + v[2] * rotation[(row, 2)]
    }))
}

/// Removes the rounding of products from entries that are meant to be 0 or ±1.
pub fn cleaned(rotation: Matrix3<f64>) -> Matrix3<f64> {
    rotation.map(|entry| {
        let nearest = entry.round();
        if (entry - nearest).abs() < ROTATION_ROUNDING {
            nearest
        } else {
            entry
        }
    })
}

/// Rotation by `angle` about a unit axis (Rodrigues).
pub fn rotation_about(axis: [f64; 3], angle: f64) -> Matrix3<f64> {
    let cross = Numeric3::from(axis).cross_matrix();
    let (sin, cos) = numeric::sin_cos(angle);
    cleaned(Matrix3::identity() + cross * sin + cross * cross * (1.0 - cos))
}

/// Sine and cosine of an angle in degrees, exact at multiples of 90°.
#[cfg(test)]
pub fn exact_sin_cos(degrees: f64) -> (f64, f64) {
    let (s, c) = numeric::sin_cos(degrees.to_radians());
    let clean = |x: f64| {
        if (x - x.round()).abs() < 1e-15 {
            x.round()
        } else {
            x
        }
    };
    (clean(s), clean(c))
}
