//! Identification: from logs to friction models that the generator reads.
//!
//! Order of work ([`identify`]): logs are read as runs of a robot ([`log`], [`run`]). Runs become equidistant and smoothed by one
//! filter, without the delay of the efforts ([`preparation`]). One weighted fit explains the efforts ([`estimation`]). A library
//! of terms is evaluated and reduced to moments ([`methods`]), and sparse or nonlinear friction laws are fitted to them
//! ([`friction`]). Logs that are too many for one machine become sums of products that add up ([`fleet`]).

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
