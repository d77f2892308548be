//! Prints the header of a C module.

use super::context::Context;
use super::{comment, constants, discrete_time, lanes, parameters, positions, public, stack};
use crate::emit::header;

/// Prints the file `<name>.h`.
pub(super) fn text(context: &Context<'_>) -> String {
    let module = context.module;
    let mut items = constants::sizes(context);
    items.extend(lanes::size(context));
    items.extend(module.constants.iter().map(|constant| constants::declaration(context, constant)));
    items.extend(parameters::declarations(context));
    items.extend(constants::entry_type(context));
    for (function, name) in module.functions.iter().zip(&context.functions) {
        items.extend(function.constants.iter().map(|constant| constants::declaration(context, constant)));
        items.push(public::declaration(context, function, name, stack::of_function(context, function)));
        items.extend(lanes::declaration(context, function));
    }
    items.extend(module.substeps.iter().map(|constant| constants::declaration(context, constant)));
    items.extend(module.compositions.iter().map(|each| discrete_time::declaration(context, each)));
    items.extend(positions::declarations(context));
    let items: String = items.iter().map(|item| format!("\n{item}")).collect();
    let (guard, restrict) = (context.constant("H"), context.constant("RESTRICT"));
    format!(
        "{}{}\n#ifndef {guard}\n#define {guard}\n\n\
         // Results must not overlap each other or an argument.\n\
         #if defined(__GNUC__)\n#define {restrict} __restrict__\n\
         #elif defined(__cplusplus)\n#define {restrict}\n\
         #else\n#define {restrict} restrict\n#endif\n\n\
         {}#ifdef __cplusplus\nextern \"C\" {{\n#endif\n\
         {items}\n\
         #ifdef __cplusplus\n}}\n#endif\n\n#endif\n",
        top(context),
        conventions(context),
        positions::include(context),
    )
}

/// The comment at the top of header and source, which names the command that regenerates them.
pub(super) fn top(context: &Context<'_>) -> String {
    let lines = header::lines(context.module, &context.options.command);
    lines.iter().map(|line| comment::ended(line)).collect()
}

/// Comment in the header about the calling convention of all functions.
fn conventions(context: &Context<'_>) -> String {
    let (n, function) = (context.constant("N"), context.function(""));
    let (capitals, ty) = (context.constant(""), context.ty());
    let lines = [
        String::new(),
        "How the functions are called:".to_owned(),
        String::new(),
        format!("- Numbers are `{ty}`. An argument or result `x: [N]` is an array of {n} numbers."),
        format!("- A matrix `m: [N × N]` is stored row by row: m[i * {n} + j] is the entry of row i and column j."),
        "- Results are written through the last arguments. Every entry is written, and no previous value is read. A".to_owned(),
        "  function whose only result is one number returns it.".to_owned(),
        "- Results must not overlap each other or an argument.".to_owned(),
        "- No function allocates, keeps a state or calls a library. Several threads may call it at once.".to_owned(),
        format!("- The documentation omits the prefixes `{function}` of functions and `{capitals}` of constants."),
    ];
    lines.iter().map(|line| format!("{}\n", format!("// {line}").trim_end())).collect()
}
