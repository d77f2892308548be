//! Excitation: periodic motions within the robot's limits that determine the parameters well.
//!
//! The motion of a joint is `yᵢ(t) = cᵢ + Σₖ aᵢₖ sin(k ω t) + bᵢₖ cos(k ω t)` (Swevers et al. 1997). The search varies the
//! coefficients cᵢ, aᵢₖ and bᵢₖ and minimizes minus the logarithm of the determinant of the Fisher information (D-optimality;
//! Swevers et al. 1997). The search is an evolution strategy with one parent and one child and an adapted step (Rechenberg's
//! 1/5 rule) from several starts. Every candidate is first scaled and shifted into the limits, so that the robot can make each
//! candidate motion. The search needs no derivatives of the regressor. It finds a good motion, which is not proven to be the
//! best one. For a joint with a quaternion, the sum above describes the rotation vector of its orientation.

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
