//! Functions as straight-line code, split where they are long.

use super::body::Body;
use super::context::Context;
use super::{layout, parts, public};
use crate::functions::function::Function;
use crate::program::split;

/// The private functions, then the public one.
pub(super) fn items(context: &Context<'_>, function: &Function, name: &str) -> Vec<String> {
    let body = Body::new(context, &function.program);
    let split = split::parts(body.program, &body.flow, context.options.longest_function);
    let unused = body.unused();
    let (mut items, statements) = match split.as_slice() {
        [_] => (vec![], body.all_statements()),
        _ => (parts::items(context, &function.program, name, &split), parts::calls(&body, name, &split)),
    };
    let head = public::head(&body, name);
    items.push(layout::function(&head, &[unused, statements].concat()));
    items
}
