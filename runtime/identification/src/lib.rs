//! Identification of friction and inertial parameters from logs of robots, as a description that the generator reads.
//!
//! [`identify`] works in these stages:
//! - [`log`] reads logs as [runs](run) of a robot.
//! - [`preparation`] resamples the runs, smooths them by one filter and removes the delay of the efforts.
//! - [`estimation`] explains the efforts by one weighted fit.
//! - [`methods`] evaluate a library of friction terms, and [`friction`] fits sparse or nonlinear friction laws.
//! - [`fleet`] replaces logs that are too many for one machine by sums of products, which can be added.

#![warn(unreachable_pub)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod doubts;
mod error;
pub mod estimation;
pub mod excitation;
pub mod fleet;
pub mod friction;
pub mod identify;
pub mod inertial;
pub mod log;
pub mod methods;
mod numeric;
pub mod payload;
pub mod pose;
pub mod preparation;
pub mod result;
pub mod robot;
pub mod run;
pub mod shafts;
pub mod validation;

pub use error::{IdentificationError, Result};
