//! Large results, written where the caller wants them.
//!
//! A matrix that is returned passes through memory once or twice more: its entries are stored one by one and copied
//! as vectors at once, which a processor cannot forward from its store buffer. M and bias forces of a UR5 took 119 ns
//! that way and 60 ns written in place.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::body::Body;
use super::doc_comment::DocComment;
use super::function::Signature;
use super::{Context, lints, names};
use crate::program::{Operand, Output, Program, Shape};

/// Results of more entries than this are also offered as `…_into`.
const LARGEST_RETURNED: usize = 16;

/// Whether the function has an `…_into`.
pub(super) fn is_large(program: &Program) -> bool {
    let entries = program.outputs.iter().map(|output| output.entries.len());
    entries.sum::<usize>() > LARGEST_RETURNED
}

/// Argument names for the results, letters of formulas spelled out.
pub(super) fn result_names(program: &Program, taken: &[String]) -> Vec<Ident> {
    let spelled: Vec<String> = program
        .outputs
        .iter()
        .map(|output| {
            let name = output.name.replace("⁻¹", "_inverse").replace('ẏ', "v");
            let name = name
                .replace('ÿ', "a")
                .replace('∂', "d")
                .replace(['/', ' '], "_");
            name.to_lowercase()
        })
        .collect();
    names::distinct(spelled.iter().map(String::as_str), taken)
}

/// The stores of those entries whose value, if they are one, is wanted.
pub(super) fn stores(
    body: &Body<'_>,
    is_wanted: impl Fn(Option<usize>) -> bool,
) -> Vec<TokenStream> {
    let outputs = body.program.outputs.iter().zip(&body.results);
    let mut stores = Vec::new();
    for (output, name) in outputs {
        for (index, &entry) in output.entries.iter().enumerate() {
            let made = match entry {
                Operand::Value(made) => Some(body.flow.canonical(made)),
                _ => None,
            };
            if is_wanted(made) {
                let (place, entry) = (place(output, name, index), body.operand(entry));
                let column = &body.column;
                stores.push(quote!(#place #column = #entry;));
            }
        }
    }
    stores
}

pub(super) fn place(output: &Output, name: &Ident, index: usize) -> TokenStream {
    let literal = Literal::usize_unsuffixed;
    match output.shape {
        Shape::Scalar => quote!(*#name),
        Shape::Vector(_) => {
            let index = literal(index);
            quote!(#name[#index])
        }
        Shape::Matrix(_, columns) => {
            let (row, column) = (literal(index / columns.len), literal(index % columns.len));
            quote!(#name[#row][#column])
        }
    }
}

/// The function with its results as arguments: its documentation refers to the other.
pub(super) fn item(
    body: &Body<'_>,
    name: &Ident,
    signature: &Signature,
    statements: &TokenStream,
) -> TokenStream {
    let into = into_name(name);
    let documentation = DocComment::new(&format!(
        "`{name}` with its results written in place; nothing of what stood there is read."
    ));
    let documentation = documentation.tokens();
    let arguments = &signature.arguments;
    let results = body.results.iter().zip(&signature.results);
    let results = results.map(|(name, ty)| quote!(#name: &mut #ty));
    let allowed = [
        lints::for_names(body.value_names().chain(&body.arguments).chain([name])),
        lints::for_numbers(body.numbers()),
        lints::for_arguments(arguments.len() + body.results.len()),
    ];
    let allowed = allowed.iter().flatten();
    quote! {
        #documentation
        #(#allowed)*
        pub fn #into(#(#arguments,)* #(#results),*) { #statements }
    }
}

/// The body of the function that returns its results.
pub(super) fn returning(context: &Context<'_>, body: &Body<'_>, name: &Ident) -> TokenStream {
    let into = into_name(name);
    let zero = context.options.scalar.literal(0.0);
    let results = &body.results;
    let zeros = body
        .program
        .outputs
        .iter()
        .map(|output| zeros(output.shape, &zero));
    let arguments = &body.arguments;
    let parameters = context.has_parameters().then(|| quote!(p,));
    let value = match results.as_slice() {
        [result] => quote!(#result),
        _ => quote!((#(#results),*)),
    };
    quote! {
        #(let mut #results = #zeros;)*
        #into(#(#arguments,)* #parameters #(&mut #results),*);
        #value
    }
}

/// Zeros of a shape.
pub(super) fn zeros(shape: Shape, zero: &TokenStream) -> TokenStream {
    let extents = shape.extents().into_iter().rev();
    extents.fold(zero.clone(), |entry, extent| {
        let len = Literal::usize_unsuffixed(extent.len);
        quote!([#entry; #len])
    })
}

pub(super) fn into_name(name: &Ident) -> Ident {
    format_ident!("{}_into", name)
}
