//! Prints declaration and head of a public C function.

use super::body::Body;
use super::context::Context;
use super::{comment, signature};
use crate::emit::documentation::{self, Labels, argument_shape};
use crate::functions::function::Function;

/// Declaration of a public function with its documentation, for the header.
///
/// - `stack`: sentence about the stack size
pub(super) fn declaration(context: &Context<'_>, function: &Function, name: &str, stack: String) -> String {
    let face = function.program.face();
    let body = Body::new(context, &face);
    let inputs = face.inputs.iter().zip(&body.names.arguments);
    let labels = Labels {
        arguments: inputs
            .map(|(input, name)| format!("`{name}: [{}]`", argument_shape(input.extent)))
            .collect(),
        has_parameters: context.has_parameters(),
        results: signature::result_labels(&body),
        stack: Some(stack),
    };
    let documentation = comment::documentation(&documentation::of_function(function, &labels));
    format!("{documentation}{}\n", signature::head(&body, name, ";"))
}

/// Head of a C function: type, name and arguments.
pub(super) fn head(body: &Body<'_>, name: &str) -> String {
    signature::head(body, name, "")
}
