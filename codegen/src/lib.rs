//! Code generation for symbolic robot dynamics.

pub mod dynamics;
pub mod formula;
pub mod model;
pub mod program;
