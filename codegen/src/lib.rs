//! Code generation for symbolic robot dynamics.

pub mod dynamics;
pub mod emit;
pub mod formula;
pub mod model;
pub mod output;
pub mod program;
