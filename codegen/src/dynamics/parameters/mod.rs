//! Inertial parameters: their regressor, and those that enter the motion.

pub mod base_parameters;
pub mod regressor;
