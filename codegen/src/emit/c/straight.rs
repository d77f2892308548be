//! Functions as straight-line code, split where they are long.

use super::body::Body;
use super::context::Context;
use super::{layout, parts, public};
use crate::functions::function::Function;
use crate::program::split;

/// The private functions, then the public one.
pub(super) fn items(context: &Context<'_>, function: &Function, name: &str) -> Vec<String> {
    let body = Body::new(context, &function.program);
    let longest = context.options.longest_function;
    let (mut items, statements) = statements(&body, longest, name, || Body::new(context, &function.program));
    items.push(layout::function(&public::head(&body, name), &statements));
    items
}

/// The private functions of a body's parts, where it is long, and the statements of the function.
///
/// - `longest`: so many statements stay one function
/// - `again`: makes the body once more
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
