//! Excitation: periodic motions that show the parameters well, within the robot's limits.
//!
//! `yᵢ(t) = cᵢ + Σₖ aᵢₖ sin(k ω t) + bᵢₖ cos(k ω t)` (Swevers et al. 1997). A criterion of the regressor along
//! the motion is minimized over the coefficients: its condition number (Gautier and Khalil 1992), or minus the
//! logarithm of the determinant of the Fisher information (D-optimality; Swevers et al. 1997). The search is an
//! evolution strategy with one parent and one child and adapted step (Rechenberg's 1/5 rule) from several
//! starts. Every candidate is first shrunk and shifted into the limits, so each is a motion that the robot
//! can make; the search needs no derivatives of the regressor and finds a good motion, not a proven best one.
//! Joints with a quaternion move by their rotation vectors.

mod approach;
mod chart;
mod columns;
mod design;
mod inputs;
mod levels;
mod motion;
mod motors;
mod plan;
mod refusals;
mod search;
mod settings;
mod smallest_inputs;
#[cfg(test)]
mod tests;
mod usable;

pub use super::robot::Instant;
pub use approach::Approach;
pub use design::PlannedShaft;
pub use inputs::PlannedInput;
pub use motion::FourierMotion;
pub use plan::{Plan, plan};
pub use search::Excitation;
use search::ExcitationLimits;
pub use settings::PlanSettings;
