//! Poses, rotations and 3 × 3 matrices.

use nalgebra::{Matrix3, Vector3};

/// Pose of a frame in the base frame, as returned by generated pose functions. The first entry is the position
/// (m). The second entry is the rotation matrix, row by row; its columns are the axes of the frame.
pub type Pose = ([f64; 3], [[f64; 3]; 3]);

pub(super) fn vector(p: &[f64; 3]) -> Vector3<f64> {
    Vector3::from(*p)
}

pub(super) fn matrix(rows: &[[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}

pub(super) fn rows(m: &Matrix3<f64>) -> [[f64; 3]; 3] {
    core::array::from_fn(|i| core::array::from_fn(|j| m[(i, j)]))
}

/// Matrix W of the cross product with a vector w, `W x = w × x`.
pub(super) fn skew(w: &Vector3<f64>) -> Matrix3<f64> {
    w.cross_matrix()
}

/// Rotation by `angle` (rad) about the unit vector `axis` (Rodrigues).
pub(super) fn rotation(axis: &Vector3<f64>, angle: f64) -> Matrix3<f64> {
    let (sin, cos) = angle.sin_cos();
    let k = skew(axis);
    Matrix3::identity() + k * sin + k * k * (1.0 - cos)
}
