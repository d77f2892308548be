//! Attributes that switch lints off for printed items.

use proc_macro2::TokenStream;
use quote::quote;

use super::literal::resembles_constant;
use super::names::is_snake_case;

/// Attribute that allows numbers that resemble rounded constants such as π or e; `None` if there are no such
/// numbers.
pub(super) fn for_numbers(numbers: impl IntoIterator<Item = f64>) -> Option<TokenStream> {
    numbers
        .into_iter()
        .any(resembles_constant)
        .then(|| quote!(#[allow(clippy::approx_constant, reason = "numbers as the description gives them")]))
}

/// Attribute that allows names with capital letters; `None` if there are no such names.
pub(super) fn for_names<'a>(names: impl IntoIterator<Item = &'a proc_macro2::Ident>) -> Option<TokenStream> {
    names
        .into_iter()
        .any(|name| !is_snake_case(&name.to_string()))
        .then(|| quote!(#[allow(non_snake_case, reason = "names as the description gives them")]))
}

/// Attribute that allows more than seven arguments, which is the limit of clippy; `None` for at most seven
/// arguments.
pub(super) fn for_arguments(count: usize) -> Option<TokenStream> {
    (count > 7).then(
        || quote!(#[allow(clippy::too_many_arguments, reason = "blocks of fixed size need no type of their own")]),
    )
}

/// Attribute that allows a tuple of matrices as the result type; `None` if clippy allows the type. Clippy
/// computes a score for a type, with the limit 250: the sum over all parts of the type of 10 times the depth
/// of the part.
///
/// - `dimensions`: number of dimensions of each result
pub(super) fn for_result(dimensions: &[usize]) -> Option<TokenStream> {
    let depth = if dimensions.len() > 1 { 1 } else { 0 };
    let entry = |array: &usize| (1..=array + 1).map(|level| 10 * (level + depth)).sum::<usize>();
    let score = 10 * depth + dimensions.iter().map(entry).sum::<usize>();
    (score > 250).then(|| quote!(#[allow(clippy::type_complexity, reason = "blocks of fixed size need no type of their own")]))
}
