//! Methods of the paper that `gelenk identify` does not use: a smoother, friction torques of a motion, recursive least squares.
#![allow(dead_code, reason = "tests outside of the example use a part of it")]

pub mod kalman;
pub mod recursive;
pub mod torque;
