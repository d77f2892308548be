//! The loops of array forms, pasted into modules that need them.

use super::pasted;
use crate::emit::arrays::Row;
use crate::emit::options::Scalar;
use crate::functions::function::Function;
use crate::program::arrays::{ArrayForm, Step};

/// The module of loops that the functions call.
pub(super) fn text(scalar: Scalar, functions: &[Function]) -> String {
    let forms: Vec<&ArrayForm> = functions.iter().filter_map(|function| function.arrays.as_ref()).collect();
    let Some(first) = forms.first().map(|form| form.arrays()) else {
        return String::new();
    };
    let row = Row::new(first);
    let block = format!("/// Entries of a block of a row.\nconst K: usize = {};", row.block);
    let mut texts = vec![
        include_str!("array_kernels/rows.rs"),
        match first.is_fused {
            true => include_str!("array_kernels/products_fused.rs"),
            false => include_str!("array_kernels/products.rs"),
        },
    ];
    let is_inverse = |step: &Step| matches!(step, Step::Invert { .. });
    let inverts = forms.iter().any(|form| form.arrays().steps.iter().any(is_inverse));
    if !row.is_one_block() && (inverts || !row.is_chain) {
        texts.extend(CHOICES);
    }
    texts.extend(pairs(row, &block));
    if inverts {
        texts.extend(inverse(row));
    }
    if forms.iter().any(|form| matches!(form, ArrayForm::Affine(_))) {
        texts.push(include_str!("array_kernels/dot.rs"));
    }
    pasted::loops(scalar, "Loops over arrays of joints: R rows of N entries, padded to L.", "arrays", &texts)
}

/// Choices by bits, for rows of several blocks.
const CHOICES: [&str; 2] =
    [include_str!("array_kernels/blocks/mask.rs"), include_str!("array_kernels/choose.rs")];

/// Matrices over pairs of joints.
fn pairs(row: Row, block: &str) -> Vec<&str> {
    if row.is_one_block() {
        return vec![
            include_str!("array_kernels/one_block/masks.rs"),
            include_str!("array_kernels/choose.rs"),
            include_str!("array_kernels/one_block/pairs.rs"),
        ];
    }
    vec![
        block,
        include_str!("array_kernels/blocks/products.rs"),
        match row.is_chain {
            true => include_str!("array_kernels/blocks/chain_pairs.rs"),
            false => include_str!("array_kernels/blocks/tree_pairs.rs"),
        },
    ]
}

/// The inverse, and what is multiplied by it.
fn inverse(row: Row) -> [&'static str; 3] {
    let apply = include_str!("array_kernels/apply.rs");
    match row.is_one_block() {
        true => [
            include_str!("array_kernels/one_block/inverse.rs"),
            include_str!("array_kernels/one_block/matrix_products.rs"),
            apply,
        ],
        false => [
            include_str!("array_kernels/blocks/inverse.rs"),
            match row.is_chain {
                true => include_str!("array_kernels/blocks/matrix_products.rs"),
                false => include_str!("array_kernels/blocks/tree_matrix_products.rs"),
            },
            apply,
        ],
    }
}
