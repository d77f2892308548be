//! Columns of a log: a table of quantities and words, and the search for the columns of a robot.
//!
//! Modules are listed from the lowest level to the highest one, one paragraph for each. A file imports only from levels
//! below its own level.

mod table;

mod header;

mod families;

mod pattern;

mod found;
mod robot;

mod finder;

mod efforts;
mod poses;
mod time;

mod mapping;

mod guess;

pub(super) use found::Column;
pub(crate) use found::{ColumnLabels, Labels};
pub use guess::ColumnGuess;
pub(super) use guess::guess;
pub(super) use mapping::{Mapping, resolve};
pub use pattern::ColumnOptions;
pub(super) use robot::RobotColumns;
