//! Converts a model to a [`Mechanism`]: the moving bodies, in frames that give short equations. Each function
//! copies the mechanism [to its graph](Mechanism::on).
//!
//! Fixed and held links become part of the body that carries them. Link frames follow the modified
//! Denavit–Hartenberg convention (Craig 1986; Khalil and Kleinfinger 1986), regardless of the frames in the
//! description. Inertial constants that act only as sums are shifted towards the base.

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
