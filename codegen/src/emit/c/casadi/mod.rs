//! Prints external functions for CasADi, with Jacobians.
//!
//! `casadi.external` finds a function by its name, and the function's derivatives by the name `jac_<name>`.
//! The derivatives have one output for each pair of output and input; the pairs of the first output come
//! first. The derivatives of `jac_<name>` are `jac_jac_<name>`, which are central differences
//! (`differences.c`).
//!
//! - `functions.rs`: the functions, and the places of their entries
//! - `robot.rs`: calls of the module
//! - `text.rs`: the interface to CasADi
//! - `sensitivities.rs`: derivatives of a step with respect to the period and the free parameters
//! - `positions.c`, `tangents.c`, `steps.c`: additions to the texts of `about_reference/` for robots with
//!   quaternions, whose states are small motions from reference positions

mod external;
mod functions;
mod robot;
mod sensitivities;
mod text;

use std::iter;

use super::context::Context;
use super::{about_reference, header, interface};
use external::Evaluation;

/// Prints the file `<name>_casadi.c`.
pub(super) fn text(context: &Context<'_>) -> String {
    let externals = functions::all(context, &interface::of(context));
    let evaluations: Vec<&Evaluation> = externals
        .iter()
        .flat_map(|each| iter::once(&each.value).chain(each.derivatives.iter().flatten()))
        .collect();
    let functions: String =
        evaluations.iter().map(|each| format!("\n{}", text::function(context, each))).collect();
    let is_called = |name: &str| functions.contains(&format!("{name}("));
    let with_steps = is_called("casadi_step_about");
    // Only functions that are called are printed, because compilers warn about unused functions.
    let shared = [
        (is_called("casadi_positions"), include_str!("positions.c")),
        (is_called("casadi_tangents"), about_reference::BLOCKS),
        (is_called("casadi_tangents"), include_str!("tangents.c")),
        (with_steps || is_called("about_rates"), about_reference::RATES),
        (with_steps, about_reference::ROWS),
        (with_steps, include_str!("steps.c")),
        (is_called("casadi_differences"), include_str!("differences.c")),
    ];
    let shared = shared.iter().filter(|(is_called, _)| *is_called);
    let shared: String = shared.map(|(_, text)| context.pasted_names(text)).collect();
    [
        header::top(context),
        text::overview(context, &externals),
        format!("\n#include \"{}.h\"\n", context.name),
        text::shared(context),
        shared,
        sensitivities::text(context, is_called("casadi_sensitivities")).unwrap_or_default(),
        functions,
        text::END.to_owned(),
    ]
    .concat()
}
