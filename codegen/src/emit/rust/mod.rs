//! Prints modules in Rust.
//!
//! The text compiles without warnings, both as a separate file and through `include!`.
//!
//! All names, literals and documentation are printed by `names.rs`, `literal.rs` and `doc_comment.rs`. These
//! files prevent texts of a description from becoming code.
//!
//! - `body.rs` names the values of a function, and `statements.rs` prints one `let` per instruction.
//! - `signature.rs` and `public.rs` print the head of the function, and `parts.rs` prints the parts of a long
//!   function.
//! - A function has one of several forms: straight-line code (`straight.rs`), loops over joints (`arrays.rs`,
//!   `affine.rs`), and versions for eight states at once (`lanes/`). `function.rs` selects the form.

mod affine;
mod array_kernels;
mod arrays;
mod body;
mod constants;
mod context;
mod discrete_time;
mod doc_comment;
mod function;
mod header;
mod items;
mod joint_sums;
mod lanes;
mod lints;
mod literal;
mod math;
mod names;
mod parameters;
mod parts;
mod pasted;
mod positions;
mod public;
mod self_test;
mod shared_rows;
mod signature;
mod statements;
mod straight;
mod tree_tables;

pub use header::documentation;

use self::context::Context;
use self::items::push_items;
use crate::emit::options::{EmitOptions, SourceFile};
use crate::functions::composition::Composition;
use crate::functions::module_constants;
use crate::functions::position_functions::PositionFunction;
use crate::module::{self, Module};

/// Prints a module in Rust.
///
/// The text depends only on the arguments. It needs no crate, has no inner attributes and uses only `core::`
/// paths.
#[must_use]
pub fn module(module: &Module, options: &EmitOptions) -> SourceFile {
    let context = Context::new(module, options, reserved());
    let constant = |constant| constants::item(&context, constant);
    let mut text = header::comment(module, &options.command);
    push_items(&mut text, constants::sizes(&context));
    push_items(&mut text, module.constants.iter().map(constant));
    push_items(&mut text, constants::driven(&context));
    push_items(&mut text, parameters::items(&context));
    let mut functions = String::new();
    for (function, name) in module.functions.iter().zip(&context.functions) {
        push_items(&mut functions, function.constants.iter().map(constant));
        // One function is printed at a time, because the syntax tree of a large function needs far more
        // memory than its text.
        push_items(&mut functions, function::items(&context, function, name));
    }
    push_items(&mut text, lanes::types(&context));
    text.push_str(&functions);
    push_items(&mut text, module.substeps.iter().map(constant));
    let composed = module.compositions.iter();
    push_items(&mut text, composed.map(|each| discrete_time::function(&context, each)));
    push_items(&mut text, positions::items(&context));
    push_items(&mut text, context.shared.take());
    text.push_str(&array_kernels::text(options.scalar, &module.functions));
    text.push_str(&math::text(&context));
    text.push_str(&positions::text(&context));
    text.push_str(&discrete_time::text(options.scalar, module));
    text.push_str(math::guard(&module.functions));
    push_items(&mut text, self_test::item(&context));
    let name = options.name.clone().unwrap_or_else(|| names::identifier(&module.name).to_string());
    SourceFile { name, text, header: None, companions: vec![], interface: None }
}

/// Names of items of the module itself. Functions of the robot must not have these names.
fn reserved() -> Vec<String> {
    let compositions = Composition::ALL.map(Composition::name);
    let positions = PositionFunction::ALL.map(PositionFunction::name);
    let names: [&[&str]; 8] = [
        &positions,
        &math::RESERVED,
        &constants::RESERVED,
        &module::constants::NAMES,
        &module_constants::NAMES,
        &compositions,
        &arrays::RESERVED,
        &lanes::RESERVED,
    ];
    names.concat().into_iter().map(str::to_owned).collect()
}
