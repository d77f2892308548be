//! Analytic inverse kinematics of six-axis arms with a spherical wrist.
//!
//! A generated module has a pose function for each frame, for example `frame_tool_pose(y)`. The geometry of the
//! arm is computed from values of this function.

mod geometry;
mod matrices;
mod spherical_wrist;

pub use geometry::{GeometryError, Screws};
pub use matrices::Pose;
use matrices::{matrix, rotation, rows, skew, vector};
pub use spherical_wrist::{
    Branch, InverseKinematics, KinematicsError, Singularity, Solution, SphericalWrist,
};
