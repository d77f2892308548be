//! Stage 3: kinematics become the functions to emit, each with its program and what its documentation says.

pub mod array_form;
pub mod articulated;
pub mod base_parameters;
pub mod catalogue;
pub mod composite;
pub mod composition;
pub mod derivatives;
#[cfg(test)]
mod derivatives_test;
pub mod equations;
pub mod factorization;
pub mod forces;
pub mod formulation;
pub mod frame_motion;
pub mod function;
pub mod hessian;
pub mod matrix;
pub mod module_constants;
pub mod newton_euler;
pub mod per_joint;
pub mod placement;
pub mod regressor;
mod rotor;
pub mod selection;
pub mod size;
