//! Modules as a C99 header and source that also compile as C++.
//!
//! The texts compile without warnings. They compute the same bits as the Rust module of the same robot: one
//! statement per instruction, the same elementary functions, and no contraction by compilers.
//!
//! Lowest layer: `names.rs`, `literal.rs` and `comment.rs` check everything that is printed. `body.rs` names
//! the values of a function; their type is a number or, in `group/`, several states. `statements.rs` prints
//! one declaration per instruction, `results.rs` the stores, `signature.rs` and `public.rs` the function
//! around them, `parts.rs` the parts of a long function. The forms use these: `straight.rs`, `arrays.rs`,
//! `affine.rs`, `lanes.rs`. `function.rs` chooses the form given by the module. `header.rs` and `source.rs`
//! assemble the files.

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

/// Prints a module as C99: `<name>.h` and `<name>.c`.
///
/// The text depends only on the arguments.
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
