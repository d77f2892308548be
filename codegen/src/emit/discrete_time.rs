//! Functions over a sample time: calls of the module's own `linearize` and `forward_dynamics`, and the pasted texts.

use std::collections::BTreeSet;

use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::quote;

use super::context::Context;
use super::doc_comment::{DocComment, code};
use super::literal::Scalar;
use super::{lints, pasted};
use crate::functions::composition::Composition;
use crate::functions::function::Function;
use gelenk_kernels::discrete_time::Text;

/// Names that the module takes for functions over a sample time.
pub(super) const RESERVED: [&str; 1] = ["SUBSTEPS"];

/// The functions, and the constant that they read.
pub(super) fn items(
    context: &Context<'_>,
    functions: &[Function],
    compositions: &[Composition],
) -> Vec<TokenStream> {
    let has_substeps = compositions.iter().any(|function| function.has_substeps());
    let substeps = has_substeps.then(|| substeps(context));
    let items = compositions
        .iter()
        .map(|&each| function(context, functions, each));
    substeps.into_iter().chain(items).collect()
}

fn substeps(context: &Context<'_>) -> TokenStream {
    let count = Literal::usize_unsuffixed(context.model.options.substeps.unwrap_or(1));
    let documentation = DocComment::new(
        "Runge–Kutta steps in one period of `step` and `step_derivatives`: `substeps` of the description.",
    );
    let documentation = documentation.tokens();
    quote! {
        #documentation
        pub const SUBSTEPS: usize = #count;
    }
}

fn function(context: &Context<'_>, functions: &[Function], function: Composition) -> TokenStream {
    let ty = context.options.scalar.ty();
    let identifier = |name: &str| Ident::new(name, Span::call_site());
    let (name, callee) = (identifier(function.name()), identifier(function.calls()));
    let parameters = context.declared_parameters().map(|p| quote!(, #p));
    let p = context.passed_parameters().map(|p| quote!(, #p));
    let results = function.results().iter().map(|(_, dimensions, _)| {
        dimensions.iter().rev().fold(ty.clone(), |entry, size| {
            let size: TokenStream = match size.parse::<usize>() {
                Ok(size) => {
                    let size = Literal::usize_unsuffixed(size);
                    quote!(#size)
                }
                Err(_) => {
                    let size = identifier(size);
                    quote!(#size)
                }
            };
            quote!([#entry; #size])
        })
    });
    let call = match function {
        Composition::Discretize => {
            quote!(discrete_time::zero_order_hold(&#callee(y, v, u #p), period))
        }
        Composition::Step => quote! {
            discrete_time::runge_kutta(*y, *v, period, SUBSTEPS, |y, v| #callee(y, v, u #p))
        },
        Composition::StepDerivatives => quote! {
            discrete_time::runge_kutta_derivatives(y, v, u, period, SUBSTEPS, |y, v| #callee(y, v, u #p))
        },
    };
    let dimensions: Vec<usize> = function.results().iter().map(|r| r.1.len()).collect();
    let allowed = lints::for_result(&dimensions);
    let documentation = documentation(context, functions, function).tokens();
    quote! {
        #documentation
        #[must_use]
        #allowed
        pub fn #name(y: &[#ty; N], v: &[#ty; N], u: &[#ty; M], period: #ty #parameters) -> (#(#results),*) {
            #call
        }
    }
}

fn documentation(
    context: &Context<'_>,
    functions: &[Function],
    function: Composition,
) -> DocComment {
    let mut doc = DocComment::new(function.summary());
    doc.paragraph(&code(function.equation()));
    doc.gap();
    doc.item("`y: [N]`, `v: [N]`, `u: [M]`: coordinates, velocities and inputs, as elsewhere in this module");
    doc.item("`period`: sample time in s, over which u is held");
    if context.passed_parameters().is_some() {
        doc.item("`p`: free parameters");
    }
    for (symbol, dimensions, meaning) in function.results() {
        let shape = dimensions.join(" × ");
        doc.item(&format!("returns `{symbol}: [{shape}]`: {meaning}"));
    }
    doc.paragraph(&cost(context, functions, function));
    for note in function.notes() {
        doc.paragraph(note);
    }
    doc
}

fn cost(context: &Context<'_>, functions: &[Function], function: Composition) -> String {
    let substeps = context.model.options.substeps.unwrap_or(1);
    let calls = match function.call_count(substeps) {
        1 => "one call".to_owned(),
        count => format!("{count} calls"),
    };
    let callee = function.calls();
    match function.cost_in(context.model, functions) {
        Some(cost) => {
            let cost = format!("Cost: {cost}, {calls} of `{callee}` included.");
            let note = function.cost_note(context.model, functions);
            note.map_or(cost.clone(), |note| format!("{cost} {note}"))
        }
        None => format!("Cost: {calls} of `{callee}`, and its own operations."),
    }
}

/// The pasted texts in a module of their own.
pub(super) fn text(scalar: Scalar, compositions: &[Composition]) -> String {
    let texts: BTreeSet<Text> = compositions
        .iter()
        .flat_map(|each| each.texts())
        .copied()
        .collect();
    if texts.is_empty() {
        return String::new();
    }
    let sources: Vec<&str> = texts.iter().map(|text| text.source()).collect();
    pasted::loops(
        scalar,
        "Discrete time: functions over N coordinates and M inputs.",
        "discrete_time",
        &sources,
    )
}
