//! Prints a long Rust function as several private functions (parts), which exchange values.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::body::Body;
use super::doc_comment::DocComment;
use super::lints;
use super::signature::{Signature, item};
use crate::program::Operand;
use crate::program::split::{Part, Reads};

/// Arguments of one part of a long function, in a call or a signature.
pub(super) struct Taken {
    /// Array with the values of earlier parts that this part reads; `None` if there are none.
    pub(super) values: Option<TokenStream>,
    /// Inputs of the whole function that the part reads.
    pub(super) inputs: Vec<TokenStream>,
    /// The free parameters; `None` if the part does not read them.
    pub(super) parameters: Option<TokenStream>,
}

impl Taken {
    /// Arguments of one part of a long function, in the part's call.
    pub(super) fn called(body: &Body<'_>, part: &Part) -> Self {
        let inputs = part.inputs.iter().map(|&input| &body.arguments[input]);
        let parameters = body.context.passed_parameters();
        Self {
            values: (!part.takes.is_empty()).then(|| values(body, &part.takes)),
            inputs: inputs.map(|name| quote!(#name)).collect(),
            parameters: parameters.filter(|_| part.reads_parameters),
        }
    }

    /// Arguments of one part of a long function, in the part's signature.
    pub(super) fn declared(body: &Body<'_>, part: &Part, signature: &Signature) -> Self {
        let parameters = body.context.declared_parameters();
        let inputs = part.inputs.iter();
        let values = (!part.takes.is_empty()).then(|| {
            let (values, ty) = (values(body, &part.takes), array(body, &part.takes));
            quote!(#values: #ty)
        });
        Self {
            values,
            inputs: inputs.map(|&input| signature.arguments[input].clone()).collect(),
            parameters: parameters.filter(|_| part.reads_parameters),
        }
    }
}

/// Tokens of an array expression, or of an array pattern, with the names of these values.
pub(super) fn values(body: &Body<'_>, values: &[usize]) -> TokenStream {
    let names = values.iter().map(|&value| body.name(value));
    quote!([#(#names),*])
}

/// Type of an array that contains these values.
pub(super) fn array(body: &Body<'_>, values: &[usize]) -> TokenStream {
    let (ty, count) = (body.context.ty(), Literal::usize_unsuffixed(values.len()));
    quote!([#ty; #count])
}

/// Statements of a split function: one call for each part, then the results.
pub(super) fn calls(body: &Body<'_>, name: &Ident, parts: &[Part]) -> TokenStream {
    let calls = parts.iter().enumerate().map(|(i, part)| {
        let callee = part_name(name, i);
        let taken = Taken::called(body, part);
        let arguments = taken.inputs.into_iter().chain(taken.values);
        let arguments = arguments.chain(taken.parameters);
        let returns = values(body, &part.returns);
        quote!(let #returns = #callee(#(#arguments),*);)
    });
    if body.results.is_empty() {
        let results = body.returned();
        return quote!(#(#calls)* #results);
    }
    let stores = body.stores(|_| true);
    quote!(#(#calls)* #(#stores)*)
}

/// The private functions into which a long function is split; empty if the function is not split.
pub(super) fn items(
    body: &Body<'_>,
    name: &Ident,
    signature: &Signature,
    parts: &[Part],
) -> Vec<TokenStream> {
    let body = body.without_stores();
    match parts {
        [_] => vec![],
        _ => {
            let parts = parts.iter().enumerate();
            parts.map(|(i, part)| private(&body, name, i, part, signature)).collect()
        }
    }
}

/// Largest number of instructions of a function whose parts are inlined in optimized code. Without inlining,
/// parts exchange values through memory. Inlining reduces the time of a humanoid's forward dynamics to 75 %,
/// and the time of the Jacobians of a quadruped's inverse dynamics to 85 %. Parts of longer functions are not
/// inlined, because the compile time in LLVM grows faster than the length of a function.
const MOST_INLINED: usize = 12_000;

/// The private function of one part of a long function.
fn private(body: &Body<'_>, name: &Ident, index: usize, part: &Part, signature: &Signature) -> TokenStream {
    let callee = part_name(name, index);
    let taken = Taken::declared(body, part, signature);
    let arguments = taken.inputs.into_iter().chain(taken.values);
    let arguments = arguments.chain(taken.parameters);
    let names = body.value_names_in(part.range.clone());
    let names = names.chain(part.takes.iter().map(|&value| body.name(value)));
    let statements = body.statements(part.range.clone());
    let (returns, ty) = (values(body, &part.returns), array(body, &part.returns));
    let documentation = format!("Part {} of `{name}`: returns values that later parts read.", index + 1);
    let inlined = match body.program.instructions.len() <= MOST_INLINED {
        true => quote!(#[inline(always)]),
        false => quote!(#[inline(never)]),
    };
    item(
        &DocComment::new(&documentation),
        [
            Some(inlined),
            lints::for_names(names.chain([name])),
            lints::for_numbers(body.numbers_in(part.range.clone())),
        ],
        &quote!(fn #callee(#(#arguments),*) -> #ty),
        &quote!(#(#statements)* #returns),
    )
}

fn part_name(name: &Ident, index: usize) -> Ident {
    format_ident!("{}_part_{}", name, index + 1)
}

/// Names of the arguments that are used neither by the parts nor by the operands `others`.
pub(super) fn unused(
    body: &Body<'_>,
    parts: &[Part],
    others: impl Iterator<Item = Operand>,
) -> Vec<TokenStream> {
    let others = Reads::new(others, &body.flow);
    let reads_input = |array: &usize| {
        let mut parts = parts.iter();
        others.inputs.contains(array) || parts.any(|part| part.inputs.contains(array))
    };
    let reads_parameters = others.parameters || parts.iter().any(|part| part.reads_parameters);
    let inputs = body.arguments.iter().enumerate();
    let inputs = inputs.filter(|(array, _)| !reads_input(array));
    let parameters = body.context.passed_parameters();
    inputs.map(|(_, name)| quote!(#name)).chain(parameters.filter(|_| !reads_parameters)).collect()
}
