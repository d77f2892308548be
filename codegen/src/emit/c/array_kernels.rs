//! Texts of loops over joints. A module includes the texts that its functions use.

use super::arrays::{MEETINGS, RELATIONS};
use super::context::Context;
use crate::emit::arrays::Row;
use crate::emit::options::Scalar;
use crate::program::arrays::{ArrayForm, Arrays, Step};

/// Text of the loops over joints that the functions of a module call. The sizes of rows come first.
pub(super) fn text(context: &Context<'_>) -> String {
    let functions = context.module.functions.iter();
    let forms: Vec<&ArrayForm> = functions.filter_map(|function| function.arrays.as_ref()).collect();
    let Some(first) = forms.first().map(|form| form.arrays()) else {
        return String::new();
    };
    let has = |wanted: fn(&Step) -> bool| forms.iter().any(|form| form.arrays().steps.iter().any(wanted));
    let inverts = has(|step| matches!(step, Step::Invert { .. }));
    let has_pairs = has(|step| matches!(step, Step::Pairs(_)));
    let [sizes_of_parts, access, products_of_parts] = parts(context, first);
    let choices = (inverts || has_pairs).then_some(include_str!("array_kernels/part_choices.c"));
    let mut texts: Vec<&str> = [sizes_of_parts, access].into_iter().chain(choices).collect();
    texts.push(products_of_parts);
    let of_pairs: Vec<String> = match has_pairs {
        true => pairs(first).map(|text| of_joints(first, text)).into(),
        false => vec![],
    };
    texts.extend(of_pairs.iter().map(String::as_str));
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
        texts.extend([products(first), include_str!("array_kernels/dot.c")]);
    }
    let mut texts: String = texts.iter().map(|text| format!("\n{text}")).collect();
    if context.options.scalar == Scalar::F32 {
        texts = texts.replace("int64_t", "int32_t");
    }
    let meetings = if inverts { meetings(first) } else { String::new() };
    [context.pasted(&[sizes(first), meetings].concat()), context.pasted_loops(&texts)].concat()
}

/// Texts of operations on several columns at once, with the vector types of gcc and clang. Without these
/// types, gcc 12 did not vectorize the loops.
fn parts(context: &Context<'_>, form: &Arrays) -> [&'static str; 3] {
    [
        match context.options.scalar {
            Scalar::F64 => include_str!("array_kernels/parts.c"),
            Scalar::F32 => include_str!("array_kernels/parts_f32.c"),
        },
        include_str!("array_kernels/part_access.c"),
        match form.is_fused {
            true => include_str!("array_kernels/part_products_fused.c"),
            false => include_str!("array_kernels/part_products.c"),
        },
    ]
}

/// Text of the loops that compute sums of products of single numbers.
fn products(form: &Arrays) -> &'static str {
    match form.is_fused {
        true => include_str!("array_kernels/products_fused.c"),
        false => include_str!("array_kernels/products.c"),
    }
}

/// Texts of the loops that compute matrices over pairs of joints.
fn pairs(form: &Arrays) -> [&'static str; 2] {
    let pairs = match form.is_chain() {
        true => include_str!("array_kernels/chain_pairs.c"),
        false => include_str!("array_kernels/tree_pairs.c"),
    };
    [include_str!("array_kernels/row_products.c"), pairs]
}

/// The text of a loop over joints. The number of joints replaces the number of coordinates if they differ.
fn of_joints(form: &Arrays, text: &str) -> String {
    match form.coordinates {
        None => text.to_owned(),
        Some(_) => text.replace("GELENK_L", "GELENK_JOINTS_L").replace("GELENK_N", "GELENK_JOINTS_N"),
    }
}

/// Macros for the lengths of array rows.
fn sizes(form: &Arrays) -> String {
    let row = Row::new(form);
    if form.coordinates.is_some() {
        return format!(
            "\n// Numbers of entries of rows over coordinates and over joints of the loops, including padding. Then the \
             number of these joints, and the number of entries of a block of a row.\n\
             #define GELENK_L {}\n#define GELENK_JOINTS_L {}\n#define GELENK_JOINTS_N {}\n#define GELENK_K {}\n",
            row.coordinates,
            row.len,
            form.joints.len(),
            row.block
        );
    }
    format!(
        "\n// Number of entries of a row, including padding, and number of entries of a block of a row.\n\
         #define GELENK_L {}\n#define GELENK_K {}\n",
        row.len, row.block
    )
}

/// Macros for the order of the pivots in the inversion of the mass matrix, and for the pairs of rows that
/// have common non-zero entries.
fn meetings(form: &Arrays) -> String {
    let mut text =
        "\n// Joint of each pivot, from the base, and whether the inversion combines the rows of two joints.\n".to_owned();
    let tree = form.coordinates();
    if tree.order.is_sorted() {
        text.push_str("#define GELENK_PIVOT(step) (step)\n");
    } else {
        let order: Vec<String> = tree.order.iter().map(ToString::to_string).collect();
        text.push_str(&format!(
            "static const int gelenk_order[GELENK_N] = {{{}}};\n#define GELENK_PIVOT(step) gelenk_order[step]\n",
            order.join(", ")
        ));
    }
    let relations = match form.coordinates {
        None => RELATIONS,
        Some(_) => MEETINGS,
    };
    text.push_str(&match tree.is_chain() {
        true => "#define GELENK_MEET(i, k) ((i) != (k))\n".to_owned(),
        false => {
            format!("#define GELENK_MEET(i, k) ((i) != (k) && gelenk_{relations}[i][k] != 0)\n")
        }
    });
    text
}
