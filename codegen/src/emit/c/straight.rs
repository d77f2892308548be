//! Functions as straight-line code; long functions are split.

use super::body::Body;
use super::context::Context;
use super::{layout, parts, public};
use crate::functions::function::Function;
use crate::program::split;

/// Factor by which a function in C may be longer than one in Rust before it is split: parts exchange values by memory, and C
/// compilers bear long functions better than rustc. `linearize` of a UR5 took 1.40 times as long as in Rust in two parts and
/// 1.05 times in one (gcc 12; clang 22: 0.95 and 0.83), and compiling its module took as long as before. Over eight states
/// it took 181 ns for each in two parts and 155 ns in one (gcc 12, AVX2).
const LONGER: usize = 5;

/// Largest number of statements of one function.
pub(super) fn longest(context: &Context<'_>) -> usize {
    context.options.longest_function.saturating_mul(LONGER)
}

/// The private functions, then the public function.
pub(super) fn items(context: &Context<'_>, function: &Function, name: &str) -> Vec<String> {
    let body = Body::new(context, &function.program);
    let (mut items, statements) =
        statements(&body, longest(context), name, || Body::new(context, &function.program));
    items.push(layout::function(&public::head(&body, name), &statements));
    items
}

/// Private functions of the parts of a long body, and statements of the function.
///
/// - `longest`: largest number of statements of a function
/// - `again`: creates the body again
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
