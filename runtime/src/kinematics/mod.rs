//! Kinematics of six-axis arms with a spherical wrist: geometry from a pose function, and analytic inverse
//! kinematics.
//!
//! A generated module has the pose of its frames as a function, `frame_tool_pose(y)`; all that is needed here
//! is found by calling it.

mod geometry;
mod spherical_wrist;

pub use geometry::{GeometryError, Screws};
pub use spherical_wrist::{
    Branch, InverseKinematics, KinematicsError, Singularity, Solution, SphericalWrist,
};

use nalgebra::{Matrix3, Vector3};

/// Position (m) and rotation matrix (columns are the frame's axes) of a frame in the base frame: what
/// generated pose functions return.
pub type Pose = ([f64; 3], [[f64; 3]; 3]);

fn vector(p: &[f64; 3]) -> Vector3<f64> {
    Vector3::from(*p)
}

fn matrix(rows: &[[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}

fn rows(m: &Matrix3<f64>) -> [[f64; 3]; 3] {
    core::array::from_fn(|i| core::array::from_fn(|j| m[(i, j)]))
}

/// The cross-product matrix.
fn skew(w: &Vector3<f64>) -> Matrix3<f64> {
    w.cross_matrix()
}

/// Rotation by `angle` about the unit vector `axis` (Rodrigues).
fn rotation(axis: &Vector3<f64>, angle: f64) -> Matrix3<f64> {
    let (sin, cos) = angle.sin_cos();
    let k = skew(axis);
    Matrix3::identity() + k * sin + k * k * (1.0 - cos)
}
