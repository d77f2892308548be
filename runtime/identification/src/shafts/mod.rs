//! Drives that act on several joints, as rows of the equations of motion.
//!
//! The shaft of such a drive turns by `r · y` with the ratios r, and its friction f brakes all of these joints: `τ = r f(r ·
//! ẏ)`. Coordinates `z = C y` have a row r of C for each of these drives, and a row of the identity for every other joint.
//! The equations are
//!
//! `C⁻ᵀ (M ÿ + k − q) = C⁻ᵀ B u − f(ż)`.
//!
//! The row of a shaft then has the torque of its motor and its friction over its own speed, and the torque and friction of
//! no other drive. Inertial parameters are the same in all coordinates. So fit, choice of terms, intervals and doubts are
//! the same as for joints.
//!
//! A shaft takes the row of a joint that has no drive of its own. Described friction of this joint does not depend on the
//! speed of a single row. It is estimated like the inertial parameters: its factors stay near the described ones along
//! directions that the data do not determine.

mod found;
mod robot;
mod rows;
#[cfg(test)]
mod tests;

pub use super::robot::{JointTerm, Shaft};
pub(crate) use robot::RobotRows;
pub(crate) use rows::ShaftRows;

use super::robot::Robot;

/// The robot as the estimate uses it: shafts take the rows of some joints. The factors of the described friction of these
/// joints follow the inertial parameters.
#[must_use]
pub fn with_rows_of_shafts(robot: &dyn Robot) -> impl Robot + '_ {
    RobotRows::of(robot)
}
