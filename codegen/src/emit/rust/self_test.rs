//! Prints tests at the end of a module. They compare the functions with values of the generator's
//! interpreter.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::context::Context;
use super::lints;
use super::signature::in_rows;
use crate::emit::options::Scalar;
use crate::functions::function::Function;
use crate::program::Shape;
use crate::self_test::SelfTest;

/// Largest allowed deviation, relative to the largest entry of a result. Rounding may differ if a compiler
/// contracts products and sums, or if sine and cosine are functions of std.
fn tolerance(scalar: Scalar) -> f64 {
    match scalar {
        Scalar::F64 => 1e-12,
        Scalar::F32 => 1e-3,
    }
}

/// The module with tests of the functions; `None` if no tests are requested.
pub(super) fn item(context: &Context<'_>) -> Option<TokenStream> {
    let tests = &context.module.self_tests;
    if tests.is_empty() {
        return None;
    }
    let ty = context.options.scalar.ty();
    let tolerance = context.options.scalar.literal(tolerance(context.options.scalar));
    let calls_of = |function: &Function| {
        let calls = tests.iter().filter(|call| call.function == function.name);
        calls.collect::<Vec<_>>()
    };
    let functions = context.module.functions.iter();
    let tested = functions.map(|function| (function, calls_of(function)));
    let tested = tested.filter(|(_, calls)| !calls.is_empty());
    let functions = tested.map(|(function, calls)| test(context, function, &calls));
    Some(quote! {
        #[doc = " Compares the functions of this module at pseudo-random states with values of the generator's interpreter."]
        #[cfg(test)]
        mod self_test {
            fn assert_close(found: &[#ty], expected: &[#ty]) {
                assert_eq!(found.len(), expected.len());
                let size = expected.iter().fold(0.0, |size: #ty, x| size.max(x.abs()));
                for (entry, (found, expected)) in found.iter().zip(expected).enumerate() {
                    let close = (found - expected).abs() <= #tolerance * size;
                    assert!(close, "entry {entry} is {found}, not {expected}");
                }
            }
            #(#functions)*
        }
    })
}

/// The test of one function: it compares the results of calls with the generator's values.
fn test(context: &Context<'_>, function: &Function, calls: &[&SelfTest]) -> TokenStream {
    let name = format_ident!("{}", function.name);
    let outputs = function.program.outputs.iter();
    let shapes: Vec<Shape> = outputs.map(|output| output.shape).collect();
    let literal = |x: &f64| context.options.scalar.literal(*x);
    let parameters = context.passed_parameters();
    let parameters = parameters.map(|_| quote!(&super::Parameters::default()));
    let numbers = calls.iter().flat_map(|call| call.arguments.iter().chain(&call.results));
    let allowed = lints::for_numbers(numbers.flatten().copied());
    let calls = calls.iter().map(|call| {
        let inputs = function.program.inputs.iter();
        let arguments = call.arguments.iter().zip(inputs).map(|(entries, input)| {
            let entries = in_rows(input.extent, entries.iter().map(literal).collect());
            quote!(&#entries)
        });
        let arguments = arguments.chain(parameters.clone());
        let found: Vec<_> = (0..shapes.len()).map(|k| format_ident!("r{k}")).collect();
        let pattern = match found.as_slice() {
            [only] => quote!(#only),
            _ => quote!((#(#found),*)),
        };
        let checks = found.iter().zip(&shapes).zip(&call.results).map(|((found, shape), expected)| {
            let found = match shape {
                Shape::Scalar => quote!(&[#found]),
                Shape::Vector(_) => quote!(&#found),
                Shape::Matrix(..) => quote!(#found.as_flattened()),
            };
            let expected = expected.iter().map(literal);
            quote!(assert_close(#found, &[#(#expected),*]);)
        });
        quote! {{
            let #pattern = super::#name(#(#arguments),*);
            #(#checks)*
        }}
    });
    quote! {
        #allowed
        #[test]
        fn #name() { #(#calls)* }
    }
}
