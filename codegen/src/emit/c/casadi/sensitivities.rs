//! Prints the function for the derivatives of a step with respect to the period and the free parameters.

use super::super::context::Context;
use crate::functions::function::ConstantValue;

/// Prints the function for the derivatives of a step; `None` if no function for CasADi calls it.
///
/// The function's result `d` has one row for each small motion of the positions, then one row for each
/// velocity. The first column belongs to the period, the other columns to the free parameters.
///
/// - `is_called`: whether functions for CasADi call the function
pub(super) fn text(context: &Context<'_>, is_called: bool) -> Option<String> {
    let count = context.module.parameters.len();
    let substeps = match context.module.substeps.as_ref().map(|constant| &constant.value) {
        Some(ConstantValue::Count(count)) => *count,
        _ => 1,
    };
    // The function differentiates the stages of the classical Runge–Kutta method, or of the method of
    // Munthe-Kaas.
    let (text, state) = match context.module.has_quaternions() {
        false => (include_str!("sensitivities.c"), "z, &z[GELENK_N]"),
        true => (include_str!("sensitivities_about.c"), "reached, &z[GELENK_N]"),
    };
    let with_parameters = match count {
        0 => String::new(),
        _ => format!("            gelenk_forward_dynamics_by_parameters({state}, u, p, by_p);\n"),
    };
    let text = text.replace("// by_parameters\n", &with_parameters).replace("P_COUNT", &count.to_string());
    let text = text.replace("S_COUNT", &format!("{substeps}"));
    is_called.then(|| context.pasted(&text))
}
