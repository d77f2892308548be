//! Lint exceptions, each on the item that needs it.

use proc_macro2::TokenStream;
use quote::quote;

use super::literal::resembles_constant;
use super::names::is_snake_case;

/// Allows numbers that resemble rounded constants such as π or e, if any occur.
pub(super) fn for_numbers(numbers: impl IntoIterator<Item = f64>) -> Option<TokenStream> {
    numbers
        .into_iter()
        .any(resembles_constant)
        .then(|| quote!(#[allow(clippy::approx_constant, reason = "numbers as the description gives them")]))
}

/// Allows names with capital letters, if any occur.
pub(super) fn for_names<'a>(names: impl IntoIterator<Item = &'a proc_macro2::Ident>) -> Option<TokenStream> {
    names
        .into_iter()
        .any(|name| !is_snake_case(&name.to_string()))
        .then(|| quote!(#[allow(non_snake_case, reason = "names as the description gives them")]))
}

/// Allows more arguments than clippy's limit of seven.
pub(super) fn for_arguments(count: usize) -> Option<TokenStream> {
    (count > 7).then(
        || quote!(#[allow(clippy::too_many_arguments, reason = "blocks of fixed size need no type of their own")]),
    )
}

/// Allows a tuple of matrices as result. Clippy's score of a type counts each part 10 times its depth; the
/// limit is 250.
pub(super) fn for_result(dimensions: &[usize]) -> Option<TokenStream> {
    let depth = if dimensions.len() > 1 { 1 } else { 0 };
    let entry = |array: &usize| (1..=array + 1).map(|level| 10 * (level + depth)).sum::<usize>();
    let score = 10 * depth + dimensions.iter().map(entry).sum::<usize>();
    (score > 250).then(|| quote!(#[allow(clippy::type_complexity, reason = "blocks of fixed size need no type of their own")]))
}
