//! Identification of described robots: their regressors by the interpreter, and estimates as descriptions.
//!
//! The estimation is [`gelenk_identification`]'s; here stand the robot that it asks for, and what is written of
//! its results.

mod bodies;
mod drives;
mod robot;

pub use bodies::{BodyValues, bodies};
pub use drives::{IdentifiedDrive, drives, rotors};
pub use robot::InterpretedRobot;
