//! Texts of loops over joints. A module includes the texts that its functions use.

use super::pasted;
use crate::emit::arrays::Row;
use crate::emit::options::Scalar;
use crate::functions::function::Function;
use crate::program::arrays::{ArrayForm, Step};

/// Text of a private module with the loops over joints that the functions call; empty if no function has such
/// loops.
pub(super) fn text(scalar: Scalar, functions: &[Function]) -> String {
    let forms: Vec<&ArrayForm> = functions.iter().filter_map(|function| function.arrays.as_ref()).collect();
    let Some(first) = forms.first().map(|form| form.arrays()) else {
        return String::new();
    };
    let row = Row::new(first);
    let block = format!("/// Number of entries of a block of a row.\nconst K: usize = {};", row.block);
    let mut texts = vec![
        include_str!("array_kernels/rows.rs"),
        match first.is_fused {
            true => include_str!("array_kernels/products_fused.rs"),
            false => include_str!("array_kernels/products.rs"),
        },
    ];
    let has = |wanted: fn(&Step) -> bool| forms.iter().any(|form| form.arrays().steps.iter().any(wanted));
    let has_pairs = has(|step| matches!(step, Step::Pairs(_)));
    let inverts = has(|step| matches!(step, Step::Invert { .. }));
    if !row.is_one_block() && (inverts || has_pairs && !row.is_chain) {
        texts.extend(CHOICES);
    }
    match row.is_one_block() || has_pairs {
        true => texts.extend(pairs(row, &block)),
        false => texts.push(&block),
    }
    if inverts {
        texts.push(inverse(row));
    }
    if has(|step| matches!(step, Step::NegativeProduct { .. })) {
        texts.push(matrix_products(row));
    }
    if has(|step| matches!(step, Step::Apply { .. })) {
        texts.push(include_str!("array_kernels/apply.rs"));
    }
    if forms.iter().any(|form| matches!(form, ArrayForm::Affine(_))) {
        texts.push(include_str!("array_kernels/dot.rs"));
    }
    pasted::loops(
        scalar,
        "Loops over arrays of R rows. A row has N entries, one per joint, padded to L.",
        "arrays",
        &texts,
    )
}

/// Texts of selections between two numbers by bit masks, for rows of several SIMD blocks.
const CHOICES: [&str; 2] =
    [include_str!("array_kernels/blocks/mask.rs"), include_str!("array_kernels/choose.rs")];

/// Texts of the loops that compute matrices with an entry per pair of joints.
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

/// Text of the loops that invert the mass matrix.
fn inverse(row: Row) -> &'static str {
    match row.is_one_block() {
        true => include_str!("array_kernels/one_block/inverse.rs"),
        false => include_str!("array_kernels/blocks/inverse.rs"),
    }
}

/// Text of the loops that multiply two matrices.
fn matrix_products(row: Row) -> &'static str {
    match (row.is_one_block(), row.is_chain) {
        (true, _) => include_str!("array_kernels/one_block/matrix_products.rs"),
        (false, true) => include_str!("array_kernels/blocks/matrix_products.rs"),
        (false, false) => include_str!("array_kernels/blocks/tree_matrix_products.rs"),
    }
}
