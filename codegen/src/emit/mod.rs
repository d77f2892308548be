//! Converts a [`Module`] to text. There is one folder per language.
//!
//! A printer makes no choices about numbers. Order, names, signs and fused operations come from the
//! [`Program`](crate::program::Program) of each function. Printed names are checked identifiers, and printed
//! texts are escaped literals or escaped documentation, so no description can insert code.

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

/// Prints a module in the language of the options. The result depends only on the arguments.
#[must_use]
pub fn module(module: &Module, options: &EmitOptions) -> SourceFile {
    match options.language {
        Language::Rust => rust::module(module, options),
        Language::C => c::module(module, options),
    }
}
