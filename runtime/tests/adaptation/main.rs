//! Friction that is learned while the robot moves.

#![allow(clippy::unwrap_used, reason = "test code: what cannot be set up ends the test")]

use crate::methods::random;

mod control;
mod faults;
#[path = "../../examples/support/faulty.rs"]
mod faulty;
mod functions;
mod properties;
#[path = "../../examples/support/warming.rs"]
mod warming;
