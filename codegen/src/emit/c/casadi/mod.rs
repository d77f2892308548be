//! External functions for CasADi with Jacobians.
//!
//! `casadi.external` finds a function by name, and its derivatives as `jac_<name>`: one block per output and
//! input, outputs first. The derivatives of `jac_<name>` are `jac_jac_<name>`, central differences from
//! `differences.c`. `functions.rs` lists the functions and the sources of their entries, `robot.rs` the calls
//! of the module, `text.rs` the interface to CasADi, `sensitivities.rs` the derivatives of a step by its
//! period and the free parameters. States of robots with quaternions are small motions from a reference:
//! `positions.c`, `tangents.c` and `steps.c` complete the texts of `about_reference/`.

mod external;
mod functions;
mod robot;
mod sensitivities;
mod text;

use std::iter;

use super::context::Context;
use super::{about_reference, header, interface};
use external::Evaluation;

/// Text of `<name>_casadi.c`.
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
    // Compilers warn of what nothing calls.
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
