//! The generated functions: rows of a catalogue, with programs and documentation.
//!
//! [`catalogue`] has the rows, `assemble` and [`form`] make their programs, and [`selection`] chooses among
//! them.

mod assemble;
pub mod catalogue;
pub mod composition;
mod derive;
pub mod form;
pub mod function;
pub mod module_constants;
pub mod position_functions;
pub mod positions;
pub mod selection;
pub mod size;
