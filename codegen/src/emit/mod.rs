//! Stage 5: programs become the text of one Rust module.
//!
//! The emitter prints and decides nothing about numbers: order, names, signs and fused operations come from the
//! [`Program`](crate::program::Program). It guards what must hold for any description: names reach the text as checked
//! identifiers, text only as escaped literals and escaped documentation, and the result compiles without warnings, on
//! its own and through `include!`.

mod affine;
mod array_kernels;
mod arrays;
mod body;
pub(crate) mod constants;
mod discrete_time;
mod doc_comment;
mod function;
mod function_constants;
mod header;
mod into;
mod lanes;
mod lints;
mod literal;
mod math;
pub mod names;
mod parameters;
mod pasted;
mod self_test;
mod split;

pub use header::{FIRST_LINE, documentation};
pub(crate) use lanes::obstacle as obstacle_to_lanes;
pub use literal::Scalar;
pub use math::Math;

use std::cell::Cell;

use proc_macro2::{Ident, TokenStream};

use crate::functions::composition::Composition;
use crate::functions::function::Function;
use crate::functions::module_constants;
use crate::model::Model;
use crate::self_test::SelfTest;

/// So many statements stay one function. With debug information, as in Cargo's dev profile, rustc 1.95 nests one scope
/// for each `let`, and LLVM recurses over them: 2 800 statements compile, 3 200 overflow the 2 MB of its thread's stack and
/// end rustc. Without it, at opt-level 3, 9 000 statements need 0.9 s and 200 MB, 28 000 need 4 s and 490 MB; there longer
/// functions would do, since parts exchange values.
const LONGEST_FUNCTION: usize = 2_000;

/// How a module is written.
#[derive(Debug, Clone, PartialEq)]
pub struct EmitOptions {
    /// Number type of all functions and constants.
    pub scalar: Scalar,
    /// Where sine, cosine, tanh and exp come from.
    pub math: Math,
    /// What makes the file again, for its header: a command without absolute paths.
    pub command: String,
    /// Programs with more statements than this are split into private functions of at most so many.
    pub longest_function: usize,
    /// Functions that are also written over eight states at once, as far as they can be.
    pub lanes: Vec<String>,
    /// Lines below the description of the robot: what its reader should know about this module.
    pub remarks: Vec<String>,
    /// Calls that a test module at the end makes, those of one function together; none without such a module.
    pub self_tests: Vec<SelfTest>,
}

impl Default for EmitOptions {
    fn default() -> Self {
        Self {
            scalar: Scalar::F64,
            math: Math::Embedded,
            command: "gelenk generate".to_owned(),
            longest_function: LONGEST_FUNCTION,
            lanes: vec![],
            remarks: vec![],
            self_tests: vec![],
        }
    }
}

/// The text of a generated file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SourceFile {
    /// Name of the module; the file is `<name>.rs`.
    pub name: String,
    /// Its whole text.
    pub text: String,
}

/// Writes `functions` of `model` as one Rust module, and `compositions`, which call them.
///
/// The text depends on the arguments alone. It needs no crate, has no inner attributes and names only `core::` paths.
#[must_use]
pub fn module(
    model: &Model,
    functions: &[Function],
    compositions: &[Composition],
    options: &EmitOptions,
) -> SourceFile {
    let context = Context::new(model, functions, options);
    let mut text = header::comment(model, options);
    push_items(&mut text, constants::items(&context, compositions));
    push_items(&mut text, parameters::items(&context));
    if functions.iter().any(|function| context.has_lanes(function)) {
        push_items(&mut text, [lanes::item(&context)]);
    }
    let before_functions = text.len();
    for (index, function) in functions.iter().enumerate() {
        push_items(&mut text, function_constants::items(&context, function));
        // One function at a time: the syntax tree of a large one takes far more memory than its text.
        push_items(
            &mut text,
            function::items(&context, function, &context.functions[index]),
        );
    }
    let mut groups = String::new();
    push_items(&mut groups, lanes::group(&context));
    text.insert_str(before_functions, &groups);
    push_items(
        &mut text,
        discrete_time::items(&context, functions, compositions),
    );
    push_items(&mut text, context.shared.take());
    text.push_str(&array_kernels::text(options.scalar, functions));
    text.push_str(&math::text(&context));
    text.push_str(&discrete_time::text(options.scalar, compositions));
    text.push_str(math::guard(functions));
    push_items(&mut text, self_test::items(&context, functions));
    SourceFile {
        name: context.name,
        text,
    }
}

/// What all parts of a module have in common.
struct Context<'a> {
    model: &'a Model,
    options: &'a EmitOptions,
    /// Name of the module, a checked identifier.
    name: String,
    /// Number of coordinates, `N`.
    coordinates: usize,
    /// Number of inputs, `M`.
    inputs: usize,
    /// Field names of `Parameters`.
    parameters: Vec<Ident>,
    /// Names of the functions.
    functions: Vec<Ident>,
    /// Elementary functions that were called so far.
    calls: math::Calls,
    /// Whether a function over lanes has something to keep between its loops.
    has_groups: Cell<bool>,
    /// Names that no argument or value inside a function may take: a constant's would be a pattern, not a variable.
    reserved: Vec<String>,
    /// Private functions of array forms, which several functions call.
    shared: arrays::Shared,
}

impl<'a> Context<'a> {
    fn new(model: &'a Model, functions: &[Function], options: &'a EmitOptions) -> Self {
        let parameter_names = model
            .parameters
            .iter()
            .map(|parameter| parameter.name.as_str());
        let mut reserved: Vec<String> =
            math::RESERVED.iter().map(|&name| name.to_owned()).collect();
        reserved.extend(constants::NAMES.iter().map(|&name| name.to_owned()));
        reserved.extend(module_constants::NAMES.iter().map(|&name| name.to_owned()));
        reserved.extend(discrete_time::RESERVED.iter().map(|&name| name.to_owned()));
        reserved.extend(Composition::ALL.iter().map(|each| each.name().to_owned()));
        reserved.extend(arrays::RESERVED.iter().map(|&name| name.to_owned()));
        reserved.extend(lanes::RESERVED.iter().map(|&name| name.to_owned()));
        let functions = names::distinct(
            functions.iter().map(|function| function.name.as_str()),
            &reserved,
        );
        reserved.extend(functions.iter().map(ToString::to_string));
        Self {
            model,
            options,
            name: names::identifier(&model.name).to_string(),
            coordinates: model.coordinates.len(),
            inputs: model.inputs().count(),
            parameters: names::distinct(parameter_names, &[]),
            functions,
            calls: math::Calls::default(),
            has_groups: Cell::new(false),
            shared: arrays::Shared::default(),
            reserved,
        }
    }

    /// Whether a function is also written over lanes.
    fn has_lanes(&self, function: &Function) -> bool {
        self.options.lanes.contains(&function.name)
            && function.arrays.is_none()
            && lanes::obstacle(&function.program, self.options.math).is_none()
    }

    fn has_parameters(&self) -> bool {
        !self.parameters.is_empty()
    }
}

fn push_items(text: &mut String, items: impl IntoIterator<Item = TokenStream>) {
    for item in items {
        text.push('\n');
        text.push_str(&print(item));
    }
}

/// Formats one item. The tokens were made by this folder: where they are no Rust, that is a defect here, and the
/// unformatted tokens with rustc's message about them help more than a panic.
fn print(item: TokenStream) -> String {
    match syn::parse2::<syn::File>(item.clone()) {
        Ok(file) => prettyplease::unparse(&file),
        Err(_) => format!("{item}\n"),
    }
}
