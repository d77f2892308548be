//! Stage 5: a [`Module`] becomes text, one folder for each language.
//!
//! A printer decides nothing about numbers: order, names, signs and fused operations come from the
//! [`Program`](crate::program::Program) of each function. It guards what must hold for any description: names
//! reach the text as checked identifiers, text only as escaped literals and escaped documentation.

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
pub use options::{Companion, EmitOptions, Language, Math, Scalar, SourceFile};
pub use rust::documentation;

use crate::module::Module;

/// Writes a module in the language of the options. The text depends on the arguments alone.
#[must_use]
pub fn module(module: &Module, options: &EmitOptions) -> SourceFile {
    match options.language {
        Language::Rust => rust::module(module, options),
        Language::C => c::module(module, options),
    }
}
