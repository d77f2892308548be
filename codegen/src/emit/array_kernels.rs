//! The loops of array forms, pasted into modules that need them.

use super::literal::Scalar;
use super::pasted;
use crate::dynamics::function::Function;
use crate::program::arrays::{ArrayForm, Step};

/// The module of loops that the functions call.
pub(super) fn text(scalar: Scalar, functions: &[Function]) -> String {
    let forms: Vec<&ArrayForm> = functions
        .iter()
        .filter_map(|function| function.arrays.as_ref())
        .collect();
    let Some(first) = forms.first().map(|form| form.arrays()) else {
        return String::new();
    };
    let mut texts = vec![
        match first.is_fused {
            true => include_str!("../array_kernels/products_fused.rs"),
            false => include_str!("../array_kernels/products.rs"),
        },
        include_str!("../array_kernels/block_products.rs"),
        match first.is_chain() {
            true => include_str!("../array_kernels/chain_pairs.rs"),
            false => include_str!("../array_kernels/tree_pairs.rs"),
        },
    ];
    let inverts = |step: &Step| matches!(step, Step::Invert { .. });
    if forms
        .iter()
        .any(|form| form.arrays().steps.iter().any(inverts))
    {
        texts.push(include_str!("../array_kernels/inverse.rs"));
        texts.push(include_str!("../array_kernels/matrix_products.rs"));
    }
    if forms
        .iter()
        .any(|form| matches!(form, ArrayForm::Affine(_)))
    {
        texts.push(include_str!("../array_kernels/dot.rs"));
    }
    let module = pasted::module(
        "Loops over arrays of joints: R rows of N entries, padded to L, in blocks of K.",
        pasted::LOOPS,
        "arrays",
        &texts,
    );
    pasted::for_scalar(module, scalar)
}
