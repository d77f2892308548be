//! Stage 3: kinematics become the functions to emit, each with its program and what its documentation says.

pub mod function;
