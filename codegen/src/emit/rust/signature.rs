//! Types of arguments and results, and the tokens of a function.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::body::{Body, tuple};
use super::doc_comment::DocComment;
use crate::layout::Extent;
use crate::program::{Output, Shape};

/// Arguments and results of a function as tokens.
pub(super) struct Signature {
    /// Inputs and free parameters of the function, with their types.
    pub(super) arguments: Vec<TokenStream>,
    pub(super) result: TokenStream,
    /// Rust type of each result.
    pub(super) results: Vec<TokenStream>,
    /// Number of dimensions of each result.
    pub(super) dimensions: Vec<usize>,
}

impl Signature {
    pub(super) fn new(body: &Body<'_>) -> Self {
        let (ty, outputs) = (body.context.ty(), &body.program.outputs);
        let results: Vec<TokenStream> = outputs.iter().map(|output| result(output, &ty)).collect();
        let dimensions = outputs.iter().map(|output| output.shape.extents().len());
        Self {
            arguments: inputs(body, &ty).chain(body.context.declared_parameters()).collect(),
            result: tuple(results.iter().cloned()),
            results,
            dimensions: dimensions.collect(),
        }
    }
}

/// Declarations of the input arrays. `entry` is the type of an entry.
pub(super) fn inputs(body: &Body<'_>, entry: &TokenStream) -> impl Iterator<Item = TokenStream> {
    let inputs = body.program.inputs.iter().zip(&body.arguments);
    inputs.map(move |(input, name)| {
        let row = input.extent.row().map(number);
        let ty = nested(entry.clone(), [length(input.extent)].into_iter().chain(row));
        quote!(#name: &#ty)
    })
}

/// Tokens of an array with these entries. It is nested if the entries form rows.
pub(super) fn in_rows(extent: Extent, entries: Vec<TokenStream>) -> TokenStream {
    match extent.row() {
        Some(row) => {
            let rows = entries.chunks(row).map(|row| quote!([#(#row),*]));
            quote!([#(#rows),*])
        }
        None => quote!([#(#entries),*]),
    }
}

/// Type of a result. `entry` is the type of an entry.
pub(super) fn result(output: &Output, entry: &TokenStream) -> TokenStream {
    nested(entry.clone(), output.shape.extents().into_iter().map(length))
}

/// Tokens of an array of this shape with zeros.
pub(super) fn zeros(shape: Shape, zero: TokenStream) -> TokenStream {
    let extents = shape.extents().into_iter();
    nested(zero, extents.map(|extent| number(extent.len)))
}

/// Tokens `[[entry; columns]; rows]` from the lengths `rows`, `columns`.
pub(super) fn nested(
    entry: TokenStream,
    lengths: impl DoubleEndedIterator<Item = TokenStream>,
) -> TokenStream {
    let lengths = lengths.rev();
    lengths.fold(entry, |entry, len| quote!([#entry; #len]))
}

/// Tokens of a length: the name of a constant if the length depends on the robot, otherwise a number.
pub(super) fn length(extent: Extent) -> TokenStream {
    match extent.dimension.length() {
        Some(name) => {
            let name = super::names::identifier(name);
            quote!(#name)
        }
        None => number(extent.len),
    }
}

fn number(len: usize) -> TokenStream {
    let len = Literal::usize_unsuffixed(len);
    quote!(#len)
}

/// Tokens of a function from documentation, attributes, head and statements.
pub(super) fn item(
    documentation: &DocComment,
    attributes: impl IntoIterator<Item = Option<TokenStream>>,
    head: &TokenStream,
    statements: &TokenStream,
) -> TokenStream {
    let documentation = documentation.tokens();
    let attributes = attributes.into_iter().flatten();
    quote!(#documentation #(#attributes)* #head { #statements })
}
