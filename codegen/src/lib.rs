//! Code generation for symbolic robot dynamics.

pub mod diagnostic;
pub mod dynamics;
pub mod formula;
pub mod graph;
pub mod kinematics;
pub mod model;
pub mod program;
#[cfg(test)]
mod testing;
