//! The loops of array forms, pasted into modules that need them.

use super::context::Context;
use crate::emit::arrays::Row;
use crate::program::arrays::{ArrayForm, Arrays, Step};

/// The loops that the functions call, after the relations of a tree's joints.
pub(super) fn text(context: &Context<'_>) -> String {
    let functions = context.module.functions.iter();
    let forms: Vec<&ArrayForm> = functions.filter_map(|function| function.arrays.as_ref()).collect();
    let Some(first) = forms.first().map(|form| form.arrays()) else {
        return String::new();
    };
    let has = |wanted: fn(&Step) -> bool| forms.iter().any(|form| form.arrays().steps.iter().any(wanted));
    let inverts = has(|step| matches!(step, Step::Invert { .. }));
    let mut texts = vec![match first.is_fused {
        true => include_str!("array_kernels/products_fused.c"),
        false => include_str!("array_kernels/products.c"),
    }];
    if has(|step| matches!(step, Step::Pairs(_))) {
        texts.push(include_str!("array_kernels/products_of_rows.c"));
        texts.push(match first.is_chain() {
            true => include_str!("array_kernels/chain_pairs.c"),
            false => include_str!("array_kernels/tree_pairs.c"),
        });
    }
    if inverts {
        texts.push(include_str!("array_kernels/inverse.c"));
    }
    if has(|step| matches!(step, Step::NegativeProduct { .. })) {
        texts.push(include_str!("array_kernels/matrix_products.c"));
    }
    if has(|step| matches!(step, Step::Apply { .. })) {
        texts.push(include_str!("array_kernels/apply.c"));
    }
    if forms.iter().any(|form| matches!(form, ArrayForm::Affine(_))) {
        texts.push(include_str!("array_kernels/dot.c"));
    }
    let texts: String = texts.iter().map(|text| format!("\n{text}")).collect();
    let meetings = if inverts { meetings(first) } else { String::new() };
    [context.pasted(&[sizes(first), meetings].concat()), context.pasted_loops(&texts)].concat()
}

/// Lengths of rows.
fn sizes(form: &Arrays) -> String {
    let row = Row::new(form);
    format!(
        "\n// Entries of a row, one for each joint and padding, and of a block of it.\n\
         #define GELENK_L {}\n#define GELENK_K {}\n",
        row.len, row.block
    )
}

/// The order of the pivots, and which of their rows meet.
fn meetings(form: &Arrays) -> String {
    let mut text =
        "\n// The joint of each pivot from the base, and whether the rows of two joints meet in the inverse.\n".to_owned();
    if form.order.is_sorted() {
        text.push_str("#define GELENK_PIVOT(step) (step)\n");
    } else {
        let order: Vec<String> = form.order.iter().map(ToString::to_string).collect();
        text.push_str(&format!(
            "static const int gelenk_order[GELENK_N] = {{{}}};\n#define GELENK_PIVOT(step) gelenk_order[step]\n",
            order.join(", ")
        ));
    }
    text.push_str(match form.is_chain() {
        true => "#define GELENK_MEET(i, k) ((i) != (k))\n",
        false => "#define GELENK_MEET(i, k) ((i) != (k) && gelenk_relations[i][k] != 0)\n",
    });
    text
}
