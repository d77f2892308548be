//! A function: its documentation, its signature and its body, split where it is long.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::body::Body;
use super::doc_comment::{DocComment, code};
use super::split::{self, Part};
use super::{Context, affine, arrays, into, lanes, lints};
use crate::functions::function::Function;
use crate::layout::{Dimension, Extent};
use crate::program::arrays::ArrayForm;
use crate::program::{Operation, Shape, cost};

/// Up to so many instructions a function is offered to inlining in other crates: a call costs as much as they do.
const INLINE_UP_TO: usize = 40;

/// So many statements stay one block. Each `let` opens a scope within the last one, and with full debug information
/// rustc 1.95 describes scopes recursively: 4 600 of them overflow its stack. Blocks cost nothing once optimized.
const LONGEST_BLOCK: usize = 1000;

/// The public function, its variant with results in place, then the private ones it is split into.
pub(super) fn items(context: &Context<'_>, function: &Function, name: &Ident) -> Vec<TokenStream> {
    match &function.arrays {
        Some(ArrayForm::Steps(form)) => return arrays::items(context, function, form, name),
        Some(ArrayForm::Affine(form)) => return affine::items(context, function, form, name),
        None => {}
    }
    let mut body = Body::new(context, function);
    let parts = split::parts(body.program, &body.flow, context.options.longest_function);
    let lanes = lanes::plan(context, &body, function);
    if parts.len() > 1 && lanes.is_none() {
        body.stop_storing();
    }
    let signature = Signature::new(context, &body);
    let statements = match (parts.len(), body.results.is_empty()) {
        _ if let Some(plan) = &lanes => lanes::scalar_statements(context, &body, name, plan),
        (1, true) => plain_body(&body),
        (1, false) => storing_body(&body),
        _ => calls(context, &body, name, &parts),
    };
    let unused = unused(context, &body, &parts);
    let statements = quote!(#(let _ = #unused;)* #statements);
    let mut items = if body.results.is_empty() {
        vec![public(
            context,
            function,
            &body,
            name,
            &signature,
            &statements,
        )]
    } else {
        let returning = into::returning(context, &body, name);
        vec![
            public(context, function, &body, name, &signature, &returning),
            into::item(&body, name, &signature, &statements),
        ]
    };
    if let Some(plan) = &lanes {
        items.extend(lanes::items(context, &body, name, &signature, plan));
    } else if parts.len() > 1 {
        items.extend(
            parts
                .iter()
                .enumerate()
                .map(|(i, part)| private(context, &body, name, i, part, &signature)),
        );
    }
    items
}

/// The function that returns its results.
pub(super) fn public(
    context: &Context<'_>,
    function: &Function,
    body: &Body<'_>,
    name: &Ident,
    signature: &Signature,
    statements: &TokenStream,
) -> TokenStream {
    let documentation = documentation(context, function, body).tokens();
    let allowed = [
        lints::for_names(body.value_names().chain(&body.arguments).chain([name])),
        lints::for_numbers(body.numbers()),
        lints::for_result(&signature.dimensions),
    ];
    let allowed = allowed.iter().flatten();
    let is_short = body.program.instructions.len() <= INLINE_UP_TO || !body.results.is_empty();
    let inline = is_short.then(|| quote!(#[inline]));
    let (arguments, result) = (&signature.arguments, &signature.result);
    quote! {
        #documentation
        #inline
        #[must_use]
        #(#allowed)*
        pub fn #name(#(#arguments),*) -> #result { #statements }
    }
}

/// All statements, each entry of the results stored as soon as it is known: fewer values are alive.
fn storing_body(body: &Body<'_>) -> TokenStream {
    let constants = into::stores(body, |made| made.is_none());
    let statements = blocks(body, |_| true);
    quote!(#(#constants)* #statements)
}

/// The wanted statements, a long run of them as blocks that hand on what later ones read.
pub(super) fn blocks(body: &Body<'_>, is_wanted: impl Fn(usize) -> bool) -> TokenStream {
    let parts = split::parts(body.program, &body.flow, LONGEST_BLOCK);
    let blocks = parts.iter().enumerate().map(|(index, part)| {
        let statements = body.statements_among(part.range.clone(), &is_wanted);
        // What is stored in place already needs no name afterwards.
        let is_read = |value: &usize| {
            body.results.is_empty()
                || parts[index + 1..]
                    .iter()
                    .any(|part| part.takes.contains(value))
        };
        let returns = part
            .returns
            .iter()
            .filter(|&value| is_wanted(*value) && is_read(value));
        let returns: Vec<_> = returns.map(|&value| body.name(value)).collect();
        match (index + 1 == parts.len(), returns.is_empty()) {
            (true, _) => quote!(#(#statements)*),
            (false, true) => quote!({ #(#statements)* }),
            (false, false) => quote!(let [#(#returns),*] = { #(#statements)* [#(#returns),*] };),
        }
    });
    quote!(#(#blocks)*)
}

/// All statements and the results.
fn plain_body(body: &Body<'_>) -> TokenStream {
    if body.program.instructions.len() > LONGEST_BLOCK {
        let (statements, results) = (blocks(body, |_| true), body.returned());
        return quote!(#statements #results);
    }
    let mut statements = body.statements(0..body.program.instructions.len());
    if let Some(last) = returned_value(body)
        && let Some(value) = body.expression(body.program.instructions[last].operation)
    {
        statements.pop();
        return quote!(#(#statements)* #value);
    }
    let results = body.returned();
    quote!(#(#statements)* #results)
}

/// The last value, where it alone is the result: it needs no name (clippy's `let_and_return`).
pub(super) fn returned_value(body: &Body<'_>) -> Option<usize> {
    let [output] = body.program.outputs.as_slice() else {
        return None;
    };
    let (Shape::Scalar, [crate::program::Operand::Value(index)]) =
        (output.shape, output.entries.as_slice())
    else {
        return None;
    };
    let last = (0..body.program.instructions.len())
        .rev()
        .find(|&index| body.flow.is_made(index))?;
    let is_pair = matches!(
        body.program.instructions[last].operation,
        Operation::SinCos(_)
    );
    (last == *index && !is_pair).then_some(last)
}

/// The body of a split function: one call per part, and the results.
pub(super) fn calls(
    context: &Context<'_>,
    body: &Body<'_>,
    name: &Ident,
    parts: &[Part],
) -> TokenStream {
    let calls = parts.iter().enumerate().map(|(i, part)| {
        let callee = part_name(name, i);
        let inputs = part
            .inputs
            .iter()
            .map(|&input| body.arguments[input].clone());
        let takes = part.takes.iter().map(|&value| body.name(value));
        let takes = (!part.takes.is_empty()).then(|| quote!([#(#takes),*]));
        let parameters = (part.reads_parameters && context.has_parameters()).then(|| quote!(p));
        let arguments = inputs
            .map(|input| quote!(#input))
            .chain(takes)
            .chain(parameters);
        let returns = part.returns.iter().map(|&value| body.name(value));
        quote!(let [#(#returns),*] = #callee(#(#arguments),*);)
    });
    if body.results.is_empty() {
        let results = body.returned();
        return quote!(#(#calls)* #results);
    }
    let stores = into::stores(body, |_| true);
    quote!(#(#calls)* #(#stores)*)
}

fn part_name(name: &Ident, index: usize) -> Ident {
    format_ident!("{}_part_{}", name, index + 1)
}

/// The private function of a part. Never inlined: that would undo the splitting.
pub(super) fn private(
    context: &Context<'_>,
    body: &Body<'_>,
    name: &Ident,
    index: usize,
    part: &Part,
    signature: &Signature,
) -> TokenStream {
    let callee = part_name(name, index);
    let ty = context.options.scalar.ty();
    let inputs = part
        .inputs
        .iter()
        .map(|&input| signature.arguments[input].clone());
    let takes: Vec<&Ident> = part.takes.iter().map(|&value| body.name(value)).collect();
    let names = body.value_names_in(part.range.clone());
    let names = names.chain(takes.iter().copied()).chain([name]);
    let allowed = [
        lints::for_names(names),
        lints::for_numbers(body.numbers_in(part.range.clone())),
    ];
    let count = Literal::usize_unsuffixed(part.takes.len());
    let takes = (!part.takes.is_empty()).then(|| quote!([#(#takes),*]: [#ty; #count]));
    let parameters =
        (part.reads_parameters && context.has_parameters()).then(|| quote!(p: &Parameters));
    let arguments = inputs.chain(takes).chain(parameters);
    let statements = body.statements(part.range.clone());
    let returns = part.returns.iter().map(|&value| body.name(value));
    let count = Literal::usize_unsuffixed(part.returns.len());
    let documentation = DocComment::new(&format!(
        "Part {} of `{name}`: values that later parts read.",
        index + 1
    ));
    let documentation = documentation.tokens();
    let allowed = allowed.iter().flatten();
    quote! {
        #documentation
        #[inline(never)]
        #(#allowed)*
        fn #callee(#(#arguments),*) -> [#ty; #count] { #(#statements)* [#(#returns),*] }
    }
}

/// Arguments that the body never reads.
pub(super) fn unused(context: &Context<'_>, body: &Body<'_>, parts: &[Part]) -> Vec<TokenStream> {
    use crate::program::Operand;
    let results = || {
        body.program
            .outputs
            .iter()
            .flat_map(|output| &output.entries)
    };
    let reads_input = |array: usize| {
        parts.iter().any(|part| part.inputs.contains(&array))
            || results().any(|entry| matches!(entry, Operand::Input(read, _) if *read == array))
    };
    let reads_parameters = parts.iter().any(|part| part.reads_parameters)
        || results().any(|entry| matches!(entry, Operand::Parameter(_)));
    let inputs = body
        .arguments
        .iter()
        .enumerate()
        .filter(|&(array, _)| !reads_input(array));
    let parameters = (context.has_parameters() && !reads_parameters).then(|| quote!(p));
    inputs
        .map(|(_, name)| quote!(#name))
        .chain(parameters)
        .collect()
}

/// Arguments and result of a function as text.
pub(super) struct Signature {
    pub(super) arguments: Vec<TokenStream>,
    pub(super) result: TokenStream,
    /// Length of each input array.
    pub(super) lengths: Vec<TokenStream>,
    /// Lengths of each result, rows first.
    pub(super) shapes: Vec<Vec<TokenStream>>,
    /// Type of each result.
    pub(super) results: Vec<TokenStream>,
    /// How many dimensions each result has.
    pub(super) dimensions: Vec<usize>,
}

impl Signature {
    pub(super) fn new(context: &Context<'_>, body: &Body<'_>) -> Self {
        let ty = context.options.scalar.ty();
        let inputs = body
            .program
            .inputs
            .iter()
            .zip(&body.arguments)
            .map(|(input, name)| {
                let len = Size::from(input.extent).tokens();
                quote!(#name: &[#ty; #len])
            });
        let parameters = context.has_parameters().then(|| quote!(p: &Parameters));
        let results = body.program.outputs.iter().map(|output| {
            let extents = output.shape.extents().into_iter().rev();
            extents.fold(ty.clone(), |entry, extent| {
                let len = Size::from(extent).tokens();
                quote!([#entry; #len])
            })
        });
        let results: Vec<TokenStream> = results.collect();
        let result = match body.program.outputs.len() {
            1 => quote!(#(#results)*),
            _ => quote!((#(#results),*)),
        };
        Self {
            arguments: inputs.chain(parameters).collect(),
            lengths: body
                .program
                .inputs
                .iter()
                .map(|input| Size::from(input.extent).tokens())
                .collect(),
            shapes: body
                .program
                .outputs
                .iter()
                .map(|output| output.shape.extents().into_iter())
                .map(|extents| extents.map(|extent| Size::from(extent).tokens()).collect())
                .collect(),
            result,
            results,
            dimensions: body
                .program
                .outputs
                .iter()
                .map(|output| output.shape.extents().len())
                .collect(),
        }
    }
}

/// A length in a signature: by name where it follows from the model, else as a number.
#[derive(Clone, Copy)]
enum Size {
    N,
    M,
    Number(usize),
}

impl From<Extent> for Size {
    /// Coordinates and velocities are as many.
    fn from(extent: Extent) -> Self {
        match extent.dimension {
            Dimension::Coordinates | Dimension::Velocities => Self::N,
            Dimension::Inputs => Self::M,
            Dimension::Parameters | Dimension::Fixed => Self::Number(extent.len),
        }
    }
}

impl Size {
    fn tokens(self) -> TokenStream {
        match self {
            Self::N => quote!(N),
            Self::M => quote!(M),
            Self::Number(number) => {
                let number = Literal::usize_unsuffixed(number);
                quote!(#number)
            }
        }
    }

    fn text(self) -> String {
        match self {
            Self::N => "N".to_owned(),
            Self::M => "M".to_owned(),
            Self::Number(number) => number.to_string(),
        }
    }
}

/// Summary, equation, arguments, results, cost and notes.
fn documentation(context: &Context<'_>, function: &Function, body: &Body<'_>) -> DocComment {
    let mut doc = DocComment::new(&function.summary);
    if !function.equation.trim().is_empty() {
        doc.paragraph(&code(&function.equation));
    }
    doc.gap();
    for (i, (input, name)) in body.program.inputs.iter().zip(&body.arguments).enumerate() {
        let told = function.arguments.get(i);
        let meaning = told.map_or("", |argument| argument.meaning.as_str());
        let entries = told.map_or(String::new(), |argument| list(&argument.entries));
        doc.item(&sentence(
            &format!("`{name}: [{}]`", Size::from(input.extent).text()),
            meaning,
            &entries,
        ));
    }
    if context.has_parameters() {
        doc.item("`p`: free parameters");
    }
    for (i, output) in body.program.outputs.iter().enumerate() {
        let meaning = function.results.get(i).map_or("", String::as_str);
        let extents = output.shape.extents().into_iter();
        let shape: Vec<String> = extents.map(|extent| Size::from(extent).text()).collect();
        let shape = if shape.is_empty() {
            String::new()
        } else {
            format!(": [{}]", shape.join(" × "))
        };
        doc.item(&sentence(
            &format!("returns {}", code(&format!("{}{shape}", output.name))),
            meaning,
            "",
        ));
    }
    doc.paragraph(&format!("Cost: {}.", cost::count(&function.program)));
    for note in &function.notes {
        doc.paragraph(note);
    }
    doc
}

fn sentence(head: &str, meaning: &str, entries: &str) -> String {
    let parts = [head, meaning, entries]
        .into_iter()
        .map(str::trim)
        .filter(|part| !part.is_empty());
    parts.collect::<Vec<_>>().join(": ")
}

/// `a, b (rad), c (m)`: neighbours with one unit share it.
fn list(entries: &[(String, &'static str)]) -> String {
    let shown = entries.iter().enumerate().map(|(i, (name, unit))| {
        let is_last_of_unit = entries.get(i + 1).is_none_or(|(_, next)| next != unit);
        if is_last_of_unit {
            format!("{} in {unit}", code(name))
        } else {
            code(name)
        }
    });
    shown.collect::<Vec<_>>().join(", ")
}
