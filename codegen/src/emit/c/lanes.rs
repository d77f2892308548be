//! Prints functions over eight states (lanes), which are adjacent in memory. The results are bit-identical to
//! the results of functions over one state.
//!
//! The text of such a function is the text of the function for one state, but values have a vector type of
//! gcc and clang with register width. The text does not rely on the optimizer, and it is the same for all
//! processors. Other compilers process one state at a time.
//!
//! Entries are loaded and stored one by one, so the arrays of states need not be converted to structures of
//! arrays. Times per state for a UR5 (gcc 12, AVX2):
//!
//! | function | one by one | with conversion |
//! |---|---|---|
//! | `inverse_dynamics` | 26 ns | 31 ns |
//! | `linearize` | 177 ns | 190 ns |

use super::body::Body;
use super::context::Context;
use super::group::COUNT;
use super::{comment, layout, signature, straight};
use crate::emit::documentation::{Block, argument_shape, shape_text};
use crate::emit::text::code;
use crate::functions::function::Function;
use crate::layout::Extent;

/// Definition of the number of states that a call evaluates at once, for the header; `None` if no function of
/// the module evaluates several states.
pub(super) fn size(context: &Context<'_>) -> Option<String> {
    let about = comment::paragraph("Number of states per call of a function whose name ends in `_lanes`.");
    context.has_lanes().then(|| format!("{about}#define {} {COUNT}\n", context.constant("LANES")))
}

/// Declaration of the function that evaluates eight states at once, with its documentation; `None` if there
/// is no such function.
pub(super) fn declaration(context: &Context<'_>, function: &Function) -> Option<String> {
    let name = context.lanes_of(&function.name)?;
    let body = Body::over_lanes(context, &function.program);
    let lanes = |shape: &str| if shape.is_empty() { "LANES".to_owned() } else { format!("LANES × {shape}") };
    let inputs = function.program.inputs.iter().zip(&body.names.arguments);
    let inputs = inputs.map(|(input, name)| format!("`{name}: [{}]`", lanes(&argument_shape(input.extent))));
    let results = function.program.outputs.iter().zip(&body.names.results).map(|(output, name)| {
        let extents: Vec<Extent> = output.shape.extents();
        signature::result_label(name, &output.name, &lanes(&shape_text(&extents)))
    });
    let about = format!(
        "{} for LANES states, which are adjacent in memory; the results are bit-identical to those of this function.",
        code(&function.name)
    );
    let items = inputs.chain(results).map(Block::Item);
    let blocks: Vec<Block> = [Block::Paragraph(about), Block::Gap].into_iter().chain(items).collect();
    let head = layout::call(0, &format!("void {name}"), &signature::arguments(&body), ";");
    Some(format!("{}{head}\n", comment::documentation(&blocks)))
}

/// The texts of a function that evaluates eight states at once: private functions for a group of states that
/// fit in one register, then the public function that calls these functions for each group. Empty if the
/// function evaluates only one state.
pub(super) fn items(context: &Context<'_>, function: &Function) -> Vec<String> {
    let Some(name) = context.lanes_of(&function.name) else {
        return vec![];
    };
    let body = Body::over_lanes(context, &function.program);
    let of_group = format!("{name}_of_group");
    let (mut items, statements) = straight::statements(&body, straight::longest(context), &of_group, || {
        Body::over_lanes(context, &function.program)
    });
    let arguments = signature::arguments(&body);
    // This function is not inlined, because two unrolled copies would not fit in the instruction cache.
    let head = format!("{} static void {of_group}", context.constant("NOINLINE"));
    items.push(layout::function(&layout::call(0, &head, &arguments, ""), &statements));
    let first = &body.fresh(["first"])[0];
    let at_group = |(name, len): (&String, usize)| format!("&{name}[{first} * {len}]");
    let inputs = function.program.inputs.iter().map(|input| input.extent.len);
    let inputs = body.names.arguments.iter().zip(inputs).map(at_group);
    let results = function.program.outputs.iter().map(|output| output.entries.len());
    let results = body.names.results.iter().zip(results).map(at_group);
    let passed: Vec<String> = inputs.chain(context.passed_parameters()).chain(results).collect();
    let (count, width) = (context.constant("LANES"), context.constant("WIDTH"));
    let statements = [
        format!("for (int {first} = 0; {first} < {count}; {first} += {width}) {{"),
        layout::indented(&layout::call(8, &of_group, &passed, ";")).trim_end().to_owned(),
        "}".to_owned(),
    ];
    items.push(layout::function(&layout::call(0, &format!("void {name}"), &arguments, ""), &statements));
    items
}
