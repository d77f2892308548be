//! Prints a function as straight-line code or as loops over joints. Straight-line code may also be printed for
//! several states (lanes).

use proc_macro2::{Ident, TokenStream};

use super::context::Context;
use super::{affine, arrays, lanes, straight};
use crate::functions::function::Function;
use crate::program::arrays::ArrayForm;

/// The tokens of a function: its public functions, then the private functions that they call.
pub(super) fn items(context: &Context<'_>, function: &Function, name: &Ident) -> Vec<TokenStream> {
    match &function.arrays {
        Some(ArrayForm::Steps(form)) => arrays::items(context, function, form, name),
        Some(ArrayForm::Affine(form)) => affine::items(context, function, form, name),
        None => match lanes::plan(context, function) {
            Some(plan) => lanes::items(context, function, name, &plan),
            None => straight::items(context, function, name),
        },
    }
}
