//! Code for several states at once: the type of values, access to entries in arrays, and elementary
//! functions.

use gelenk_kernels::math::Kernel;

use super::context::Context;
use super::literal::in_scalar;
use crate::emit::kernels;
use crate::emit::options::Scalar;

/// Number of states per call. In double precision, eight states need one register of AVX-512, two registers
/// of AVX2, and four registers of SSE2 or Neon.
pub(super) const COUNT: usize = 8;

/// Name of the vector type for the values of several states.
pub(super) fn ty(context: &Context<'_>) -> String {
    context.function("group")
}

/// Text of a vector with the same number for all states.
pub(super) fn same(context: &Context<'_>, number: &str) -> String {
    format!("{}({number})", context.function("same"))
}

/// Text that reads one entry of an argument for several states. The arrays of the states follow each other in
/// memory.
///
/// - `len`: number of entries of the argument for one state
pub(super) fn gather(context: &Context<'_>, argument: &str, index: usize, len: usize) -> String {
    format!("{}(&{argument}[{index}], {len})", context.function("gather"))
}

/// Statement that writes one entry, or two adjacent entries, of a result for several states.
///
/// - `len`: number of entries of the result for one state
pub(super) fn scatter(
    context: &Context<'_>,
    result: &str,
    index: usize,
    len: usize,
    values: &[String],
) -> String {
    let callee = context.function(if values.len() == 2 { "scatter_pair" } else { "scatter" });
    format!("{callee}(&{result}[{index}], {len}, {});", values.join(", "))
}

/// Name of the C function that applies an elementary function to several states at once.
pub(super) fn of_each(context: &Context<'_>, callee: &str, arguments: usize) -> String {
    let stem = callee.strip_prefix(&context.function("")).unwrap_or(callee);
    let scalar = context.options.scalar;
    let kernel = [[Kernel::Exp, Kernel::ExpF32], [Kernel::Tanh, Kernel::TanhF32]]
        .map(|kernels| kernels::of_scalar(kernels, scalar))
        .into_iter()
        .find(|kernel| kernel.name() == stem);
    match (kernel, stem.trim_end_matches('f')) {
        (Some(kernel), _) => own(context, kernel),
        (None, stem @ ("sign" | "fabs" | "negated")) => context.function(&format!("{stem}_lanes")),
        _ => one_by_one(context, callee, stem, arguments),
    }
}

/// Name of the C function that computes sine and cosine for several states at once.
pub(super) fn sin_cos(context: &Context<'_>) -> String {
    own(context, kernels::of_scalar([Kernel::SinCos, Kernel::SinCosF32], context.options.scalar))
}

fn own(context: &Context<'_>, kernel: Kernel) -> String {
    context.kernels.borrow_mut().insert(kernel);
    context.lanes_kernels.borrow_mut().insert(kernel);
    let name = match kernel.name().strip_suffix("_f32") {
        Some(stem) => format!("{stem}_lanes_f32"),
        None => format!("{}_lanes", kernel.name()),
    };
    context.function(&name)
}

/// Name of a function that calls a scalar function for each state. Compilers vectorize its loop if the scalar
/// function is one instruction.
fn one_by_one(context: &Context<'_>, callee: &str, stem: &str, arguments: usize) -> String {
    let names = &["x", "y", "z"][..arguments.min(3)];
    let list = |each: &dyn Fn(&str) -> String| -> String {
        names.iter().map(|name| each(name)).collect::<Vec<_>>().join(", ")
    };
    let declared = list(&|name| format!("gelenk_group {name}"));
    let arrays = list(&|name| format!("each_{name}[GELENK_WIDTH]"));
    let entries = list(&|name| format!("each_{name}[i]"));
    let stored: String = names.iter().map(|name| format!("    gelenk_put(each_{name}, {name});\n")).collect();
    let ty = context.ty();
    context.of_lanes.add(&context.function(&format!("{stem}_lanes")), |name| {
        context.pasted_names(&format!(
            "GELENK_INLINE gelenk_group {name}({declared})\n{{\n    {ty} {arrays};\n{stored}\
             \x20   for (int i = 0; i < GELENK_WIDTH; ++i) {{\n        each_x[i] = {callee}({entries});\n    }}\n\
             \x20   return gelenk_take(each_x);\n}}\n"
        ))
    })
}

/// Text of the types and functions that code over several states uses.
pub(super) fn text(context: &Context<'_>) -> String {
    if !context.has_lanes() {
        return String::new();
    }
    let group = match context.options.scalar {
        Scalar::F64 => include_str!("group.c"),
        Scalar::F32 => include_str!("group_f32.c"),
    };
    let bits = match context.options.scalar {
        Scalar::F64 => include_str!("bits.c").to_owned(),
        Scalar::F32 => {
            let text = include_str!("bits.c").replace("UINT64", "UINT32").replace("uint64", "uint32");
            in_scalar(&text, Scalar::F32).replace("fabsf_lanes", "fabs_lanes")
        }
    };
    let access = in_scalar(include_str!("access.c"), context.options.scalar);
    let needed = kernels::needed(&context.lanes_kernels.borrow());
    let kernels = needed.iter().filter_map(|kernel| kernel.c_lanes_source());
    let kernels: String = kernels.map(|text| format!("\n{text}")).collect();
    let text = context.pasted_names(&[group, &access, &bits, &kernels].concat());
    [text, context.of_lanes.text()].concat()
}
