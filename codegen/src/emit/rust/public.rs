//! Prints the public functions of a quantity. One function returns the results. If the results are large,
//! another function writes them in place.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use super::body::{Body, tuple};
use super::doc_comment::DocComment;
use super::lints;
use super::signature::{Signature, item, zeros};
use crate::emit::documentation::{self, Labels, argument_shape, shape_text};
use crate::emit::text::code;
use crate::functions::function::Function;

/// Largest number of instructions of a function that may be inlined in other crates. A call takes about as
/// long as this number of instructions.
const INLINE_UP_TO: usize = 40;

/// The public functions of a quantity. `statements` write the results if the body has names for them;
/// otherwise they return the results.
pub(super) fn items(
    function: &Function,
    body: &Body<'_>,
    name: &Ident,
    signature: &Signature,
    statements: &TokenStream,
) -> Vec<TokenStream> {
    match body.results.is_empty() {
        true => vec![returning(function, body, name, signature, statements)],
        false => {
            let call = call(body, name);
            vec![
                returning(function, body, name, signature, &call),
                storing(body, name, signature, statements),
            ]
        }
    }
}

/// Name of the function that writes its results in place.
pub(super) fn into_name(name: &Ident) -> Ident {
    format_ident!("{}_into", name)
}

fn returning(
    function: &Function,
    body: &Body<'_>,
    name: &Ident,
    signature: &Signature,
    statements: &TokenStream,
) -> TokenStream {
    let is_short = body.program.instructions.len() <= INLINE_UP_TO || !body.results.is_empty();
    let (arguments, result) = (&signature.arguments, &signature.result);
    item(
        &documentation(function, body),
        [
            is_short.then(|| quote!(#[inline])),
            Some(quote!(#[must_use])),
            lints::for_names(body.value_names().chain(&body.arguments).chain([name])),
            lints::for_numbers(body.numbers()),
            lints::for_result(&signature.dimensions),
        ],
        &quote!(pub fn #name(#(#arguments),*) -> #result),
        statements,
    )
}

/// The function that writes its results in place. Its documentation refers to the function that returns the
/// results.
fn storing(body: &Body<'_>, name: &Ident, signature: &Signature, statements: &TokenStream) -> TokenStream {
    let into = into_name(name);
    let documentation = format!("Computes `{name}` in place. Previous values of the results are not read.");
    let arguments = &signature.arguments;
    let results = body.results.iter().zip(&signature.results);
    let results = results.map(|(name, ty)| quote!(#name: &mut #ty));
    item(
        &DocComment::new(&documentation),
        [
            lints::for_names(body.value_names().chain(&body.arguments).chain([name])),
            lints::for_numbers(body.numbers()),
            lints::for_arguments(arguments.len() + body.results.len()),
        ],
        &quote!(pub fn #into(#(#arguments,)* #(#results),*)),
        statements,
    )
}

/// Statements that call the function with results in place and then return the results.
fn call(body: &Body<'_>, name: &Ident) -> TokenStream {
    let (into, results) = (into_name(name), &body.results);
    let outputs = body.program.outputs.iter();
    let zeros = outputs.map(|output| zeros(output.shape, body.context.zero()));
    let arguments = body.arguments.iter().map(|name| quote!(#name));
    let arguments = arguments.chain(body.context.passed_parameters());
    let value = tuple(results.iter().map(|result| quote!(#result)));
    quote! {
        #(let mut #results = #zeros;)*
        #into(#(#arguments,)* #(&mut #results),*);
        #value
    }
}

fn documentation(function: &Function, body: &Body<'_>) -> DocComment {
    let inputs = body.program.inputs.iter().zip(&body.arguments);
    let outputs = body.program.outputs.iter();
    let results = outputs.map(|output| {
        let shape = match shape_text(&output.shape.extents()) {
            lengths if lengths.is_empty() => lengths,
            lengths => format!(": [{lengths}]"),
        };
        format!("returns {}", code(&format!("{}{shape}", output.name)))
    });
    DocComment::of(&documentation::of_function(
        function,
        &Labels {
            arguments: inputs
                .map(|(input, name)| format!("`{name}: [{}]`", argument_shape(input.extent)))
                .collect(),
            has_parameters: body.context.has_parameters(),
            results: results.collect(),
            stack: None,
        },
    ))
}
