//! A function in its form: straight-line code or loops over joints; and its form over several states.

use super::context::Context;
use super::{affine, arrays, lanes, straight};
use crate::functions::function::Function;
use crate::program::arrays::ArrayForm;

/// The private functions, the public function, then the functions over several states.
pub(super) fn items(context: &Context<'_>, function: &Function, name: &str) -> Vec<String> {
    let mut items = match &function.arrays {
        Some(ArrayForm::Steps(form)) => arrays::items(context, function, form, name),
        Some(ArrayForm::Affine(form)) => affine::items(context, function, form, name),
        None => straight::items(context, function, name),
    };
    items.extend(lanes::items(context, function));
    items
}
