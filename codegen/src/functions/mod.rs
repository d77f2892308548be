//! The functions that are generated: rows of a catalogue, each with its program and what its documentation
//! says.
//!
//! [`catalogue`] holds the rows, `assemble` and [`form`] make their programs, [`selection`] chooses among
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
