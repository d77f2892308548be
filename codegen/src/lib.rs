//! Code generation for symbolic robot dynamics.

pub mod dynamics;
pub mod formula;
pub mod math;
pub mod model;
pub mod program;
