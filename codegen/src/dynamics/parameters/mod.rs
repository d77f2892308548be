//! Inertial parameters, their regressor, and base parameters.

pub mod base_parameters;
pub mod regressor;
