//! Where generated code takes sine, cosine, tanh and exp from: the one place that knows.

use std::collections::BTreeSet;

use proc_macro2::TokenStream;
use quote::quote;

use super::EmitOptions;
use super::literal::Scalar;
use crate::dynamics::function::Function;
use crate::formula::Function as Call;
use crate::program::Operation;

/// Source of the functions that a module calls.
///
/// The interpreter must run with the same ones ([`crate::program::interpret::Functions`]), else the bits differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Math {
    /// Methods of std: `x.sin_cos()`.
    #[default]
    Std,
    /// Our own functions, pasted into the module: `sin_cos(x)`. Only those that are called, and what they need.
    Embedded(&'static [MathItem]),
}

/// A private function or constant to paste into a module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MathItem {
    /// Its name. Programs call `sin_cos`, `sin`, `cos`, `tanh` and `exp`.
    pub name: &'static str,
    /// Its text for f64.
    pub f64_text: &'static str,
    /// Its text for f32.
    pub f32_text: &'static str,
    /// Names of the items that it uses.
    pub uses: &'static [&'static str],
}

/// Names of the module's own functions, pasted ones included: nothing else may be named like them.
pub(super) fn names(options: &EmitOptions) -> impl Iterator<Item = &'static str> {
    let pasted = match options.math {
        Math::Std => &[],
        Math::Embedded(items) => items,
    };
    ["sin_cos", "sin", "cos", "tanh", "exp", "sign"]
        .into_iter()
        .chain(pasted.iter().map(|item| item.name))
}

/// A call of a function of one argument.
pub(super) fn call(math: Math, name: &str, receiver: &TokenStream) -> TokenStream {
    let name = super::names::identifier(name);
    match math {
        Math::Embedded(items) if items.iter().any(|item| name == item.name) => {
            quote!(#name(#receiver))
        }
        _ => quote!(#receiver.#name()),
    }
}

/// The functions that the module's programs call: those pasted in, and `sign`.
pub(super) fn items(options: &EmitOptions, functions: &[Function]) -> Vec<TokenStream> {
    let called = called(functions);
    let mut items = Vec::new();
    if let Math::Embedded(pasted) = options.math {
        items.extend(
            needed(pasted, &called)
                .into_iter()
                .map(|item| item_tokens(item, options.scalar)),
        );
    }
    if called.contains("sign") {
        items.push(sign(options.scalar));
    }
    items
}

fn called(functions: &[Function]) -> BTreeSet<&'static str> {
    let instructions = functions
        .iter()
        .flat_map(|function| &function.program.instructions);
    instructions
        .filter_map(|instruction| match instruction.operation {
            Operation::SinCos(_) => Some("sin_cos"),
            Operation::Call(function, _) => Some(function_name(function)),
            _ => None,
        })
        .collect()
}

pub(super) fn function_name(function: Call) -> &'static str {
    match function {
        Call::Sin => "sin",
        Call::Cos => "cos",
        Call::Tanh => "tanh",
        Call::Exp => "exp",
        Call::Abs => "abs",
        Call::Sign => "sign",
    }
}

/// The pasted items reachable from `called`, in the order of `items`.
fn needed(items: &'static [MathItem], called: &BTreeSet<&'static str>) -> Vec<&'static MathItem> {
    let mut wanted = called.clone();
    loop {
        let uses = items
            .iter()
            .filter(|item| wanted.contains(item.name))
            .flat_map(|item| item.uses.iter().copied());
        let more: BTreeSet<_> = uses.chain(wanted.iter().copied()).collect();
        if more.len() == wanted.len() {
            break;
        }
        wanted = more;
    }
    items
        .iter()
        .filter(|item| wanted.contains(item.name))
        .collect()
}

fn item_tokens(item: &MathItem, scalar: Scalar) -> TokenStream {
    let text = match scalar {
        Scalar::F64 => item.f64_text,
        Scalar::F32 => item.f32_text,
    };
    text.parse()
        .unwrap_or_else(|_| quote!(compile_error!("the pasted function is no Rust");))
}

/// `signum` of std is ±1 at ±0; the sign of a force law is 0 there.
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

#[cfg(test)]
mod tests {
    use super::*;

    const ITEMS: &[MathItem] = &[
        MathItem {
            name: "reduce",
            f64_text: "",
            f32_text: "",
            uses: &[],
        },
        MathItem {
            name: "sin_cos",
            f64_text: "",
            f32_text: "",
            uses: &["reduce"],
        },
        MathItem {
            name: "exp",
            f64_text: "",
            f32_text: "",
            uses: &[],
        },
    ];

    #[test]
    fn only_what_is_needed_is_pasted() {
        let names = |called: &[&'static str]| -> Vec<_> {
            needed(ITEMS, &called.iter().copied().collect())
                .iter()
                .map(|item| item.name)
                .collect()
        };
        assert_eq!(names(&["sin_cos"]), ["reduce", "sin_cos"]);
        assert_eq!(names(&["exp"]), ["exp"]);
        assert!(names(&[]).is_empty());
    }
}
