//! Prints a function as straight-line code or as loops over joints, and its version for eight states at once.

use super::context::Context;
use super::{affine, arrays, lanes, straight};
use crate::functions::function::Function;
use crate::program::arrays::ArrayForm;

/// The texts of a function: private functions, the public function, then the functions for eight states at
/// once.
pub(super) fn items(context: &Context<'_>, function: &Function, name: &str) -> Vec<String> {
    let mut items = match &function.arrays {
        Some(ArrayForm::Steps(form)) => arrays::items(context, function, form, name),
        Some(ArrayForm::Affine(form)) => affine::items(context, function, form, name),
        None => straight::items(context, function, name),
    };
    items.extend(lanes::items(context, function));
    items
}
