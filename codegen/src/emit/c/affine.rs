//! Prints the function `linearize` of robots with loops over joints. The function calls
//! `forward_dynamics_derivatives`, and computes its own results from the results and arguments of this call.

use super::body::Body;
use super::context::Context;
use super::{layout, public};
use crate::functions::function::Function;
use crate::program::Operand;
use crate::program::arrays::Affine;

/// The text of the public function `linearize`.
pub(super) fn items(context: &Context<'_>, function: &Function, form: &Affine, name: &str) -> Vec<String> {
    let face = function.program.face();
    let body = Body::new(context, &face);
    vec![layout::function(&public::head(&body, name), &statements(&body, form))]
}

fn statements(body: &Body<'_>, form: &Affine) -> Vec<String> {
    let ([y, v, u], [by_y, by_v, by_u, remainder, drift @ ..]) =
        (body.names.arguments.as_slice(), body.names.results.as_slice())
    else {
        unreachable!("`Affine::unrolled` has three arguments, and four results or five");
    };
    let (n, m) = (form.called.coordinates().len(), form.inputs.len());
    let (context, ty) = (body.context, body.context.ty());
    let dot = context.function("dot");
    let arguments = [y, v, u].map(Clone::clone).into_iter().chain(context.passed_parameters());
    let results = ["accelerations".to_owned(), by_y.clone(), by_v.clone(), "inverse".to_owned()];
    let arguments: Vec<String> = arguments.chain(results).collect();
    let columns = form.inputs.iter().enumerate().map(|(column, gains)| {
        let terms = gains.iter().map(|&(coordinate, gain)| match gain {
            Operand::Constant(1.0) => format!("inverse[{n} * i + {coordinate}]"),
            gain => format!("inverse[{n} * i + {coordinate}] * {}", body.operand(gain)),
        });
        let terms: Vec<String> = terms.collect();
        // One loop for each column: gcc 12.2 combines a sum and an adjacent difference of products to one
        // vector operation, and then fuses it although fusing is off.
        let column = format!("{by_u}[{m} * i + {column}] = {};", terms.join(" + "));
        format!("for (int i = 0; i < {n}; ++i) {{\n    {column}\n}}")
    });
    let product = |rows: &str, by: &str, len: usize| format!("{dot}({len}, &{rows}[{len} * i], {by})");
    let by_position = match form.drift {
        None => format!("{} + ", product(by_y, y, n)),
        Some(_) => String::new(),
    };
    let affine = format!(
        "for (int i = 0; i < {n}; ++i) {{\n    const {ty} of_state = {by_position}{};\n    {remainder}[i] = accelerations[i] - (of_state + {});\n}}",
        product(by_v, v, n),
        product(by_u, u, m),
    );
    let declaration = format!("{ty} accelerations[{n}], inverse[{}];", n * n);
    let call = layout::call(4, &context.function(form.name), &arguments, ";");
    let drift = drift.iter().flat_map(|drift| drift_statements(form, drift, v));
    [declaration, call].into_iter().chain(columns).chain([affine]).chain(drift).collect()
}

/// Statements that write the matrix D in `δ̇ = D δ + v − v̄`, the linearized motion of joints with
/// quaternions.
fn drift_statements(form: &Affine, drift: &str, v: &str) -> Vec<String> {
    let n = form.called.coordinates().len();
    let clear = format!("memset({drift}, 0, {} * sizeof *{drift});", n * n);
    let entries = form.drift.iter().flatten().map(|entry| {
        let sign = if entry.is_negative { "-" } else { "" };
        format!("{drift}[{}] = {sign}{v}[{}];", entry.row * n + entry.column, entry.velocity)
    });
    std::iter::once(clear).chain(entries).collect()
}
