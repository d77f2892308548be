//! External functions of CasADi with their Jacobians.
//!
//! `casadi.external` finds a function by its name, and its derivatives as `jac_<name>`: a block for each output by each
//! input, outputs first. Those of `jac_<name>` are `jac_jac_<name>`, central differences by `differences.c`. `functions.rs` says which functions there are and where their entries come from, `robot.rs` how they
//! call the module, `text.rs` how CasADi calls them, `sensitivities.rs` how a step depends on its period and the free
//! parameters. Robots with quaternions are given as small motions from a reference: `positions.c`, `tangents.c` and `steps.c`
//! hold the parts in addition to the texts of `about_reference/`.

mod external;
mod functions;
mod robot;
mod sensitivities;
mod text;

use std::iter;

use super::context::Context;
use super::{about_reference, header, interface};
use external::Evaluation;

/// The text of `<name>_casadi.c`.
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
