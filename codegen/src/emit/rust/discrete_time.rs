//! Prints functions over a sample time, such as `step`. They call `linearize` or `forward_dynamics` of the
//! module, and functions in fixed texts.

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
use crate::module::{ComposedFunction, Module};
use gelenk_kernels::discrete_time::Text;
use gelenk_kernels::manifold;

/// Prints one function over a sample time, for example `step`.
pub(super) fn function(context: &Context<'_>, composed: &ComposedFunction) -> TokenStream {
    let function = composed.composition;
    let ty = context.ty();
    let (name, callee) = (identifier(function.name()), identifier(function.calls()));
    let parameters = context.declared_parameters().map(|p| quote!(, #p));
    let p = context.passed_parameters().map(|p| quote!(, #p));
    let y_type = match context.module.has_quaternions() {
        true => quote!(&[#ty; NY]),
        false => quote!(&[#ty; N]),
    };
    let call = match function {
        Composition::Discretize if context.module.has_quaternions() => {
            quote!(discrete_time::zero_order_hold_on_manifold(&#callee(y, v, u #p), period))
        }
        Composition::Step if context.module.has_quaternions() => quote! {
            discrete_time::runge_kutta_on_manifold(
                &JOINT_POSITIONS, y, v, period, SUBSTEPS, |y, v| #callee(y, v, u #p),
            )
        },
        Composition::StepDerivatives if context.module.has_quaternions() => quote! {
            discrete_time::runge_kutta_on_manifold_derivatives(
                &JOINT_POSITIONS, y, v, u, period, SUBSTEPS, |y, v| {
                    let (by_y, by_v, by_u, remainder, _) = #callee(y, v, u #p);
                    (by_y, by_v, by_u, remainder)
                },
            )
        },
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
            pub fn #name(y: #y_type, v: &[#ty; N], u: &[#ty; M], period: #ty #parameters) -> (#(#results),*)
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
            arguments: vec![documentation::state_label(context.module)],
            has_parameters: context.has_parameters(),
            results: results.collect(),
            stack: None,
        },
    ))
}

/// Text of a private module with the fixed texts for functions over a sample time; empty if there are no such
/// functions.
pub(super) fn text(scalar: Scalar, module: &Module) -> String {
    let compositions = &module.compositions;
    let texts: BTreeSet<Text> =
        compositions.iter().flat_map(|each| each.composition.texts()).copied().collect();
    if texts.is_empty() {
        return String::new();
    }
    let mut sources: Vec<String> = texts.iter().map(|text| text.source().to_owned()).collect();
    if module.has_quaternions() {
        sources = on_manifold(sources, compositions);
    }
    let sources: Vec<&str> = sources.iter().map(String::as_str).collect();
    let loops = match module.has_quaternions() {
        true => pasted::partly_called_loops,
        false => pasted::loops,
    };
    loops(scalar, "Functions in discrete time for N coordinates and M inputs.", "discrete_time", &sources)
}

/// Adds the texts for functions over a sample time with quaternions, and the imports from the module
/// `manifold` that these texts need.
fn on_manifold(sources: Vec<String>, compositions: &[ComposedFunction]) -> Vec<String> {
    let texts: BTreeSet<manifold::Text> =
        compositions.iter().flat_map(|each| each.composition.manifold_texts()).copied().collect();
    let added: Vec<String> = texts.iter().map(|text| text.source().to_owned()).collect();
    let is_called = |name: &&str| added.iter().any(|source| source.contains(*name));
    let names: Vec<&str> = USED.iter().copied().filter(is_called).collect();
    let imports = (!names.is_empty()).then(|| format!("use super::manifold::{{{}}};", names.join(", ")));
    imports.into_iter().chain(sources).chain(added).collect()
}

/// Items of the module `manifold` that the texts for functions over a sample time use.
const USED: [&str; 8] =
    ["cross", "integrate", "places", "pose_bracket", "pose_tangents", "read", "rotation_tangents", "write"];
