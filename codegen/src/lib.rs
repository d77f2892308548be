//! Code generation for symbolic robot dynamics.

pub mod diagnostic;
pub mod dynamics;
pub mod formula;
pub mod model;
pub mod program;
