//! The loop that drives a robot at a fixed rate.

mod controller;

pub use controller::{Command, Controller, ControllerFault, Cycle, Estimate};
