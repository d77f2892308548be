//! Code generation for symbolic robot dynamics.
//!
//! In a build script, one line for the common case:
//!
//! ```no_run
//! // build.rs
//! gelenk_codegen::build("robot.toml");
//! ```
//!
//! and [`Builder`] for the rest. [`guide`] holds conventions and signs, how to read generated code, a glossary,
//! and how to add a joint type, a function, a printer or a friction term.

// Constants reach the generated text, so they may not depend on the platform's library. Tests compare with it.
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
