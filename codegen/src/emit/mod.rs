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
mod context;
mod discrete_time;
mod doc_comment;
mod function;
mod function_constants;
mod header;
mod lanes;
mod lints;
mod literal;
mod math;
pub mod names;
mod parameters;
mod parts;
mod pasted;
mod public;
mod self_test;
mod signature;
mod statements;
mod straight;

pub use header::{FIRST_LINE, documentation};
pub(crate) use lanes::obstacle as obstacle_to_lanes;
pub use literal::Scalar;
pub use math::Math;

use proc_macro2::TokenStream;

use self::context::Context;
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
    let context = Context::new(model, functions, options, reserved());
    let mut text = header::comment(model, options);
    push_items(&mut text, constants::items(&context));
    push_items(&mut text, parameters::items(&context));
    if functions
        .iter()
        .any(|function| lanes::is_wanted(&context, function))
    {
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
        name: names::identifier(&model.name).to_string(),
        text,
    }
}

/// Names that the module takes for itself.
fn reserved() -> Vec<String> {
    let compositions = Composition::ALL.map(Composition::name);
    let names: [&[&str]; 7] = [
        &math::RESERVED,
        &constants::NAMES,
        &module_constants::NAMES,
        &discrete_time::RESERVED,
        &compositions,
        &arrays::RESERVED,
        &lanes::RESERVED,
    ];
    names.concat().into_iter().map(str::to_owned).collect()
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
