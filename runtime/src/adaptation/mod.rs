//! Learning of friction during motion, an option of the control loop.
//!
//! - [`gelenk_adaptation`] documents the estimator, its steps and its limits.
//! - [`Adaptive`] wraps a controller and passes the acting friction laws to its model ([`LearnedFriction`]).
//! - [`Carrying`] also learns parameters of a load.

mod carrying;
mod controller;
mod model;

pub use carrying::Carrying;
pub use controller::{Adaptive, TakesModel, TorqueSource};
pub use gelenk_adaptation::{
    Adaptation, AdaptationError, AdaptationSettings, DescribedForces, JointScale, JointState, LoadEstimator,
    LoadState, MOST_DELAY, Magnitudes, Measured, Prediction, TERM_NAMES, TERMS, TermState, Trust, terms,
};
pub use model::LearnedFriction;
