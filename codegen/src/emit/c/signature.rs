//! Prints arguments and results of a C function.

use super::body::{Body, returns_number};
use super::context::Context;
use super::layout;
use crate::emit::documentation::shape_text;
use crate::emit::text::code;

/// Declaration of an argument that the function only reads.
pub(super) fn read(context: &Context<'_>, name: &str) -> String {
    pointer(context, &format!("const {}", context.ty()), name)
}

/// Declaration of an argument to which a result is written.
pub(super) fn written(context: &Context<'_>, name: &str) -> String {
    pointer(context, context.ty(), name)
}

/// Declaration of a pointer with the type `ty`. Other pointers of the function must not point to the same
/// memory (`restrict`).
pub(super) fn pointer(context: &Context<'_>, ty: &str, name: &str) -> String {
    format!("{ty} *{} {name}", context.constant("RESTRICT"))
}

/// Declarations of all arguments of a C function: inputs, free parameters, results.
pub(super) fn arguments(body: &Body<'_>) -> Vec<String> {
    let inputs = inputs(body);
    let results = body.names.results.iter().map(|name| written(body.context, name));
    inputs.into_iter().chain(results).collect()
}

/// Declarations of a function's inputs and free parameters.
pub(super) fn inputs(body: &Body<'_>) -> Vec<String> {
    let inputs = body.names.arguments.iter().map(|name| read(body.context, name));
    inputs.chain(body.context.declared_parameters()).collect()
}

/// Head of a public C function, followed by `tail`.
pub(super) fn head(body: &Body<'_>, name: &str, tail: &str) -> String {
    let ty = if returns_number(body.program) { body.context.ty() } else { "void" };
    layout::call(0, &format!("{ty} {name}"), &arguments(body), tail)
}

/// Names and shapes of the results in the documentation.
pub(super) fn result_labels(body: &Body<'_>) -> Vec<String> {
    let outputs = body.program.outputs.iter();
    if body.names.results.is_empty() {
        return outputs.map(|output| format!("returns {}", code(&output.name))).collect();
    }
    let named = outputs.zip(&body.names.results);
    named
        .map(|(output, name)| result_label(name, &output.name, &shape_text(&output.shape.extents())))
        .collect()
}

/// Name and shape of a result in the documentation, for a result that is written through an argument.
pub(super) fn result_label(name: &str, symbol: &str, shape: &str) -> String {
    let shape = if shape.is_empty() { "1" } else { shape };
    let symbol = if symbol == name { String::new() } else { format!(", {}", code(symbol)) };
    format!("result `{name}: [{shape}]`{symbol}")
}
