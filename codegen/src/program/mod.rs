//! Straight-line programs: the last form of a function before it is printed.
//!
//! Each instruction defines one value from earlier values, inputs, parameters or constants. Names, order,
//! signs and fused operations are final, so the printer makes no further choices.

mod angles;
pub mod arrays;
mod by_parameters;
pub mod cost;
pub mod display;
mod doubling;
pub mod expanded;
pub(crate) mod flow;
mod fuse;
pub mod interpret;
pub(crate) mod lanes;
pub(crate) mod letters;
mod lower;
mod operations;
pub(crate) mod split;
mod zeros;

pub use by_parameters::by_parameters;
pub use fuse::fuse_multiply_adds;
pub use lower::{GraphOutput, lower, lower_branches, lower_from_leaves};
pub use operations::{InputArray, Instruction, Operand, Operation, Output, Program, Shape};
pub use zeros::nonzero_entries;
