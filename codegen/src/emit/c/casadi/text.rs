//! Prints the C text of functions for CasADi.

use super::super::context::Context;
use super::super::{comment, layout};
use super::external::{self, Body, Evaluation, External, Input, ONE};
use crate::emit::documentation::Block;
use crate::emit::text::code;

/// Comment at the top of the file for CasADi with a list of all functions.
pub(super) fn overview(context: &Context<'_>, externals: &[External]) -> String {
    let item = |external: &External| {
        let External { value, derivatives } = external;
        let inputs: Vec<&str> = value.inputs.iter().map(|input| input.name.as_str()).collect();
        let outputs: Vec<&str> = value.outputs.iter().map(|output| output.name.as_str()).collect();
        let without = if derivatives.is_some() { "" } else { " Its derivatives are not in this module." };
        Block::Item(format!(
            "{} of {} gives {}: {}{without}",
            code(&value.name),
            inputs.join(", "),
            outputs.join(", "),
            value.about
        ))
    };
    let head = Block::Paragraph(
        "External functions for CasADi, compiled together with the module into one shared library:"
            .to_owned(),
    );
    let tail = Block::Paragraph(
        "The derivatives of a function are `jac_<name>`, which CasADi finds by its name. They are sparse, with the entries \
         that can be non-zero. Second derivatives `jac_jac_<name>` are central differences of `jac_<name>`. `p` contains the \
         free parameters in the order of their struct."
            .to_owned(),
    );
    let about = context.module.has_quaternions().then(|| Block::Paragraph(REFERENCE.to_owned()));
    let items = externals.iter().map(item);
    let blocks: Vec<Block> = [head, Block::Gap].into_iter().chain(items).chain([tail]).chain(about).collect();
    format!("//\n{}", comment::documentation(&blocks).replace("///", "//"))
}

const REFERENCE: &str = "Positions are given as a small motion d from the reference y_ref: y = y_ref ⊕ d. The quaternions of a \
    reference are normalized, and derivatives include this normalization. An evaluation fails if a quaternion is zero or not finite.";

/// Text that all functions for CasADi share, after the include of the module.
pub(super) fn shared(context: &Context<'_>) -> String {
    let text = context.pasted_names(SHARED);
    match context.module.has_quaternions() {
        true => text.replace("#include <string.h>", "#include <math.h>\n#include <string.h>"),
        false => text,
    }
}

const SHARED: &str = r#"
#include <string.h>

#ifndef casadi_real
#define casadi_real double
#endif
#ifndef casadi_int
#define casadi_int long long int
#endif

#if defined(_WIN32)
#define GELENK_SYMBOL __declspec(dllexport)
#elif defined(__GNUC__)
#define GELENK_SYMBOL __attribute__((visibility("default")))
#else
#define GELENK_SYMBOL
#endif

#ifdef __cplusplus
extern "C" {
#endif

// Copies the entries of an output from their places in e, column by column. Outputs that are not requested are skipped.
static void gelenk_casadi_gather(casadi_real *to, const double *e, const int *places, int count)
{
    for (int i = 0; to && i < count; ++i)
        to[i] = e[places[i]];
}

// Derivatives w × r of a rotation matrix r with respect to each coordinate, from the angular rows w of the Jacobian. The
// result has nine rows. The rows of the first axis are first.
static inline void gelenk_casadi_turn(const double *r, const double *w, int columns, double *d)
{
    for (int axis = 0; axis < 3; ++axis)
        for (int row = 0; row < 3; ++row)
            for (int j = 0; j < columns; ++j) {
                const int next = (row + 1) % 3, last = (row + 2) % 3;
                d[(3 * axis + row) * columns + j] =
                    w[next * columns + j] * r[3 * last + axis] - w[last * columns + j] * r[3 * next + axis];
            }
}
"#;

/// End of the file for CasADi.
pub(super) const END: &str = "\n#ifdef __cplusplus\n}\n#endif\n";

/// Prints a function for CasADi, together with the functions by which CasADi queries its inputs, outputs and
/// sparsity.
pub(super) fn function(context: &Context<'_>, evaluation: &Evaluation) -> String {
    let Evaluation { name, about, inputs, outputs, .. } = evaluation;
    let define = |head: &str, statements: &[String]| {
        let symbol = context.constant("SYMBOL");
        layout::function(&format!("{symbol} {head}"), statements)
    };
    let count = |what: &str, count: usize| {
        define(&format!("casadi_int {name}_{what}(void)"), &[format!("return {count};")])
    };
    let names = |what: &str, names: Vec<&str>| {
        let listed: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
        let table = format!("static const char *const names[] = {};", layout::braces(4, &listed));
        let choice = format!("return i >= 0 && i < {} ? names[i] : NULL;", names.len());
        define(&format!("const char *{name}_{what}(casadi_int i)"), &[table, choice])
    };
    let statements = match &evaluation.body {
        Body::Filled { statements, size } => filled(context, evaluation, statements, *size),
        Body::Differences { of, counts, .. } => differences(context, of, inputs.len(), *counts),
    };
    let parts = [
        [comment::paragraph(about), define(&format!("int {name}({ARGUMENTS})"), &statements)].concat(),
        count("n_in", inputs.len()),
        count("n_out", outputs.len()),
        names("name_in", inputs.iter().map(|input| input.name.as_str()).collect()),
        names("name_out", outputs.iter().map(|output| output.name.as_str()).collect()),
        sparsity(name, "sparsity_in", &inputs.iter().map(dense).collect::<Vec<_>>(), &define),
        sparsity(name, "sparsity_out", &outputs.iter().map(pattern).collect::<Vec<_>>(), &define),
        define(
            &format!(
                "int {name}_work(casadi_int *sz_arg, casadi_int *sz_res, casadi_int *sz_iw, casadi_int *sz_w)"
            ),
            &[
                format!("if (sz_arg) *sz_arg = {};", inputs.len()),
                format!("if (sz_res) *sz_res = {};", outputs.len()),
                "if (sz_iw) *sz_iw = 0;".to_owned(),
                format!("if (sz_w) *sz_w = {};", work(&evaluation.body)),
                "return 0;".to_owned(),
            ],
        ),
    ];
    parts.join("\n")
}

const ARGUMENTS: &str = "const casadi_real **arg, casadi_real **res, casadi_int *iw, casadi_real *w, int mem";

/// Length of the work array that CasADi reserves for a function.
fn work(body: &Body) -> usize {
    match body {
        Body::Filled { .. } => 0,
        Body::Differences { work, .. } => *work,
    }
}

/// Statements that compute central differences of a function.
///
/// - `of`: name of the function
/// - `inputs`: number of inputs of the differences: the inputs and the outputs of the function
/// - `by`: number of inputs with respect to which the function is differentiated
/// - `outputs`: number of outputs of the function
fn differences(context: &Context<'_>, of: &str, inputs: usize, [by, outputs]: [usize; 2]) -> Vec<String> {
    let [own, differences] = [inputs - outputs, outputs].map(|count| count.max(1));
    let call = context.function("casadi_differences");
    vec![
        format!("const casadi_real *moved[{own}];\ncasadi_real *all[{differences}];"),
        "(void)iw;".to_owned(),
        format!(
            "return {call}(\n    {of}, {of}_sparsity_in, {of}_sparsity_out, {by}, {own}, {outputs}, arg, res, moved, all, w, mem);"
        ),
    ]
}

/// Statements of a function for CasADi that fills the array `e` of computed values and copies the outputs
/// from it.
fn filled(context: &Context<'_>, evaluation: &Evaluation, statements: &[String], size: usize) -> Vec<String> {
    let Evaluation { inputs, outputs, .. } = evaluation;
    let longest = inputs.iter().map(|input| input.rows * input.columns).max().unwrap_or(0).max(1);
    let mut lines =
        vec![format!("static const double zeros[{longest}] = {{0.0}};"), format!("double e[{size}];")];
    let used = statements.join("\n");
    for (index, input) in inputs.iter().enumerate() {
        let name = &input.name;
        if input.are_parameters {
            let ty = context.function("parameters");
            lines.push(format!("{ty} parameters;"));
            lines.push(format!(
                "memcpy(&parameters, arg[{index}] ? arg[{index}] : zeros, sizeof parameters);"
            ));
        } else if reads(&used, name) {
            lines.push(format!("const double *{name} = arg[{index}] ? arg[{index}] : zeros;"));
        }
    }
    lines.extend(["(void)arg;", "(void)res;", "(void)iw;", "(void)w;", "(void)mem;"].map(str::to_owned));
    lines.push(format!("e[{ONE}] = 1.0;"));
    lines.extend(statements.iter().cloned());
    for (index, block) in outputs.iter().enumerate().filter(|(_, block)| !block.entries.is_empty()) {
        let places: Vec<String> = block.entries.iter().map(|(_, _, place)| place.to_string()).collect();
        let gather = context.function("casadi_gather");
        lines.push(format!(
            "static const int places_{index}[] = {};\n{gather}(res[{index}], e, places_{index}, {});",
            layout::braces(4, &places),
            places.len()
        ));
    }
    lines.push("return 0;".to_owned());
    lines
}

/// Whether statements contain the name of an argument as a word.
fn reads(statements: &str, name: &str) -> bool {
    let is_word = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    statements.split(|letter| !is_word(letter)).any(|word| word == name)
}

fn dense(input: &Input) -> Vec<usize> {
    vec![input.rows, input.columns, 1]
}

/// Sparsity in the format of CasADi: numbers of rows and columns, index of the first entry of each column,
/// and row of each entry.
fn pattern(block: &external::Block) -> Vec<usize> {
    if block.entries.len() == block.rows * block.columns && !block.entries.is_empty() {
        return vec![block.rows, block.columns, 1];
    }
    let starts =
        (0..=block.columns).map(|end| block.entries.iter().filter(|(_, column, _)| *column < end).count());
    let rows = block.entries.iter().map(|(row, ..)| *row);
    [block.rows, block.columns].into_iter().chain(starts).chain(rows).collect()
}

fn sparsity(
    name: &str,
    what: &str,
    all: &[Vec<usize>],
    define: &dyn Fn(&str, &[String]) -> String,
) -> String {
    let mut lines: Vec<String> = all
        .iter()
        .enumerate()
        .map(|(index, numbers)| {
            // Trailing zeros are left out. At least one number remains, because C has no empty arrays.
            let last = numbers.iter().rposition(|number| *number > 0).map_or(1, |last| last + 1);
            let listed: Vec<String> = numbers[..last].iter().map(ToString::to_string).collect();
            format!("static const casadi_int s{index}[{}] = {};", numbers.len(), layout::braces(4, &listed))
        })
        .collect();
    let names: Vec<String> = (0..all.len()).map(|index| format!("s{index}")).collect();
    lines.push(format!("static const casadi_int *const all[] = {};", layout::braces(4, &names)));
    lines.push(format!("return i >= 0 && i < {} ? all[i] : NULL;", all.len()));
    define(&format!("const casadi_int *{name}_{what}(casadi_int i)"), &lines)
}
