//! Generates code of a robot's equations of motion from a description of the robot.
//!
//! A build script usually needs one line:
//!
//! ```no_run
//! // build.rs
//! gelenk_codegen::build("robot.toml");
//! ```
//!
//! [`Builder`] has all options. [`guide`] documents the conventions and signs, the generated code and its
//! glossary, and how to add joint types, functions, printers and friction terms.

// Constants reach the generated text, so they may not depend on the platform's library. Only tests may use it.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod advice;
mod check;
#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "symbolica")]
pub mod closed_form;
mod description;
pub mod diagnostic;
mod distinct;
pub mod dynamics;
pub mod emit;
pub mod export;
pub mod function_names;
pub mod functions;
pub mod graph;
pub mod guide;
#[cfg(feature = "cli")]
pub mod identify;
pub mod kinematics;
mod lanes;
pub mod layout;
mod lint;
pub mod model;
pub mod module;
mod numeric;
pub mod output;
pub mod pipeline;
pub mod program;
mod random;
mod rates;
pub mod read;
mod remedies;
#[cfg(feature = "cli")]
pub mod report;

pub mod self_test;
mod snapping;
pub mod spatial;
#[cfg(test)]
mod testing;
mod tools;
pub mod verify;
mod wording;

pub use gelenk_formula as formula;
pub use output::{Builder, build};
