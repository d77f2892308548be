//! Functions over a sample time: calls of the module's own `linearize` and `forward_dynamics`, and the pasted
//! texts.

use std::collections::BTreeSet;

use proc_macro2::TokenStream;
use quote::quote;

use super::context::Context;
use super::doc_comment::DocComment;
use super::names::identifier;
use super::signature::{item, length, nested};
use super::{lints, pasted};
use crate::emit::documentation::{self, Labels, shape_text};
use crate::emit::options::Scalar;
use crate::functions::composition::Composition;
use crate::module::ComposedFunction;
use gelenk_kernels::discrete_time::Text;

/// A function.
pub(super) fn function(context: &Context<'_>, composed: &ComposedFunction) -> TokenStream {
    let function = composed.composition;
    let ty = context.ty();
    let (name, callee) = (identifier(function.name()), identifier(function.calls()));
    let parameters = context.declared_parameters().map(|p| quote!(, #p));
    let p = context.passed_parameters().map(|p| quote!(, #p));
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
    let results = composed.results.iter();
    let dimensions: Vec<usize> = results.map(|each| each.extents.len()).collect();
    let results = composed.results.iter();
    let results = results.map(|each| nested(ty.clone(), each.extents.iter().copied().map(length)));
    item(
        &documentation(context, composed),
        [Some(quote!(#[must_use])), lints::for_result(&dimensions)],
        &quote! {
            pub fn #name(y: &[#ty; N], v: &[#ty; N], u: &[#ty; M], period: #ty #parameters) -> (#(#results),*)
        },
        &call,
    )
}

fn documentation(context: &Context<'_>, composed: &ComposedFunction) -> DocComment {
    let results = composed
        .results
        .iter()
        .map(|result| format!("returns `{}: [{}]`", result.name, shape_text(&result.extents)));
    DocComment::of(&documentation::of_composition(
        composed,
        &Labels {
            arguments: vec!["`y: [N]`, `v: [N]`, `u: [M]`".to_owned()],
            has_parameters: context.has_parameters(),
            results: results.collect(),
        },
    ))
}

/// The pasted texts in a module of their own.
pub(super) fn text(scalar: Scalar, compositions: &[ComposedFunction]) -> String {
    let texts: BTreeSet<Text> =
        compositions.iter().flat_map(|each| each.composition.texts()).copied().collect();
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
