//! Prints C functions as straight-line code. Long functions are split.

use super::body::Body;
use super::context::Context;
use super::{layout, parts, public};
use crate::functions::function::Function;
use crate::program::split;

/// Ratio of the largest length of a function in C to the largest length in Rust before the function is split.
/// Parts exchange values through memory, and C compilers accept longer functions than rustc. The following
/// times are those of `linearize` of a UR5, divided into two parts or in one part. The compile time of the
/// module is the same in both cases.
///
/// | | two parts | one part |
/// |---|---|---|
/// | gcc 12, relative to Rust | 1.40 | 1.05 |
/// | clang 22, relative to Rust | 0.95 | 0.83 |
/// | gcc 12, AVX2, eight states at once, per state | 181 ns | 155 ns |
const LONGER: usize = 5;

/// Largest number of statements of a function in C.
pub(super) fn longest(context: &Context<'_>) -> usize {
    context.options.longest_function.saturating_mul(LONGER)
}

/// The texts of a straight-line function: private functions for its parts, then the public function.
pub(super) fn items(context: &Context<'_>, function: &Function, name: &str) -> Vec<String> {
    let body = Body::new(context, &function.program);
    let (mut items, statements) =
        statements(&body, longest(context), name, || Body::new(context, &function.program));
    items.push(layout::function(&public::head(&body, name), &statements));
    items
}

/// The private functions into which a long function is split, and the statements of the function.
///
/// - `longest`: largest number of statements of a function
/// - `again`: creates the body again, for the parts
pub(super) fn statements<'a>(
    body: &Body<'a>,
    longest: usize,
    name: &str,
    again: impl Fn() -> Body<'a>,
) -> (Vec<String>, Vec<String>) {
    let split = split::parts(body.program, &body.flow, longest);
    let (items, statements) = match split.as_slice() {
        [_] => (vec![], body.all_statements()),
        _ => (parts::items(&again().without_stores(), name, &split), parts::calls(body, name, &split)),
    };
    (items, [body.unused(), statements].concat())
}
