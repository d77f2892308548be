//! Identification of described robots: their regressors by the interpreter, and estimates as descriptions.
//!
//! The estimation is [`gelenk_identification`]'s; here stand the robot that it asks for, and what is written of
//! its results.

mod bodies;
mod robot;

pub use bodies::{BodyValues, bodies, drive};
pub use robot::{DriveParameter, InterpretedRobot};
