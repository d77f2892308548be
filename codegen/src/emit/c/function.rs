//! A function in the form that it has: straight-line code, or loops over joints.

use super::context::Context;
use super::{affine, arrays, straight};
use crate::functions::function::Function;
use crate::program::arrays::ArrayForm;

/// The private functions, then the public one that calls them.
pub(super) fn items(context: &Context<'_>, function: &Function, name: &str) -> Vec<String> {
    match &function.arrays {
        Some(ArrayForm::Steps(form)) => arrays::items(context, function, form, name),
        Some(ArrayForm::Affine(form)) => affine::items(context, function, form, name),
        None => straight::items(context, function, name),
    }
}
