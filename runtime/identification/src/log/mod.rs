//! Reads logs of a robot as runs ([`super::run`]). The reader finds the robot's columns in tables from other programs.
//!
//! Nothing is repaired silently: everything that is suspicious or left out is a finding of the recording. Modules are
//! listed from the lowest level to the highest one, one paragraph for each. A file imports only from levels below its own
//! level. The modules process a log in this order:
//!
//! - `packed` and `bag`: files that are not text
//! - `sheet`: separators, header, rows
//! - `columns`: assignment of columns to quantities, units
//! - `runs`: samples, split into runs
//! - `bursts`: times of arrival
//! - `unroll`: poses with quaternions
//! - `joint_forces`: inputs at frames
//! - `health`: checks of the runs

mod levels;

mod number;
mod packed;
mod units;

mod bag;
mod bursts;
mod health;
mod joint_forces;
mod saturation;
mod seconds;
mod sheet;
mod spikes;
mod zeros;

mod columns;
mod unroll;

mod runs;

mod recording;

#[cfg(test)]
mod tests;

pub use columns::{ColumnGuess, ColumnOptions};
pub(crate) use columns::{ColumnLabels, Labels};
pub use recording::{Recording, guess_columns, runs, runs_of};
pub(crate) use recording::{hexadecimal, runs_noting};
pub(crate) use units::{are_minutes, is_seen, unit_value};
