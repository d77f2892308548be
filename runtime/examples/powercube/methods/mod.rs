//! Methods of the paper that `gelenk identify` does not use: a smoother and friction torques of a motion.
#![allow(dead_code, reason = "tests outside of the example use a part of it")]

pub mod kalman;
pub mod torque;
