//! Elementary functions in C. They are texts that the module includes, or functions of the C library that are
//! single processor instructions.

use gelenk_kernels::math::{C_BITS, C_BITS_F32, Kernel};

use super::context::Context;
use crate::emit::kernels;
use crate::emit::options::Scalar;
use gelenk_formula::Function as Call;

/// Name of the function to call for an elementary function. Sine and cosine are not included, because they
/// are computed in pairs.
pub(super) fn callee(context: &Context<'_>, function: Call) -> String {
    match function {
        Call::Sign => {
            context.sign.set(true);
            context.function("sign")
        }
        Call::Abs => of_scalar(context, "fabs"),
        // The instruction of the processor is rounded correctly, like the function in Rust modules.
        Call::Sqrt => of_scalar(context, "sqrt"),
        Call::Tanh => own(context, [Kernel::Tanh, Kernel::TanhF32]),
        Call::Exp => own(context, [Kernel::Exp, Kernel::ExpF32]),
        Call::Sin | Call::Cos => unreachable!("`statement` writes sines and cosines as pairs"),
    }
}

/// Name of the C function that computes `a b + c` with one rounding.
pub(super) fn multiply_add(context: &Context<'_>) -> String {
    of_scalar(context, "fma")
}

/// Name of the C function that negates a fused multiply-add. Without it, gcc 12 would replace `−(a b + c)` by
/// `−a b − c`, whose sign differs if the value is zero.
pub(super) fn negate_fused(context: &Context<'_>) -> String {
    context.negation.set(true);
    context.function("negated")
}

/// Name of the C function that computes sine and cosine of one angle.
pub(super) fn sin_cos(context: &Context<'_>) -> String {
    own(context, [Kernel::SinCos, Kernel::SinCosF32])
}

/// Name of the C function that computes sines and cosines of `lanes` = 2, 4 or 8 angles.
pub(super) fn sin_cos_of(context: &Context<'_>, lanes: usize) -> String {
    own(context, kernels::sin_cos_of(lanes))
}

fn own(context: &Context<'_>, kernels: [Kernel; 2]) -> String {
    let kernel = kernels::of_scalar(kernels, context.options.scalar);
    context.kernels.borrow_mut().insert(kernel);
    context.function(kernel.name())
}

fn of_scalar(context: &Context<'_>, name: &str) -> String {
    match context.options.scalar {
        Scalar::F64 => name.to_owned(),
        Scalar::F32 => format!("{name}f"),
    }
}

/// The text of the elementary functions that the module calls, and of all functions that these functions
/// call.
pub(super) fn text(context: &Context<'_>) -> String {
    let needed = kernels::needed(&context.kernels.borrow());
    let texts = needed.iter().map(|&kernel| source(kernel));
    let bits = match context.options.scalar {
        Scalar::F64 => C_BITS,
        Scalar::F32 => C_BITS_F32,
    };
    let bits = (!needed.is_empty()).then_some(bits);
    let mut text: String = bits.into_iter().chain(texts).map(|text| format!("\n{text}")).collect();
    text = context.pasted(&text);
    if context.sign.get() {
        text.push_str(&context.pasted_loops(SIGN));
    }
    if context.negation.get() {
        text.push_str(&context.pasted(match context.options.scalar {
            Scalar::F64 => NEGATED,
            Scalar::F32 => NEGATED_F32,
        }));
    }
    text
}

fn source(kernel: Kernel) -> &'static str {
    let source = kernel.c_source();
    source.unwrap_or_else(|| unreachable!("nothing in C calls functions over several states"))
}

const SIGN: &str = "
// Sign of x: -1, 0 or 1; NaN for NaN.
static inline double gelenk_sign(double x)
{
    return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : x == 0.0 ? 0.0 : x;
}
";

const NEGATED: &str = "
// Negates a fused sum by its sign bit. With a minus, gcc would negate the operands, which changes the sign of zero.
static inline double gelenk_negated(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    bits ^= UINT64_C(1) << 63;
    memcpy(&x, &bits, sizeof x);
    return x;
}
";

const NEGATED_F32: &str = "
// Negates a fused sum by its sign bit. With a minus, gcc would negate the operands, which changes the sign of zero.
static inline float gelenk_negated(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    bits ^= UINT32_C(1) << 31;
    memcpy(&x, &bits, sizeof x);
    return x;
}
";

/// Text that stops the compilation for processors without fused multiply-add. On these processors, `fma` is a
/// call of the library that takes as long as thirty operations. The text is empty if the module has no fused
/// multiply-adds.
pub(super) fn guard(context: &Context<'_>) -> &'static str {
    match (kernels::are_fused(&context.module.functions), context.options.scalar) {
        (false, _) => "",
        (true, Scalar::F64) => GUARD_F64,
        (true, Scalar::F32) => GUARD_F32,
    }
}

const GUARD_F64: &str = "
#if !defined(__FP_FAST_FMA) && !defined(__FMA__) && !defined(__aarch64__)
#error \"these functions contain fused multiply-adds: compile them with -mfma, or generate the module without fused multiply-adds\"
#endif
";

const GUARD_F32: &str = "
#if !defined(__FP_FAST_FMAF) && !defined(__FMA__) && !defined(__aarch64__) && !defined(__ARM_FEATURE_FMA)
#error \"these functions contain fused multiply-adds: compile them with -mfma, or generate the module without fused multiply-adds\"
#endif
";
