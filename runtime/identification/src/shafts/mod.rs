//! Drives that act on several joints, as rows of the equations of motion.
//!
//! The shaft of such a drive turns by `r · y`, and its friction brakes all of these joints: `τ = r f(r · ẏ)`. In
//! coordinates `z = C y`, where a row of C is r for each of these drives and that of the identity for every other joint,
//! the equations are
//!
//! `C⁻ᵀ (M ÿ + k − q) = C⁻ᵀ B u − f(ż)`,
//!
//! so that the row of a shaft has the torque of its motor and its friction, over its own speed, and neither of another
//! one. Inertial parameters are the same in all coordinates. Fit, choice of terms, intervals and doubts therefore are
//! those of joints.
//!
//! A shaft takes the row of a joint that has no drive of its own. Friction that the description puts on this joint is no
//! function of one row's speed. It is estimated as the inertial parameters are: its factors stay near the described ones
//! along what the data cannot tell.

mod library;
mod robot;
mod rows;
mod seats;
#[cfg(test)]
mod tests;
mod words;

pub(crate) use library::{scaled, slope};
pub use robot::RobotRows;
pub use rows::ShaftRows;
pub use seats::seats;
pub(crate) use words::in_words;

/// A drive that acts on several joints, whose friction is that of its shaft.
#[derive(Debug, Clone, PartialEq)]
pub struct Shaft {
    /// Name of the drive, as described.
    pub name: String,
    /// The joint whose row the shaft takes, see [`seats`].
    pub joint: usize,
    /// Motion of the shaft for a unit of motion of each of the N joints: gear ratio times weight [1 or rad/m].
    pub ratios: Vec<f64>,
    /// Largest torque of the motor [N·m]; infinite where it is not described.
    pub torque: f64,
}

/// A term of friction that is described on a joint whose row a shaft takes.
#[derive(Debug, Clone, PartialEq)]
pub struct JointTerm {
    /// Number of the joint.
    pub joint: usize,
    /// Function of the joint's velocity `v`, as described.
    pub basis: String,
    /// Its described factor.
    pub coefficient: f64,
}
