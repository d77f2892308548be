//! Stage 3: kinematics become the functions to emit, each with its program and what its documentation says.

pub mod catalogue;
pub mod composite;
pub mod derivatives;
#[cfg(test)]
mod derivatives_test;
pub mod equations;
pub mod factorization;
pub mod forces;
pub mod formulation;
pub mod frame_motion;
pub mod function;
pub mod newton_euler;
pub mod placement;
pub mod size;
