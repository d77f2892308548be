//! Elementary functions in generated Rust: their calls, and the texts that the module includes.

use std::collections::BTreeSet;

use proc_macro2::{Ident, Span, TokenStream};
use quote::quote;

use super::context::Context;
use super::pasted;
use crate::emit::kernels;
use crate::emit::options::Scalar;
use crate::functions::function::Function;
use gelenk_formula::Function as Call;
use gelenk_kernels::math::Kernel;

/// Names of private functions for calls. Other items must not have these names.
pub(super) const RESERVED: [&str; 1] = ["sign"];

/// Call of an elementary function of one argument. `receiver` is the argument in front of a method call, and
/// `argument` is the argument in parentheses.
pub(super) fn call(
    context: &Context<'_>,
    function: Call,
    receiver: &TokenStream,
    argument: &TokenStream,
) -> TokenStream {
    match function {
        Call::Sin => {
            let pair = sin_cos(context, argument);
            quote!(#pair.0)
        }
        Call::Cos => {
            let pair = sin_cos(context, argument);
            quote!(#pair.1)
        }
        Call::Tanh => own(context, [Kernel::Tanh, Kernel::TanhF32], argument),
        Call::Exp => own(context, [Kernel::Exp, Kernel::ExpF32], argument),
        Call::Sqrt => own(context, [Kernel::Sqrt, Kernel::SqrtF32], argument),
        Call::Abs => quote!(#receiver.abs()),
        Call::Sign => {
            context.calls.sign.set(true);
            quote!(sign(#argument))
        }
    }
}

/// Call that computes sine and cosine of one angle.
pub(super) fn sin_cos(context: &Context<'_>, argument: &TokenStream) -> TokenStream {
    own(context, [Kernel::SinCos, Kernel::SinCosF32], argument)
}

/// Call that computes sines and cosines of several angles, padded to `lanes` = 2, 4 or 8 angles.
pub(super) fn sin_cos_of(context: &Context<'_>, lanes: usize, angles: &[TokenStream]) -> TokenStream {
    let kernels = kernels::sin_cos_of(lanes);
    let zero = context.options.scalar.literal(0.0);
    let padding = std::iter::repeat_n(&zero, lanes.saturating_sub(angles.len()));
    let arguments = angles.iter().chain(padding);
    own(context, kernels, &quote!(#(#arguments),*))
}

/// Call that computes sines and cosines of one angle in several states. The arguments are references to the
/// angles, sines and cosines.
pub(super) fn sin_cos_lanes(context: &Context<'_>, arguments: &TokenStream) -> TokenStream {
    let kernels = [Kernel::SinCosLanes, Kernel::SinCosLanesF32];
    own(context, kernels, arguments)
}

/// Includes the functions that the texts for quaternions call.
pub(super) fn need_for_rotations(context: &Context<'_>) {
    let kernels = [[Kernel::SinCos, Kernel::SinCosF32], [Kernel::Sqrt, Kernel::SqrtF32]];
    let kernels = kernels.map(|kernels| kernels::of_scalar(kernels, context.options.scalar));
    context.calls.kernels.borrow_mut().extend(kernels);
}

/// Call of an elementary function whose text the module includes. `kernels` contains the functions for f64
/// and for f32.
fn own(context: &Context<'_>, kernels: [Kernel; 2], arguments: &TokenStream) -> TokenStream {
    let kernel = kernels::of_scalar(kernels, context.options.scalar);
    context.calls.kernels.borrow_mut().insert(kernel);
    let name = Ident::new(kernel.name(), Span::call_site());
    quote!(math::#name(#arguments))
}

/// The text of `sign` and of the elementary functions that the module calls.
pub(super) fn text(context: &Context<'_>) -> String {
    let mut text = String::new();
    if context.calls.sign.get() {
        super::items::push_items(&mut text, [sign(context.options.scalar)]);
    }
    text.push_str(&module(&kernels::needed(&context.calls.kernels.borrow())));
    text
}

/// Text that stops the compilation for processors without fused multiply-add. On these processors, `mul_add`
/// is a call of the library that takes as long as thirty operations. The text is empty if no function has
/// fused multiply-adds.
pub(super) fn guard(functions: &[Function]) -> &'static str {
    match kernels::are_fused(functions) {
        false => "",
        true => {
            r#"
#[cfg(not(any(target_feature = "fma", target_arch = "aarch64")))]
compile_error!(
    "these functions contain fused multiply-adds: compile them with `-C target-feature=+fma`, or generate the module without them"
);
"#
        }
    }
}

fn module(kernels: &BTreeSet<Kernel>) -> String {
    if kernels.is_empty() {
        return String::new();
    }
    let texts: Vec<&str> = kernels.iter().map(|kernel| kernel.source()).collect();
    pasted::module(
        "Elementary functions whose results have the same bits on every platform.",
        "#[allow(\n    clippy::approx_constant,\n    clippy::excessive_precision,\n    \
         reason = \"coefficients and parts of π are not those constants\"\n)]",
        "math",
        &texts,
    )
}

/// The function `sign`. At ±0 its value is 0, whereas `signum` of std is ±1.
fn sign(scalar: Scalar) -> TokenStream {
    let ty = scalar.ty();
    quote! {
        #[doc = " Sign of `x`: −1, 0 or 1; NaN for NaN."]
        #[inline]
        fn sign(x: #ty) -> #ty {
            if x == 0.0 { 0.0 } else { x.signum() }
        }
    }
}
