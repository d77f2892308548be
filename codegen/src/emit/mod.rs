//! Stage 5: converts a [`Module`] to text; one folder per language.
//!
//! A printer decides nothing about numbers: order, names, signs and fused operations come from the
//! [`Program`](crate::program::Program) of each function. It ensures for any description that names are
//! printed only as checked identifiers, and texts only as escaped literals or escaped documentation.

mod arrays;
mod c;
mod documentation;
mod header;
pub mod interface;
mod kernels;
mod names;
mod options;
pub mod rust;
mod sequence;
mod text;

pub use header::{FIRST_LINE, FIRST_LINE_IN_PYTHON};
pub use options::{Companion, EmitOptions, Language, Scalar, SourceFile};
pub use rust::documentation;

use crate::module::Module;

/// Prints a module in the language of the options. The text depends only on the arguments.
#[must_use]
pub fn module(module: &Module, options: &EmitOptions) -> SourceFile {
    match options.language {
        Language::Rust => rust::module(module, options),
        Language::C => c::module(module, options),
    }
}
