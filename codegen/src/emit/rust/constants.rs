//! Prints the constants of a Rust module.

use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};

use super::context::Context;
use super::doc_comment::DocComment;
use super::lints;
use super::literal::hexadecimal;
use super::signature::length;
use crate::emit::documentation::of_constant;
use crate::functions::function::{Constant, ConstantValue};
use crate::layout::{Dimension, Extent};

/// Names of the lengths and of the type of prescribed motions. Other items must not have these names.
pub(super) const RESERVED: [&str; 3] = ["N", "M", "Driven"];

/// The constants `N` and `M` for the numbers of coordinates and inputs.
pub(super) fn sizes(context: &Context<'_>) -> [TokenStream; 2] {
    let n = Literal::usize_unsuffixed(context.module.coordinates);
    let m = Literal::usize_unsuffixed(context.module.inputs);
    [
        quote! {
            #[doc = " Number of coordinates."]
            pub const N: usize = #n;
        },
        quote! {
            #[doc = " Number of inputs."]
            pub const M: usize = #m;
        },
    ]
}

/// Type of the argument for the motions of driven joints (with prescribed motion); `None` if there are none.
pub(super) fn driven(context: &Context<'_>) -> Option<TokenStream> {
    let ty = context.ty();
    (context.module.driven > 0).then(|| {
        quote! {
            #[doc = " Driven motion: position, velocity and acceleration of each driven joint, in the order of `DRIVEN_NAMES`."]
            pub type Driven = [[#ty; 3]; DRIVEN];
        }
    })
}

/// A constant with its documentation.
pub(super) fn item(context: &Context<'_>, constant: &Constant) -> TokenStream {
    let doc = DocComment::of(&of_constant(constant));
    let allowed = lints::for_numbers(numbers(&constant.value));
    let (name, doc) = (format_ident!("{}", constant.name), doc.tokens());
    let (ty, value) = value(context, &constant.value);
    quote!(#doc #allowed pub const #name: #ty = #value;)
}

/// Type and value in Rust of a constant.
fn value(context: &Context<'_>, value: &ConstantValue) -> (TokenStream, TokenStream) {
    let (scalar, ty) = (context.options.scalar, context.ty());
    let count = Literal::usize_unsuffixed;
    match value {
        ConstantValue::Count(number) => {
            let number = count(*number);
            (quote!(usize), quote!(#number))
        }
        ConstantValue::Hash(hash) => {
            let hash = hexadecimal(*hash);
            (quote!(u64), quote!(#hash))
        }
        ConstantValue::Names(dimension, names) => {
            let names = names.iter().map(|name| quote!(#name));
            array(*dimension, &quote!(&str), names)
        }
        ConstantValue::Indices(dimension, indices) => {
            let indices = indices.iter().map(|&index| count(index));
            array(*dimension, &quote!(usize), indices.map(|index| quote!(#index)))
        }
        ConstantValue::Pairs(pairs) => {
            let pairs = pairs.iter().map(|&[first, second]| (count(first), count(second)));
            array(
                Dimension::Fixed,
                &quote!([usize; 2]),
                pairs.map(|(first, second)| quote!([#first, #second])),
            )
        }
        ConstantValue::Numbers(dimension, numbers) => {
            array(*dimension, &ty, numbers.iter().map(|&x| scalar.literal(x)))
        }
        ConstantValue::Ranges(dimension, ranges) => {
            let ranges = ranges.iter().map(|[low, high]| {
                let (low, high) = (scalar.literal(*low), scalar.literal(*high));
                quote!([#low, #high])
            });
            array(*dimension, &quote!([#ty; 2]), ranges)
        }
        ConstantValue::Rows(columns, rows) => {
            let width = length(Extent::new(*columns, rows.first().map_or(0, Vec::len)));
            let rows = rows.iter().map(|row| {
                let entries = row.iter().map(|&x| scalar.literal(x));
                quote!([#(#entries),*])
            });
            array(Dimension::Fixed, &quote!([#ty; #width]), rows)
        }
        ConstantValue::Sparse(entries) => {
            let entries = entries.iter().map(|&(row, column, value)| {
                let (row, column, value) = (count(row), count(column), scalar.literal(value));
                quote!((#row, #column, #value))
            });
            array(Dimension::Fixed, &quote!((usize, usize, #ty)), entries)
        }
        ConstantValue::Pattern(rows) => {
            let width = count(rows.first().map_or(0, Vec::len));
            let rows = rows.iter().map(|row| quote!([#(#row),*]));
            array(Dimension::Fixed, &quote!([bool; #width]), rows)
        }
    }
}

fn array(
    dimension: Dimension,
    entry: &TokenStream,
    entries: impl ExactSizeIterator<Item = TokenStream>,
) -> (TokenStream, TokenStream) {
    let len = length(Extent::new(dimension, entries.len()));
    (quote!([#entry; #len]), quote!([#(#entries),*]))
}

fn numbers(value: &ConstantValue) -> Vec<f64> {
    match value {
        ConstantValue::Numbers(_, numbers) => numbers.clone(),
        ConstantValue::Ranges(_, ranges) => ranges.concat(),
        ConstantValue::Rows(_, rows) => rows.concat(),
        ConstantValue::Sparse(entries) => entries.iter().map(|entry| entry.2).collect(),
        ConstantValue::Count(_)
        | ConstantValue::Hash(_)
        | ConstantValue::Names(..)
        | ConstantValue::Indices(..)
        | ConstantValue::Pairs(_)
        | ConstantValue::Pattern(_) => vec![],
    }
}
