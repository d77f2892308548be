//! Spatial vectors, motions, forces and masses over scalars of a graph; those of a mechanism also over plain
//! numbers.
//!
//! A motion has an angular and a linear part, a force a moment and a force. The angular part is always first.

mod attitude;
mod matrix;
mod moments;
mod motion;
mod pose;
mod twist;
mod vector;

pub use attitude::Attitude;
pub use matrix::Matrix3;
pub use moments::MassMoments;
pub use motion::{Force, Motion};
#[cfg(test)]
pub use pose::exact_sin_cos;
pub use pose::{Pose, cleaned, rotate, rotation_about};
pub use twist::{Angle, Twist};
pub use vector::{Symmetric3, Vector3};
