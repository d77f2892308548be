//! Stage 2: a model becomes a [`Mechanism`]: moving bodies only, each with one coordinate, in frames that make the
//! equations short.
//!
//! What is fixed or held is lumped into the body that carries it; link frames follow the modified Denavit–Hartenberg
//! convention (Craig 1986; Khalil and Kleinfinger 1986), whatever the description used; inertial constants that act
//! only through sums move towards the base.

mod frames;
mod inertia;
mod mechanism;
mod pose;
mod tree;

pub use inertia::{MassMoments, RegroupChoice, SHORTEST_LEVER};
pub use mechanism::{Angle, Body, JointAxis, Mechanism, Rotor, Twist};
#[cfg(test)]
pub use pose::exact_sin_cos;
pub use pose::{ScalarPose, lower, lower_with, rotate};
pub use tree::described_moments;
