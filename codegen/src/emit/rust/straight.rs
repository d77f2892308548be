//! Prints Rust functions as straight-line code. Long functions are split.

use proc_macro2::{Ident, TokenStream};
use quote::quote;

use super::body::Body;
use super::context::Context;
use super::signature::Signature;
use super::{parts, public};
use crate::functions::function::Function;
use crate::program::split;

/// The public functions, then the private functions into which a long function is split.
pub(super) fn items(context: &Context<'_>, function: &Function, name: &Ident) -> Vec<TokenStream> {
    let body = Body::new(context, &function.program);
    let signature = Signature::new(&body);
    let split = split::parts(body.program, &body.flow, context.options.longest_function);
    let statements = match (split.len(), body.results.is_empty()) {
        (1, true) => body.returning_statements(),
        (1, false) => body.storing_statements(),
        _ => parts::calls(&body, name, &split),
    };
    let unused = parts::unused(&body, &split, body.program.entries());
    // For a robot without inputs, some matrices have no entries.
    let results = body.results.iter().zip(&body.program.outputs);
    let empty = results.filter(|(_, output)| output.entries.is_empty()).map(|(name, _)| name);
    let statements = quote!(#(let _ = #unused;)* #(let _ = #empty;)* #statements);
    let mut items = public::items(function, &body, name, &signature, &statements);
    items.extend(parts::items(&body, name, &signature, &split));
    items
}
