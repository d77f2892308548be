//! Stage 5: a [`Module`](crate::module::Module) becomes text, one folder for each language.
//!
//! A printer decides nothing about numbers: order, names, signs and fused operations come from the
//! [`Program`](crate::program::Program) of each function. It guards what must hold for any description: names
//! reach the text as checked identifiers, text only as escaped literals and escaped documentation.

mod arrays;
mod documentation;
mod header;
mod kernels;
mod names;
mod options;
pub mod rust;
mod sequence;
mod text;

pub use options::{EmitOptions, Math, Scalar, SourceFile};
pub use header::FIRST_LINE;
pub use rust::{documentation, module};
