//! Prints the bodies of functions over lanes (eight states at once). A body is a function of one state that
//! is called in a loop.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use super::super::body::Body;
use super::super::doc_comment::DocComment;
use super::super::lints;
use super::super::parts::{Taken, array, values};
use super::super::signature::{Signature, item};
use crate::program::lanes::Plan;
use crate::program::split::Part;

/// Name of the function for one state that computes the part with this index.
pub(super) fn body_name(name: &Ident, plan: &Plan, index: usize) -> Ident {
    match plan.parts.len() {
        1 => format_ident!("{}_body", name),
        _ => format_ident!("{}_body_{}", name, index + 1),
    }
}

/// Arguments of the function for one state that computes a part.
fn arguments(taken: Taken, results: impl Iterator<Item = TokenStream>) -> Vec<TokenStream> {
    let values = taken.values.into_iter();
    let read = values.chain(taken.inputs).chain(taken.parameters);
    read.chain(results).collect()
}

/// The functions for one state, one for each part of a function that evaluates eight states at once.
pub(super) fn items(body: &Body<'_>, name: &Ident, signature: &Signature, plan: &Plan) -> Vec<TokenStream> {
    let parts = 0..plan.parts.len();
    parts.map(|index| part(body, name, signature, plan, index)).collect()
}

fn part(body: &Body<'_>, name: &Ident, signature: &Signature, plan: &Plan, index: usize) -> TokenStream {
    let part = &plan.parts[index];
    let returns_result = index + 1 == plan.parts.len() && body.results.is_empty();
    let callee = body_name(name, plan, index);
    let results = part.results.iter().map(|&(result, _)| {
        let (name, ty) = (&body.results[result], &signature.results[result]);
        quote!(#name: &mut #ty)
    });
    let arguments = arguments(Taken::declared(body, part, signature), results);
    let arrow = match (returns_result, part.returns.as_slice()) {
        (true, _) => {
            let result = &signature.result;
            quote!(-> #result)
        }
        (false, []) => quote!(),
        (false, returns) => {
            let ty = array(body, returns);
            quote!(-> #ty)
        }
    };
    let results = part.results.iter().map(|&(result, _)| &body.results[result]);
    let names = body.value_names_in(part.range.clone());
    let names = names.chain(part.takes.iter().map(|&value| body.name(value)));
    let names = names.chain(results).chain(&body.arguments).chain([name]);
    let documentation = match plan.parts.len() {
        1 => format!("`{name}` from sines and cosines."),
        _ => format!("Part {} of `{name}` from sines, cosines and values of earlier parts.", index + 1),
    };
    item(
        &DocComment::new(&documentation),
        [
            Some(quote!(#[inline(always)])),
            lints::for_names(names),
            lints::for_numbers(body.numbers()),
            lints::for_result(&signature.dimensions).filter(|_| returns_result),
            lints::for_arguments(arguments.len()),
        ],
        &quote!(fn #callee(#(#arguments),*) #arrow),
        &part_statements(body, plan, part, index + 1 == plan.parts.len()),
    )
}

/// Statements of one part of a function that evaluates eight states at once. The last part also contains the
/// result entries that are numbers, inputs, sines or cosines.
fn part_statements(body: &Body<'_>, plan: &Plan, part: &Part, is_last: bool) -> TokenStream {
    let statements = body.statements_among(part.range.clone(), |index| plan.is_in_part[index]);
    match (is_last, body.results.is_empty()) {
        (true, true) => body.returning(statements),
        (true, false) => {
            let is_other = |entry| body.made(entry).is_none_or(|made| !plan.is_in_part[made]);
            let others = body.stores(is_other);
            quote!(#(#others)* #(#statements)*)
        }
        (false, _) if part.returns.is_empty() => quote!(#(#statements)*),
        (false, _) => {
            let returns = values(body, &part.returns);
            quote!(#(#statements)* #returns)
        }
    }
}
