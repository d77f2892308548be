//! A robot for acados: discrete dynamics in C, and a file in Python that sets an optimal control problem up.
//!
//! acados calls generic functions `int f(void **in, void **out, void *params)`. Vectors are parts of BLASFEO's vectors, and
//! matrices parts of its matrices, whose storage depends on the processor: the source reads and writes them by the macros of
//! acados' headers. `setup.rs` prints the file in Python, `python.rs` its literals.

mod python;
mod setup;

use super::comment;
use super::context::Context;
use super::header;
use crate::emit::documentation::Block;

pub(super) use setup::text as setup;

/// The text of `<name>_acados.c`.
pub(super) fn dynamics(context: &Context<'_>) -> String {
    let parameters = if context.has_parameters() { PARAMETERS } else { "" };
    let passed = if context.has_parameters() { ", &parameters," } else { "," };
    let body = BODY.replace("    // parameters\n", parameters).replace(", &parameters,", passed);
    [
        header::top(context),
        format!("//\n{}", comment::documentation(&overview()).replace("///", "//")),
        HEADERS.to_owned(),
        format!(
            "\n// acados compiles one source: this one, with the module in it.\n#include \"{}.c\"\n",
            context.name
        ),
        context.pasted_names(&body),
    ]
    .concat()
}

fn overview() -> Vec<Block> {
    let paragraphs = [
        "Discrete dynamics for acados: generic external functions of the state x = (y, ẏ), the inputs u, and the parameters \
         p, which are the period in s and then the free parameters in the order of their struct.",
        "The Jacobian is transposed, as acados stores it: a row for each input, then one for each entry of x.",
    ];
    paragraphs.iter().map(|text| Block::Paragraph((*text).to_owned())).collect()
}

const HEADERS: &str = r#"
#include <string.h>

#include "acados/utils/external_function_generic.h"
#include "blasfeo/include/blasfeo_common.h"
"#;

const PARAMETERS: &str =
    "    gelenk_parameters parameters;\n    memcpy(&parameters, p + 1, sizeof parameters);\n";

const BODY: &str = r#"
#ifdef __cplusplus
extern "C" {
#endif

static void gelenk_acados_read(const void *from, int count, double *to)
{
    const struct blasfeo_dvec_args *part = (const struct blasfeo_dvec_args *)from;
    for (int i = 0; i < count; ++i)
        to[i] = BLASFEO_DVECEL(part->x, part->xi + i);
}

static void gelenk_acados_write(const double *from, int count, void *to)
{
    struct blasfeo_dvec_args *part = (struct blasfeo_dvec_args *)to;
    for (int i = 0; i < count; ++i)
        BLASFEO_DVECEL(part->x, part->xi + i) = from[i];
}

/// The state after a period over which u is held: in x, u; out x.
int gelenk_acados_step(void **in, void **out, void *params)
{
    const double *p = (const double *)params;
    double x[2 * GELENK_N], u[GELENK_M], next[2 * GELENK_N];
    // parameters
    gelenk_acados_read(in[0], 2 * GELENK_N, x);
    gelenk_acados_read(in[1], GELENK_M, u);
    gelenk_step(x, &x[GELENK_N], u, p[0], &parameters, next, &next[GELENK_N]);
    gelenk_acados_write(next, 2 * GELENK_N, out[0]);
    return 0;
}

/// The same state, and its derivatives by u and by x: in x, u; out x, the transposed Jacobian.
int gelenk_acados_step_derivatives(void **in, void **out, void *params)
{
    enum { N = GELENK_N, M = GELENK_M };
    const double *p = (const double *)params;
    double x[2 * N], u[M], next[2 * N], by_x[4 * N * N], by_u[2 * N * M];
    const struct blasfeo_dmat_args *to = (const struct blasfeo_dmat_args *)out[1];
    // parameters
    gelenk_acados_read(in[0], 2 * N, x);
    gelenk_acados_read(in[1], M, u);
    gelenk_step_derivatives(x, &x[N], u, p[0], &parameters, next, &next[N], by_x, by_u);
    gelenk_acados_write(next, 2 * N, out[0]);
    for (int row = 0; row < 2 * N; ++row) {
        for (int input = 0; input < M; ++input)
            BLASFEO_DMATEL(to->A, to->ai + input, to->aj + row) = by_u[row * M + input];
        // by_x has blocks of N x N, those of the positions first.
        const double *blocks = &by_x[row / N * 2 * N * N + row % N * N];
        for (int entry = 0; entry < 2 * N; ++entry)
            BLASFEO_DMATEL(to->A, to->ai + M + entry, to->aj + row) = blocks[entry / N * N * N + entry % N];
    }
    return 0;
}

#ifdef __cplusplus
}
#endif
"#;

/// The names of both functions in C.
fn functions(context: &Context<'_>) -> [String; 2] {
    ["acados_step", "acados_step_derivatives"].map(|name| context.function(name))
}
