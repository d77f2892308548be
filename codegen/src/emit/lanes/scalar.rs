//! The bodies of a function, and the scalar function that calls them.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::super::body::Body;
use super::super::doc_comment::DocComment;
use super::super::function::{Signature, returned_value};
use super::super::{Context, into, lints};
use super::body_name;
use super::plan::{Part, Plan};

/// The statements of the scalar function: its angles, then the bodies.
pub(in crate::emit) fn statements(
    context: &Context<'_>,
    body: &Body<'_>,
    name: &Ident,
    plan: &Plan,
) -> TokenStream {
    let end = plan.angles.last().map_or(0, |&last| last + 1);
    let angles =
        body.statements_without_stores(0..end, |index| plan.angles.binary_search(&index).is_ok());
    let calls = plan.parts.iter().enumerate().map(|(index, part)| {
        let callee = body_name(name, plan, index);
        let takes = part.takes.iter().map(|&value| body.name(value));
        let takes = (!part.takes.is_empty()).then(|| quote!([#(#takes),*],));
        let inputs = part.inputs.iter().map(|&input| &body.arguments[input]);
        let parameters = takes_parameters(context, part).then(|| quote!(p,));
        let results = part
            .results
            .iter()
            .map(|(result, _)| &body.results[*result]);
        let call = quote!(#callee(#takes #(#inputs,)* #parameters #(#results),*));
        let returns = part.returns.iter().map(|&value| body.name(value));
        match (index + 1 == plan.parts.len(), part.returns.is_empty()) {
            (true, _) => call,
            (false, true) => quote!(#call;),
            (false, false) => quote!(let [#(#returns),*] = #call;),
        }
    });
    quote!(#(#angles)* #(#calls)*)
}

/// Whether a body is called with the free parameters.
pub(super) fn takes_parameters(context: &Context<'_>, part: &Part) -> bool {
    part.reads_parameters && context.has_parameters()
}

/// One function for each part.
pub(super) fn items(
    context: &Context<'_>,
    body: &Body<'_>,
    name: &Ident,
    signature: &Signature,
    plan: &Plan,
) -> Vec<TokenStream> {
    let parts = 0..plan.parts.len();
    parts
        .map(|index| item(context, body, name, signature, plan, index))
        .collect()
}

fn item(
    context: &Context<'_>,
    body: &Body<'_>,
    name: &Ident,
    signature: &Signature,
    plan: &Plan,
    index: usize,
) -> TokenStream {
    let part = &plan.parts[index];
    let is_last = index + 1 == plan.parts.len();
    let ty = context.options.scalar.ty();
    let callee = body_name(name, plan, index);
    let takes: Vec<&Ident> = part.takes.iter().map(|&value| body.name(value)).collect();
    let count = Literal::usize_unsuffixed(takes.len());
    let taken = (!takes.is_empty()).then(|| quote!([#(#takes),*]: [#ty; #count]));
    let inputs = part
        .inputs
        .iter()
        .map(|&input| signature.arguments[input].clone());
    let parameters = takes_parameters(context, part).then(|| quote!(p: &Parameters));
    let results = part.results.iter().map(|(result, _)| {
        let (name, ty) = (&body.results[*result], &signature.results[*result]);
        quote!(#name: &mut #ty)
    });
    let arguments: Vec<TokenStream> = taken
        .into_iter()
        .chain(inputs)
        .chain(parameters)
        .chain(results)
        .collect();
    let returns = part.returns.iter().map(|&value| body.name(value));
    let count = Literal::usize_unsuffixed(part.returns.len());
    let (arrow, value) = match (is_last, body.results.is_empty(), part.returns.is_empty()) {
        (true, true, _) => {
            let (result, value) = (&signature.result, body.returned());
            (quote!(-> #result), value)
        }
        (true, false, _) | (false, _, true) => (quote!(), quote!()),
        (false, _, false) => (quote!(-> [#ty; #count]), quote!([#(#returns),*])),
    };
    // Entries that no part makes: numbers, inputs, sines and cosines.
    let others = (is_last && !body.results.is_empty())
        .then(|| into::stores(body, |made| made.is_none_or(|made| !plan.is_in_part[made])));
    let others = others.into_iter().flatten();
    let mut statements = body.statements_among(part.range.clone(), |index| plan.is_in_part[index]);
    let last = returned_value(body).filter(|&last| is_last && plan.is_in_part[last]);
    let last = last.and_then(|last| body.expression(body.program.instructions[last].operation));
    if last.is_some() {
        statements.pop();
    }
    let value = last.unwrap_or(value);
    let documentation = match plan.parts.len() {
        1 => format!("`{name}` from sines and cosines."),
        _ => format!(
            "Part {} of `{name}` from sines, cosines and what earlier parts made.",
            index + 1
        ),
    };
    let documentation = DocComment::new(&documentation).tokens();
    let names = body.value_names_in(part.range.clone());
    let results = part
        .results
        .iter()
        .map(|(result, _)| &body.results[*result]);
    let names = names.chain(takes.iter().copied()).chain(results);
    let allowed = [
        lints::for_names(names.chain(&body.arguments).chain([name])),
        lints::for_numbers(body.numbers()),
        lints::for_result(&signature.dimensions).filter(|_| is_last && body.results.is_empty()),
        lints::for_arguments(arguments.len()),
    ];
    let allowed = allowed.iter().flatten();
    quote! {
        #documentation
        #[inline(always)]
        #(#allowed)*
        fn #callee(#(#arguments),*) #arrow { #(#others)* #(#statements)* #value }
    }
}
