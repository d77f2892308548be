//! Modules as C99 that is C++ too: a header and a source.
//!
//! The texts compile without warnings. They compute the same bits as the Rust module of the same robot: one statement
//! for each instruction of the program, the same elementary functions, and compilers kept from contracting.
//!
//! From below: `names.rs`, `literal.rs` and `comment.rs` guard what reaches the text. `body.rs` names the values of a
//! function, whose type is a number, or that of several states (`group/`). `statements.rs` prints one declaration per
//! instruction, `results.rs` the stores, `signature.rs` and `public.rs` what stands around them, `parts.rs` the functions
//! that a long one is split into. On these stand the forms: `straight.rs`, `arrays.rs`, `affine.rs`, `lanes.rs`.
//! `function.rs` chooses between them by what the module says. `header.rs` and `source.rs` put the files together.

mod about_reference;
mod acados;
mod affine;
mod array_kernels;
mod arrays;
mod body;
mod casadi;
mod comment;
mod constants;
mod context;
mod discrete_time;
mod function;
mod group;
mod header;
mod interface;
mod joint_sums;
mod lanes;
mod layout;
mod literal;
mod math;
mod names;
mod parameters;
mod parts;
mod positions;
mod public;
mod python;
mod results;
mod signature;
mod source;
mod stack;
mod statements;
mod straight;

use self::context::Context;
use crate::emit::options::{Companion, EmitOptions, SourceFile};
use crate::module::Module;

/// Writes a module as C99: `<name>.h` and `<name>.c`.
///
/// The text depends on the arguments alone.
#[must_use]
pub(super) fn module(module: &Module, options: &EmitOptions) -> SourceFile {
    let context = Context::new(module, options);
    let text = source::text(&context);
    let header = header::text(&context);
    let companions = options.companions.iter().flat_map(|companion| match companion {
        Companion::Acados => {
            vec![("_acados.c", acados::dynamics(&context)), ("_acados.py", acados::setup(&context))]
        }
        Companion::Casadi => vec![("_casadi.c", casadi::text(&context))],
        Companion::Python => vec![("_python.c", python::text(&context))],
    });
    SourceFile {
        text,
        header: Some(header),
        companions: companions.collect(),
        interface: Some(interface::of(&context)),
        name: context.name,
    }
}
