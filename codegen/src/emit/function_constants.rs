//! Constants that explain a function, before it in the module.

use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};

use super::context::Context;
use super::doc_comment::DocComment;
use super::lints;
use crate::functions::function::{Constant, ConstantValue, Function};

/// All constants of a function.
pub(super) fn items(context: &Context<'_>, function: &Function) -> Vec<TokenStream> {
    let constants = function.constants.iter();
    constants.map(|constant| item(context, constant)).collect()
}

fn item(context: &Context<'_>, constant: &Constant) -> TokenStream {
    let mut doc = DocComment::new(&constant.summary);
    if !constant.items.is_empty() {
        doc.gap();
        constant.items.iter().for_each(|item| doc.item(item));
    }
    let (name, doc) = (format_ident!("{}", constant.name), doc.tokens());
    let count = Literal::usize_unsuffixed;
    match &constant.value {
        ConstantValue::Names(names) => {
            let len = count(names.len());
            quote!(#doc pub const #name: [&str; #len] = [#(#names),*];)
        }
        ConstantValue::Sparse(entries) => {
            let (scalar, len) = (context.options.scalar, count(entries.len()));
            let ty = scalar.ty();
            let allowed = lints::for_numbers(entries.iter().map(|entry| entry.2));
            let entries = entries.iter().map(|&(row, column, value)| {
                let (row, column, value) = (count(row), count(column), scalar.literal(value));
                quote!((#row, #column, #value))
            });
            quote!(#doc #allowed pub const #name: [(usize, usize, #ty); #len] = [#(#entries),*];)
        }
        ConstantValue::Pattern(rows) => {
            let (height, width) = (count(rows.len()), count(rows.first().map_or(0, Vec::len)));
            let rows = rows.iter().map(|row| quote!([#(#row),*]));
            quote!(#doc pub const #name: [[bool; #width]; #height] = [#(#rows),*];)
        }
    }
}
