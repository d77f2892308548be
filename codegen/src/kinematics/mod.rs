//! Stage 2: a model becomes a [`Mechanism`], a plain value: moving bodies only, which follow coordinates, in
//! frames that make the equations short. Each function takes it [onto its graph](Mechanism::on).
//!
//! What is fixed or held is lumped into the body that carries it; link frames follow the modified
//! Denavit–Hartenberg convention (Craig 1986; Khalil and Kleinfinger 1986), whatever the description used;
//! inertial constants that act only through sums move towards the base.

mod build;
mod frames;
mod inertia;
mod joint;
mod lower;
mod mechanism;
mod number;
mod quaternion;
mod transmission;
mod tree;

pub use inertia::{RegroupChoice, SHORTEST_LEVER};
pub use joint::JointAxis;
pub use lower::{lower, lower_followed, lower_pose, lower_with};
pub use mechanism::{Body, Mechanism, Rotor};
pub use number::{Number, Numbers};
pub use quaternion::{ChainPlace, POSITIONS, PositionEntries, position_entries};
pub use transmission::{Followed, Transmission};
pub use tree::described_moments;
