//! Replay of logs through the estimator of the control loop, [`gelenk_adaptation`], and batch laws to compare it with.
//!
//! The same code runs as in the loop. Measurements are the log's, so every number of the estimator has the bits that it had in the
//! loop, if the log has every period, its positions were believed, and the efforts are the inputs that the loop wrote.

mod batch;
mod described;
mod page;
mod replay;

pub use described::DescribedForces;
pub use page::{OnlineJoint, online_page};
pub use replay::{Replay, replay};
