//! The generated functions: rows of a catalogue, with programs and documentation.
//!
//! [`catalogue`] contains the rows, `assemble` and [`form`] derive programs from them, and [`selection`]
//! selects the functions of a module.

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
