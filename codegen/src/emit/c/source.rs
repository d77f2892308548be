//! Prints the source of a module: constants, private functions, public functions.

use super::context::Context;
use super::{array_kernels, constants, discrete_time, function, group, header, math, parameters, positions};

/// Prints the file `<name>.c`.
pub(super) fn text(context: &Context<'_>) -> String {
    let module = context.module;
    let mut functions = String::new();
    for (each, name) in module.functions.iter().zip(&context.functions) {
        // One function is printed at a time, because the intermediate data of a large function take much
        // memory.
        let items = function::items(context, each, name);
        functions.extend(items.iter().map(|item| format!("\n{item}")));
    }
    let constants = module.functions.iter().flat_map(|function| &function.constants);
    let constants = module.constants.iter().chain(constants);
    let constants = constants.filter_map(|constant| constants::definition(context, constant));
    let constants = constants.chain(parameters::definition(context));
    let positions = positions::text(context);
    let body = [
        constants.map(|item| format!("\n{item}")).collect(),
        math::text(context),
        group::text(context),
        context.tables.text(),
        array_kernels::text(context),
        context.shared.text(),
        functions,
        positions,
        discrete_time::text(context),
    ];
    let body = body.concat();
    let guard = math::guard(context);
    [
        header::top(context),
        includes(context, &body),
        CHECKS.to_owned(),
        guard.to_owned(),
        macros(context, &body),
        body,
    ]
    .concat()
}

/// Includes of C library headers for the types, macros and single-instruction functions that the text uses.
fn includes(context: &Context<'_>, body: &str) -> String {
    let needed = |header: &str, words: &[&str]| {
        let is_needed = words.iter().any(|word| body.contains(word));
        is_needed.then(|| format!("#include <{header}>\n"))
    };
    let headers = [
        Some("#include <float.h>\n".to_owned()),
        needed("math.h", &["INFINITY", "NAN", "fabs", "fma", "copysign", "sqrt"]),
        needed("stdint.h", &["uint64_t", "uint32_t"]),
        needed("string.h", &["memcpy", "memset", "size_t"]),
    ];
    let headers: String = headers.into_iter().flatten().collect();
    format!("\n#include \"{}.h\"\n\n{headers}", context.name)
}

/// Text that stops the compilation if a setting of the compiler would change results without a warning.
const CHECKS: &str = "
// Every operation must be rounded once, to the type of its operands. Other precisions, contraction to fused
// multiply-adds and algebraic transformations are not allowed, because elementary functions rely on this.
#if FLT_EVAL_METHOD != 0 && FLT_EVAL_METHOD != 16
#error \"this compiler does not compute in the precision of the operands: on x86 use -msse2 -mfpmath=sse\"
#endif
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) \\
    || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error \"-ffast-math and its parts change the results: compile this file without them\"
#endif
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize (\"fp-contract=off\")
#if __GNUC__ == 12 && __GNUC_MINOR__ < 3
/* These versions contract vectorized straight-line code in spite of this option. */
#pragma GCC optimize (\"no-tree-slp-vectorize\")
#endif
#else
#pragma STDC FP_CONTRACT OFF
#endif
";

/// Macros for extensions of C99 that the text uses.
fn macros(context: &Context<'_>, body: &str) -> String {
    let with = [
        ("INLINE", "static inline __attribute__((always_inline))", "static inline"),
        ("NOINLINE", "__attribute__((noinline))", ""),
        ("ALIGNED", "__attribute__((aligned(64)))", ""),
    ];
    let needed = with.map(|(name, gnu, other)| (context.constant(name), gnu, other));
    let needed = needed.iter().filter(|(name, ..)| body.contains(name.as_str()));
    let needed: Vec<_> = needed.collect();
    if needed.is_empty() {
        return String::new();
    }
    let define = |name: &str, value: &str| format!("{}\n", format!("#define {name} {value}").trim_end());
    let gnu: String = needed.iter().map(|(name, gnu, _)| define(name, gnu)).collect();
    let other: String = needed.iter().map(|(name, _, other)| define(name, other)).collect();
    format!("\n#if defined(__GNUC__)\n{gnu}#else\n{other}#endif\n")
}
