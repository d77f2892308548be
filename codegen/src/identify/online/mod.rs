//! Replay of logs through the friction estimator of the control loop ([`gelenk_adaptation`]). For comparison,
//! friction laws are also fitted to whole intervals of the log (batch laws).
//!
//! The estimator is the same code as in the control loop, but its measurements come from the log. Its results
//! have the same bits as in the control loop if three conditions hold:
//!
//! - The log has every period.
//! - The control loop accepted all positions.
//! - The efforts of the log are the inputs that the control loop wrote.

mod batch;
mod described;
mod page;
mod replay;

pub use described::DescribedForces;
pub use page::{OnlineJoint, online_page};
pub use replay::{Replay, replay};
