//! Prints the functions of positions with quaternions, and the fixed texts that they call.

use proc_macro2::TokenStream;
use quote::quote;

use super::context::Context;
use super::doc_comment::DocComment;
use super::names::identifier;
use super::signature::{item, length, nested};
use super::{lints, math, pasted};
use crate::emit::documentation::{self, Labels, shape_text};
use crate::emit::options::Scalar;
use crate::functions::position_functions::{PositionFunction, PositionValue, extents};
use gelenk_kernels::manifold::Text;

/// The functions of positions with quaternions, for example `integrate`; empty for robots without
/// quaternions.
pub(super) fn items(context: &Context<'_>) -> Vec<TokenStream> {
    if !context.module.has_quaternions() {
        return vec![];
    }
    math::need_for_rotations(context);
    PositionFunction::ALL.map(|each| function(context, each)).into()
}

fn function(context: &Context<'_>, function: PositionFunction) -> TokenStream {
    let ty = context.ty();
    let name = identifier(function.name());
    let lengths =
        |value: &PositionValue| extents(value, context.module.positions, context.module.coordinates);
    let array = |value: &PositionValue| nested(ty.clone(), lengths(value).into_iter().map(length));
    let taken = function.arguments();
    let arguments = taken.iter().map(|value| {
        let (name, ty) = (identifier(value.name), array(value));
        match function {
            PositionFunction::Normalize => quote!(#name: &mut #ty),
            _ => quote!(#name: &#ty),
        }
    });
    let arguments: Vec<TokenStream> = arguments.collect();
    let results: Vec<TokenStream> = function.results().iter().map(array).collect();
    let (result, call) = match function {
        PositionFunction::Integrate => {
            (quote!(#(#results)*), quote!(manifold::integrate(&JOINT_POSITIONS, y, d)))
        }
        PositionFunction::Difference => {
            (quote!(#(#results)*), quote!(manifold::difference(&JOINT_POSITIONS, from, to)))
        }
        PositionFunction::IntegrateDerivatives => {
            // The derivatives are in the frame of the displaced body, so they do not depend on the
            // quaternions.
            (quote!((#(#results),*)), quote!(let _ = y; manifold::integrate_derivatives(&JOINT_POSITIONS, d)))
        }
        PositionFunction::Normalize => (quote!(bool), quote!(manifold::normalize(&JOINT_POSITIONS, y))),
    };
    let is_result = function != PositionFunction::Normalize;
    item(
        &documentation(function, &lengths),
        [is_result.then(|| quote!(#[must_use])), lints::for_result(&[2])],
        &quote!(pub fn #name(#(#arguments),*) -> #result),
        &call,
    )
}

fn documentation(
    function: PositionFunction,
    lengths: &dyn Fn(&PositionValue) -> Vec<crate::layout::Extent>,
) -> DocComment {
    let shape = |value: &PositionValue| shape_text(&lengths(value));
    let label = |value: &PositionValue| format!("`{}: [{}]`: {}", value.name, shape(value), value.meaning);
    let returned = |value: &PositionValue| format!("returns {}", label(value));
    DocComment::of(&documentation::of_position_function(
        function,
        &Labels {
            arguments: function.arguments().iter().map(label).collect(),
            has_parameters: false,
            results: function.results().iter().map(returned).collect(),
            stack: None,
        },
    ))
}

/// Text of a private module with the fixed texts for positions with quaternions; empty for robots without
/// quaternions.
pub(super) fn text(context: &Context<'_>) -> String {
    if !context.module.has_quaternions() {
        return String::new();
    }
    let scalar = context.options.scalar;
    let imports = match scalar {
        Scalar::F64 => "use super::math::{sin_cos, sqrt};",
        Scalar::F32 => "use super::math::{sin_cos_f32 as sin_cos, sqrt_f32 as sqrt};",
    };
    let texts = [Text::Joints, Text::Rotation, Text::Positions, Text::Bracket, Text::Tangents];
    let sources: Vec<&str> = [imports].into_iter().chain(texts.map(Text::source)).collect();
    let documentation = "Positions with quaternions: the operations ⊕ and ⊖, and their derivatives.";
    pasted::partly_called_loops(scalar, documentation, "manifold", &sources)
}
