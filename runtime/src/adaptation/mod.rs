//! Friction that is learned while the robot moves: an option of the loop.
//!
//! The estimator, its steps and its limits are those of [`gelenk_adaptation`]. [`Adaptive`] wraps a controller and gives its model the
//! laws that act, as [`LearnedFriction`]. Without it, nothing is learned.

mod controller;
mod model;

pub use controller::{Adaptive, TakesModel, TorqueSource};
pub use gelenk_adaptation::{
    Adaptation, AdaptationError, AdaptationSettings, DescribedForces, JointScale, JointState, MOST_DELAY,
    Magnitudes, Measured, Prediction, TERM_NAMES, TERMS, Trust, terms,
};
pub use model::LearnedFriction;
