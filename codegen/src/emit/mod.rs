//! Stage 5: a [`Module`](crate::module::Module) becomes text, one folder for each language.
//!
//! A printer decides nothing about numbers: order, names, signs and fused operations come from the
//! [`Program`](crate::program::Program) of each function. It guards what must hold for any description: names
//! reach the text as checked identifiers, text only as escaped literals and escaped documentation.

mod options;
pub mod rust;

pub use options::{EmitOptions, Math, Scalar, SourceFile};
pub use rust::{FIRST_LINE, documentation, module};
