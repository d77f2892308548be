//! The texts for positions on a manifold: against Pinocchio's values, series and closed forms that share nothing with
//! them.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "manifold/body.rs"]
mod body;
#[path = "manifold/hold.rs"]
mod hold;
#[path = "manifold/pinocchio.rs"]
mod pinocchio;
#[path = "manifold/positions.rs"]
mod positions;
#[path = "manifold/random.rs"]
mod random;
#[path = "manifold/steps.rs"]
mod steps;
#[path = "manifold/tangents.rs"]
mod tangents;
#[path = "manifold/texts.rs"]
mod texts;
