//! Prints modules as a header and a source in C99, which also compile as C++.
//!
//! The texts compile without warnings. The results are bit-identical to the results of the robot's Rust
//! module: each instruction is one statement, elementary functions are the same, and compilers are not
//! allowed to contract operations.
//!
//! All names, literals and comments are printed by `names.rs`, `literal.rs` and `comment.rs`. These files
//! prevent texts of a description from becoming code.
//!
//! - `body.rs` names the values of a function. The type of a value is a number, or a vector for several
//!   states (`group/`).
//! - `statements.rs` prints one declaration per instruction, and `results.rs` prints the stores to results.
//! - `signature.rs` and `public.rs` print the head of the function, and `parts.rs` prints the parts of a long
//!   function.
//! - A function has one of several forms: straight-line code (`straight.rs`), loops over joints (`arrays.rs`,
//!   `affine.rs`), and versions for several states (`lanes.rs`). `function.rs` selects the form.
//! - `header.rs` and `source.rs` assemble the files.

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
