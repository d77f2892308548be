//! Prints loops over many states for Python. NumPy calls them as generalized universal functions.
//!
//! NumPy passes plain pointers, lengths and strides, so the text needs no header of Python or NumPy.

use super::context::Context;
use super::{comment, group, header, interface, layout};
use crate::emit::interface::{Callable, Interface, entries};
use crate::layout::Extent;

/// Prints the file `<name>_python.c`.
pub(super) fn text(context: &Context<'_>) -> String {
    let interface = interface::of(context);
    let has_lanes = interface.functions.iter().any(|each| lanes(context, each).is_some());
    let lanes = if has_lanes { LANES } else { NO_LANES };
    let shared = context.pasted_loops(&[BEGIN, lanes, LOOP].concat());
    let functions = interface.functions.iter().filter_map(|each| function(context, &interface, each));
    [
        header::top(context),
        format!("\n#include \"{}.h\"\n", context.name),
        shared,
        functions.map(|text| format!("\n{text}")).collect(),
        "\n#ifdef __cplusplus\n}\n#endif\n".to_owned(),
    ]
    .concat()
}

/// Beginning of `<name>_python.c`: types, and access to operands. The entries of an operand may have a
/// stride, for example in a column of a matrix.
const BEGIN: &str = include_str!("python/begin.c");

/// Text of the loop over blocks of eight states.
const LANES: &str = include_str!("python/lanes.c");

/// Text that replaces [`LANES`] if no function of the module evaluates eight states at once.
const NO_LANES: &str = include_str!("python/no_lanes.c");

const LOOP: &str = include_str!("python/loop.c");

/// Largest number of operand entries of eight states that a loop keeps on the stack: 64 kB in double
/// precision. The whole stack may have only 100 kB.
const LARGEST_BLOCK: usize = 8_192;

/// The loop over many states that calls a function; `None` if no result has entries. Operands without entries
/// are left out, because NumPy does not support lengths of zero.
fn function(context: &Context<'_>, interface: &Interface, function: &Callable) -> Option<String> {
    let arguments = function.arguments.iter().map(|argument| argument.extents.clone());
    let parameters = function.takes_parameters.then(|| vec![Extent::fixed(interface.parameters.len())]);
    let inputs: Vec<Vec<Extent>> = arguments.chain(parameters).filter(|each| entries(each) > 0).collect();
    let results = function.results.iter().map(|result| result.extents.clone());
    let results: Vec<Vec<Extent>> = results.filter(|each| entries(each) > 0).collect();
    if results.is_empty() {
        return None;
    }
    let operands = [inputs.as_slice(), &results].concat();
    let (name, ty) = (context.function(&format!("python_{}", function.name)), context.ty());
    let lanes = lanes(context, function);
    let total: usize = operands.iter().map(|each| entries(each)).sum();
    let total = if lanes.is_some() { group::COUNT * total } else { total };
    let (of_lanes, declared_lanes) = match &lanes {
        Some(lanes) => {
            let text = call(context, function, Some(lanes));
            (format!("{name}_lanes"), format!("static void {name}_lanes({ty} *const *x)\n{{\n{text}}}\n\n"))
        }
        None => ("0".to_owned(), String::new()),
    };
    let about = comment::paragraph(&function.summary);
    let arguments = ["char **args", "const intptr_t *dimensions", "const intptr_t *steps", "void *data"];
    let arguments = arguments.map(str::to_owned);
    let (export, operand) = (context.constant("EXPORT"), context.function("operand"));
    let declared = layout::call(0, &format!("{export} void {name}"), &arguments, ";");
    let head = layout::call(0, &format!("void {name}"), &arguments, "");
    let parameters = match function.takes_parameters {
        true => (inputs.len() - 1).to_string(),
        false => "-1".to_owned(),
    };
    let count = operands.len();
    let told = [
        format!("{name}_call"),
        of_lanes,
        inputs.len().to_string(),
        count.to_string(),
        parameters,
        "operands".to_owned(),
    ];
    let operands: Vec<String> = operands.iter().map(|each| self::operand(each)).collect();
    let statements = [
        format!("static const {operand} operands[] = {};", layout::braces(4, &operands)),
        format!("static const {} function = {};", context.function("function"), layout::braces(4, &told)),
        format!("{ty} buffer[{total}], *x[{count}];"),
        "(void)data;".to_owned(),
        format!("{}(&function, x, buffer, args, dimensions[0], steps);", context.function("loop")),
    ];
    Some(format!(
        "static void {name}_call({ty} *const *x)\n{{\n{call}}}\n\n{declared_lanes}{about}{declared}\n\n{function}",
        call = call(context, function, None),
        function = layout::function(&head, &statements),
    ))
}

fn operand(extents: &[Extent]) -> String {
    let mut lengths: Vec<String> = extents.iter().map(|extent| extent.len.to_string()).collect();
    lengths.resize(4, "1".to_owned());
    format!("{{{}, {}, {{{}}}}}", extents.len(), entries(extents), lengths.join(", "))
}

/// Name of the function that evaluates eight states at once. `None` if there is no such function, or if its
/// operands are too large for the stack.
fn lanes(context: &Context<'_>, function: &Callable) -> Option<String> {
    let arguments = function.arguments.iter().map(|argument| entries(&argument.extents));
    let total: usize = arguments.chain(function.results.iter().map(|result| entries(&result.extents))).sum();
    let name = function.lanes.as_ref().filter(|_| group::COUNT * total <= LARGEST_BLOCK)?;
    Some(context.function(name))
}

/// Statements that call a function for one or eight states with the operands `x`.
fn call(context: &Context<'_>, function: &Callable, lanes: Option<&str>) -> String {
    let mut taken = 0;
    let mut next = |is_there: bool| match is_there {
        true => {
            taken += 1;
            format!("x[{}]", taken - 1)
        }
        false => format!("({} *)0", context.ty()),
    };
    let mut words: Vec<String> = vec![];
    let mut statements = String::new();
    for argument in &function.arguments {
        let operand = next(entries(&argument.extents) > 0);
        words.push(if argument.is_number() { format!("*{operand}") } else { operand });
    }
    if function.takes_parameters {
        let ty = context.function("parameters");
        statements.push_str(&format!("    {ty} p;\n    memcpy(&p, {}, sizeof p);\n", next(true)));
        words.push("&p".to_owned());
    }
    let results: Vec<String> =
        function.results.iter().map(|result| next(entries(&result.extents) > 0)).collect();
    let name = lanes.map_or_else(|| context.function(&function.name), str::to_owned);
    match (function.returns_number && lanes.is_none(), results.as_slice()) {
        (true, [result]) => {
            statements.push_str(&format!("    *{result} = {name}({});\n", words.join(", ")));
        }
        _ => {
            words.extend(results);
            statements.push_str(&format!("    {name}({});\n", words.join(", ")));
        }
    }
    statements
}
