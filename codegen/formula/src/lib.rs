//! The formula language of gelenk. Formulas are force laws and numbers of descriptions, terms of libraries, and
//! selections of rows of logs.
//!
//! An [`Expression`] is a parsed text: names, numbers, operators and functions with their positions in the
//! text. A [`Formula`] is an expression with resolved names (parameters, position, velocity) and folded
//! constants. [`parse`] reads a formula, and [`Formula::text`] writes it. Selections (`abs(v) > 0.05 && y < 1`)
//! are expressions with truth values, which cannot become formulas. A [`FrictionLaw`] is read by the generator
//! and written by identification.

// Constants reach the generated text, so they may not depend on the platform's library. Tests compare with it.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod arithmetic;
mod display;
mod energy;
mod error;
mod expression;
mod formula;
mod friction;
mod function;
mod habits;
mod hold;
mod nearest;
mod resolve;
mod syntax;
mod terms;

pub use error::FormulaError;
pub use expression::{Expression, Kind, Node, Operator, Unary};
pub use formula::{Formula, LARGEST_NUMBER, too_large};
pub use friction::{FrictionLaw, FrictionPart, FrictionTerm, TermOf, toml_text};
pub use function::Function;
pub use hold::Hold;
pub use nearest::nearest;
pub use resolve::{Allowed, parse};
