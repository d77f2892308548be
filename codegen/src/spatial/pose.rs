//! Poses: constant rotations, and translations that may contain parameters.

use nalgebra::{Matrix3, Vector3 as Numeric3};

use super::vector::Vector3;
use crate::graph::{Graph, Scalar};
use crate::numeric;

/// Entries of a rotation matrix that differ from 0 or ±1 by less than this tolerance are set to this number.
const ROTATION_ROUNDING: f64 = 1e-14;

/// A pose: a constant rotation, and a translation with expressions as entries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose<S> {
    /// Rotation matrix. Its columns are the frame's axes.
    pub rotation: Matrix3<f64>,
    /// Position of the frame's origin in the other frame (m).
    pub translation: Vector3<S>,
}

impl<'g> Pose<Scalar<'g>> {
    /// The identity pose on this graph.
    pub fn identity(graph: &'g Graph) -> Self {
        Self { rotation: Matrix3::identity(), translation: Vector3([graph.constant(0.0); 3]) }
    }

    /// Product `self · other` of two poses: `self` is the pose of frame b in frame a, and `other` the pose of
    /// frame c in frame b. The result is the pose of c in a.
    pub fn then(self, other: Self) -> Self {
        Self {
            rotation: cleaned(self.rotation * other.rotation),
            translation: self.translation + rotate(&self.rotation, other.translation),
        }
    }

    /// The inverse pose: of the other frame in this frame.
    pub fn inverse(self) -> Self {
        let rotation = self.rotation.transpose();
        Self { rotation, translation: -rotate(&rotation, self.translation) }
    }
}

/// The vector `rotation · v` after the rotation.
pub fn rotate<'g>(rotation: &Matrix3<f64>, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
    Vector3(std::array::from_fn(|row| {
        v[0] * rotation[(row, 0)] + v[1] * rotation[(row, 1)] + v[2] * rotation[(row, 2)]
    }))
}

/// Rounds entries of a rotation matrix that differ from 0 or ±1 only by rounding errors.
pub fn cleaned(rotation: Matrix3<f64>) -> Matrix3<f64> {
    rotation.map(|entry| {
        let nearest = entry.round();
        if (entry - nearest).abs() < ROTATION_ROUNDING { nearest } else { entry }
    })
}

/// Rotation matrix for an angle in rad about a unit axis (Rodrigues).
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
        if (x - x.round()).abs() < 1e-15 { x.round() } else { x }
    };
    (clean(s), clean(c))
}
