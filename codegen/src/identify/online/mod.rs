//! Replay of logs through the friction estimator of the control loop ([`gelenk_adaptation`]), and batch laws
//! for comparison.
//!
//! The estimator is the same code as in the control loop, and its measurements come from the log. Its numbers
//! therefore have the same bits as in the control loop, if the log has every period, the loop accepted all
//! positions, and the efforts are the inputs that the loop wrote.

mod batch;
mod described;
mod page;
mod replay;

pub use described::DescribedForces;
pub use page::{OnlineJoint, online_page};
pub use replay::{Replay, replay};
