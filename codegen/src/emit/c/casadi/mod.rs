//! External functions of CasADi with their Jacobians.
//!
//! `casadi.external` finds a function by its name, and its derivatives as `jac_<name>`: a block for each output by each
//! input, outputs first. `external.rs` says which functions there are and where their entries come from, `text.rs` how CasADi
//! calls them, `sensitivities.rs` how a step depends on its period and the free parameters.

mod external;
mod sensitivities;
mod text;

use super::context::Context;
use super::{header, interface};
use external::{Evaluation, all};

/// The text of `<name>_casadi.c`.
pub(super) fn text(context: &Context<'_>) -> String {
    let externals = all(context, &interface::of(context));
    let evaluations: Vec<&Evaluation> =
        externals.iter().flat_map(|each| [Some(&each.value), each.jacobian.as_ref()]).flatten().collect();
    let functions: String =
        evaluations.iter().map(|each| format!("\n{}", text::function(context, each))).collect();
    [
        header::top(context),
        text::overview(&externals),
        format!("\n#include \"{}.h\"\n", context.name),
        text::shared(context),
        sensitivities::text(context, functions.contains("casadi_sensitivities(")).unwrap_or_default(),
        functions,
        text::END.to_owned(),
    ]
    .concat()
}
