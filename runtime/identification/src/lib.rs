//! Identification: from logs to friction models that the generator reads.
//!
//! Order of work ([`identify`]): logs are read as runs of a robot ([`log`], [`run`]). Runs become equidistant and smoothed by one
//! filter, without the delay of the efforts ([`preparation`]). One weighted fit explains the efforts ([`estimation`]). A library
//! of terms is evaluated and reduced to moments ([`library`], [`moments`]), and sparse or nonlinear friction laws are fitted to
//! them ([`friction`]). Logs that are too many for one machine become sums of products that add up ([`fleet`]).

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod carried;
pub mod confidence;
pub mod constrained;
pub mod cross_validation;
pub mod description;
pub mod differentiation;
pub mod digits;
mod drift;
pub mod ensemble;
pub mod error;
pub mod estimation;
pub mod excitation;
pub mod expression;
pub mod fleet;
pub mod friction;
pub mod identify;
pub mod inertial;
mod joint_samples;
mod kernel;
pub mod lasso;
pub mod least_squares;
pub mod library;
pub mod log;
pub mod moments;
mod offset;
pub mod pose;
pub mod preparation;
pub mod random;
mod range;
pub mod result;
pub mod robot;
pub mod run;
pub mod shafts;
mod shifted;
mod spectrum;
mod statistics;
pub mod stribeck;
pub mod subset;
pub mod thresholding;
pub mod validation;
mod written;

pub use error::{IdentificationError, Result};
