//! Drives that act on several joints, as rows of the equations of motion.
//!
//! The shaft of such a drive turns by `r · y`, and its friction brakes all of these joints: `τ = r f(r · ẏ)`. In
//! coordinates `z = C y`, the row of C is r for each of these drives and that of the identity for every other joint.
//! The equations are
//!
//! `C⁻ᵀ (M ÿ + k − q) = C⁻ᵀ B u − f(ż)`,
//!
//! The row of a shaft then has the torque of its motor and its friction over its own speed, and neither of another
//! one. Inertial parameters are the same in all coordinates. Fit, choice of terms, intervals and doubts therefore are
//! those of joints.
//!
//! A shaft takes the row of a joint that has no drive of its own. Friction that the description puts on this joint does
//! not depend on one row's speed alone. It is estimated as the inertial parameters are: its factors stay near the described
//! ones along directions that the data do not determine.

mod found;
mod robot;
mod rows;
#[cfg(test)]
mod tests;

pub use super::robot::{JointTerm, Shaft};
pub(crate) use robot::RobotRows;
pub(crate) use rows::ShaftRows;

use super::robot::Robot;

/// The robot as its estimate sees it: with shafts in place of some joints. Behind the inertial parameters stand the factors of
/// the friction that is described on these joints.
#[must_use]
pub fn with_rows_of_shafts(robot: &dyn Robot) -> impl Robot + '_ {
    RobotRows::of(robot)
}
