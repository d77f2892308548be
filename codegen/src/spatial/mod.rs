//! Spatial vectors, motions, forces and moments of mass with expressions of a graph as entries. The types
//! that a mechanism uses can also have plain numbers as entries.
//!
//! A motion has an angular and a linear part. A force has a moment and a force. The angular part or the
//! moment is always first.

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
