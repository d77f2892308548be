//! Drives that act on several joints, as rows of the equations of motion.
//!
//! The shaft of such a drive turns by `r · y` with the ratios r and the joint positions y. The friction f of the shaft brakes
//! all of these joints with the forces `r f(r · ẏ)`. The matrix C of the coordinates `z = C y` has a row r for each of these
//! drives, and a row of the identity for every other joint. The equations are
//!
//! `C⁻ᵀ (M ÿ + k − q) = C⁻ᵀ B u − f(ż)`.
//!
//! with the mass matrix M, the bias force k, gravity and other forces q, and the forces B u of the inputs u.
//! The row of a shaft then contains the torque of its motor, and its friction as a function of its speed. It
//! contains no torque or friction of other drives. Inertial parameters are the same in all coordinates. So
//! the fit, the choice of terms, the intervals and the findings are the same as for joints.
//!
//! A shaft replaces a joint without a separate drive: the equation of the shaft takes the row of this joint. Described
//! friction of the joint does not depend on the speed of a single row. Therefore its factors are estimated like inertial
//! parameters. They stay near the described factors in directions that the data do not determine.

mod found;
mod robot;
mod rows;
#[cfg(test)]
mod tests;

pub use super::robot::{JointTerm, Shaft};
pub(crate) use robot::RobotRows;
pub(crate) use rows::ShaftRows;

use super::robot::Robot;

/// Returns the robot as the estimate uses it: shafts of drives replace some joints in the rows of the equations. The parameters
/// are the inertial parameters, then the factors of the described friction of these joints.
#[must_use]
pub fn with_rows_of_shafts(robot: &dyn Robot) -> impl Robot + '_ {
    RobotRows::of(robot)
}
