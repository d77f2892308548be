//! Friction that is learned while the robot moves: an option of the loop.
//!
//! The estimator, its steps and its limits are those of [`gelenk_adaptation`]. [`Adaptive`] wraps a controller and gives its model the
//! laws that act, as [`LearnedFriction`]. [`Carrying`] learns a load too. Without it, nothing is learned.

mod carrying;
mod controller;
mod model;

pub use carrying::Carrying;
pub use controller::{Adaptive, TakesModel, TorqueSource};
pub use gelenk_adaptation::{
    Adaptation, AdaptationError, AdaptationSettings, DescribedForces, JointScale, JointState, LoadEstimator,
    LoadState, MOST_DELAY, Magnitudes, Measured, Prediction, TERM_NAMES, TERMS, Trust, terms,
};
pub use model::LearnedFriction;
