//! Public part of a function.

use super::body::Body;
use super::context::Context;
use super::{comment, signature};
use crate::emit::documentation::{self, Labels, argument_shape};
use crate::functions::function::Function;

/// The declaration of a function with its documentation.
///
/// - `stack`: sentence about the stack
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

/// Head of the function, before its body.
pub(super) fn head(body: &Body<'_>, name: &str) -> String {
    signature::head(body, name, "")
}
