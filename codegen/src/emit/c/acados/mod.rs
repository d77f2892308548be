//! Files for acados: discrete dynamics in C, and a Python file that defines an optimal control problem.
//!
//! acados calls generic functions `int f(void **in, void **out, void *params)`. Vectors and matrices are
//! types of BLASFEO. Their storage depends on the processor, so the source accesses them with macros of the
//! headers of acados. `setup.rs` prints the Python file, and `python.rs` prints its literals.

mod python;
mod setup;

use super::about_reference;
use super::comment;
use super::context::Context;
use super::header;
use crate::emit::documentation::Block;
use crate::emit::options::Companion;

pub(super) use setup::text as setup;

/// Prints the file `<name>_acados.c`.
pub(super) fn dynamics(context: &Context<'_>) -> String {
    let has_quaternions = context.module.has_quaternions();
    let step = if has_quaternions { STEP_ABOUT } else { STEP };
    let shared = [about_reference::BLOCKS, about_reference::RATES, about_reference::ROWS].concat();
    let shared = if has_quaternions { shared } else { String::new() };
    let first = if has_quaternions { "p + 1 + 2 * GELENK_NY" } else { "p + 1" };
    let parameters =
        if context.has_parameters() { PARAMETERS.replace("FIRST", first) } else { String::new() };
    let passed = if context.has_parameters() { ", &parameters," } else { "," };
    let step = step.replace("    // parameters\n", &parameters).replace(", &parameters,", passed);
    let body = [BEGIN, &shared, &step, END].concat();
    [
        header::top(context),
        format!("//\n{}", comment::documentation(&overview(has_quaternions)).replace("///", "//")),
        HEADERS.to_owned(),
        sources(context),
        context.pasted_names(&body),
    ]
    .concat()
}

/// Includes of the module's source, and of the source for CasADi if it is generated, because costs and
/// constraints in CasADi call that source.
fn sources(context: &Context<'_>) -> String {
    let with_casadi = context.options.companions.contains(&Companion::Casadi);
    let names = [Some(".c"), with_casadi.then_some("_casadi.c")].into_iter().flatten();
    let includes: String = names.map(|ending| format!("#include \"{}{ending}\"\n", context.name)).collect();
    format!("\n// acados compiles only this source, so it includes all other sources.\n{includes}")
}

fn overview(has_quaternions: bool) -> Vec<Block> {
    let state = match has_quaternions {
        false => {
            "Discrete dynamics for acados: generic external functions of the state x = (y, ẏ), the inputs u, and the parameters \
             p: the period in s, and then the free parameters in the order of their struct."
        }
        true => {
            "Discrete dynamics for acados: generic external functions of the state x = (d, v), the inputs u, and the parameters \
             p: the period in s, the reference positions at the beginning and end of the period (with quaternions of unit \
             length), and then the free parameters in the order of their struct. Positions are y_ref ⊕ d; rotations in d are \
             at most half a turn."
        }
    };
    let jacobian = "The Jacobian is transposed, as acados requires: one row for each input, then one row for each entry of x.";
    [state, jacobian].iter().map(|text| Block::Paragraph((*text).to_owned())).collect()
}

const HEADERS: &str = r#"
#include <string.h>

#include "acados/utils/external_function_generic.h"
#include "blasfeo/include/blasfeo_common.h"
"#;

const PARAMETERS: &str =
    "    gelenk_parameters parameters;\n    memcpy(&parameters, FIRST, sizeof parameters);\n";

/// Text of the functions that read and write vectors and matrices of BLASFEO, the linear algebra library of
/// acados.
const BEGIN: &str = include_str!("begin.c");

/// Text of the discrete dynamics that acados calls, for robots without quaternions.
const STEP: &str = include_str!("step.c");

/// Text of the discrete dynamics that acados calls, for robots with quaternions. Their states are
/// displacements from reference positions.
const STEP_ABOUT: &str = include_str!("step_about.c");

const END: &str = include_str!("end.c");

/// Names in C of the function over a sample time and of its version with derivatives.
fn functions(context: &Context<'_>) -> [String; 2] {
    ["acados_step", "acados_step_derivatives"].map(|name| context.function(name))
}
