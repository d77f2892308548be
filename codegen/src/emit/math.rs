//! Where generated code takes sine, cosine, tanh and exp from: the one place that knows.

use std::collections::BTreeSet;

use proc_macro2::{Ident, Span, TokenStream};
use quote::quote;

use super::EmitOptions;
use super::literal::Scalar;
use crate::dynamics::function::Function;
use crate::formula::Function as Call;
use crate::program::flow::Flow;
use crate::program::{Operation, Program};

/// Source of the functions that a module calls.
///
/// The interpreter must run with the same ones ([`crate::program::interpret::Functions`]), else the bits differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Math {
    /// Methods of std: `x.sin_cos()`.
    #[default]
    Std,
    /// Our own functions, pasted into the module: `math::sin_cos(x)`. Only what is called, and what that requires.
    Embedded(&'static [MathText]),
}

/// The text of one function, with its private helpers, to paste into a module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MathText {
    /// Its name: `sin_cos`, `tanh` and `exp` are called, with `_f32` behind for that type; others are required.
    pub name: &'static str,
    /// Rust items; the called function is `pub`.
    pub text: &'static str,
    /// Names of what it calls itself.
    pub requires: &'static [&'static str],
}

/// Names of the module's own functions: nothing else may be named like them.
pub(super) const RESERVED: [&str; 1] = ["sign"];

/// A call of a function of one argument, which stands as `receiver` before a method and as `argument` in parentheses.
pub(super) fn call(
    options: &EmitOptions,
    name: &str,
    receiver: &TokenStream,
    argument: &TokenStream,
) -> TokenStream {
    let ident = |name: &str| Ident::new(name, Span::call_site());
    let Math::Embedded(texts) = options.math else {
        let name = ident(name);
        return quote!(#receiver.#name());
    };
    let pasted = pasted_name(name, options.scalar);
    if !texts.iter().any(|text| text.name == pasted) {
        let name = ident(name);
        return quote!(#receiver.#name());
    }
    let function = ident(&pasted);
    match name {
        "sin" => quote!(math::#function(#argument).0),
        "cos" => quote!(math::#function(#argument).1),
        _ => quote!(math::#function(#argument)),
    }
}

/// The pasted function behind a call: a sine or cosine alone is half of `sin_cos`.
fn pasted_name(name: &str, scalar: Scalar) -> String {
    let name = if matches!(name, "sin" | "cos") {
        "sin_cos"
    } else {
        name
    };
    match scalar {
        Scalar::F64 => name.to_owned(),
        Scalar::F32 => format!("{name}_f32"),
    }
}

/// The functions that the module's programs call: `sign`, and those pasted in.
pub(super) fn text(options: &EmitOptions, functions: &[Function]) -> String {
    let called = called(functions);
    let mut text = String::new();
    if called.contains("sign") {
        super::push_items(&mut text, [sign(options.scalar)]);
    }
    if let Math::Embedded(texts) = options.math {
        let called = called
            .iter()
            .map(|name| pasted_name(name, options.scalar))
            .collect();
        text.push_str(&module(&needed(texts, called)));
    }
    text
}

/// A module of its own keeps the names of helpers apart from those of a robot. Its text stays as it is: the pretty
/// printer would drop the comments.
fn module(texts: &[&MathText]) -> String {
    if texts.is_empty() {
        return String::new();
    }
    let indented = |line: &str| {
        if line.is_empty() {
            "\n".to_owned()
        } else {
            format!("    {line}\n")
        }
    };
    let texts: Vec<String> = texts
        .iter()
        .map(|text| text.text.trim().lines().map(indented).collect())
        .collect();
    format!(
        "\n/// Elementary functions that give the same bits on every platform.\n\
         #[allow(\n    clippy::approx_constant,\n    clippy::excessive_precision,\n    \
         reason = \"coefficients and parts of π are not those constants\"\n)]\nmod math {{\n{}}}\n",
        texts.join("\n")
    )
}

/// Functions that the statements call; what nothing reads is no statement, and an unused function would be a warning.
fn called(functions: &[Function]) -> BTreeSet<&'static str> {
    functions
        .iter()
        .flat_map(|function| called_by(&function.program))
        .collect()
}

fn called_by(program: &Program) -> BTreeSet<&'static str> {
    let flow = Flow::new(program);
    let made = program
        .instructions
        .iter()
        .enumerate()
        .filter(|(index, _)| flow.is_made(*index));
    made.filter_map(|(_, instruction)| match instruction.operation {
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

/// The texts reachable from `wanted`, in the order of `texts`.
fn needed(texts: &'static [MathText], mut wanted: BTreeSet<String>) -> Vec<&'static MathText> {
    loop {
        let reached = texts.iter().filter(|text| wanted.contains(text.name));
        let more: BTreeSet<String> = reached
            .flat_map(|text| text.requires)
            .map(|&name| name.to_owned())
            .collect();
        if more.is_subset(&wanted) {
            break;
        }
        wanted.extend(more);
    }
    texts
        .iter()
        .filter(|text| wanted.contains(text.name))
        .collect()
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

    const TEXTS: &[MathText] = &[
        MathText {
            name: "reduce",
            text: "",
            requires: &[],
        },
        MathText {
            name: "sin_cos",
            text: "",
            requires: &["reduce"],
        },
        MathText {
            name: "exp",
            text: "",
            requires: &[],
        },
    ];

    #[test]
    fn only_what_is_needed_is_pasted() {
        let names = |called: &[&str]| -> Vec<_> {
            let called = called.iter().map(|&name| name.to_owned()).collect();
            needed(TEXTS, called).iter().map(|text| text.name).collect()
        };
        assert_eq!(names(&["sin_cos"]), ["reduce", "sin_cos"]);
        assert_eq!(names(&["exp"]), ["exp"]);
        assert!(names(&[]).is_empty());
    }
}
