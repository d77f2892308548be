//! How results of several states are written: two entries that follow one another at once, since processors write few
//! times in a cycle.

use super::super::body::Body;
use crate::program::Operand;

/// The statement that writes an entry which has just been made; none where the entry beside it is made later.
///
/// - `index`: what was made
pub(in crate::emit::c) fn store_at(
    body: &Body<'_>,
    result: usize,
    entry: usize,
    index: usize,
) -> Option<String> {
    let first = entry - entry % 2;
    let beside = body.program.outputs[result].entries.get(first + 1 - entry % 2);
    let is_known = match beside.and_then(|&beside| body.made(beside)) {
        None => true,
        Some(made) if made == index => entry == first,
        Some(made) => made < index,
    };
    is_known.then(|| store(body, result, first))
}

/// The statements that write those entries that are wanted, where what stands beside them is wanted too.
pub(in crate::emit::c) fn stores(body: &Body<'_>, is_wanted: impl Fn(Operand) -> bool) -> Vec<String> {
    let outputs = body.program.outputs.iter().enumerate();
    let stores = outputs.flat_map(|(result, output)| {
        let pairs = output.entries.chunks(2).enumerate();
        let wanted = pairs.filter(|(_, pair)| pair.iter().all(|&entry| is_wanted(entry)));
        wanted.map(move |(index, _)| store(body, result, 2 * index))
    });
    stores.collect()
}

/// Writes an entry and the one behind it, where there is one.
fn store(body: &Body<'_>, result: usize, first: usize) -> String {
    let entries = &body.program.outputs[result].entries;
    let (name, len) = (&body.names.results[result], entries.len());
    let pair: Vec<String> = entries[first..].iter().take(2).map(|&entry| body.value(entry)).collect();
    let callee = body.context.function(if pair.len() == 2 { "scatter_pair" } else { "scatter" });
    format!("{callee}(&{name}[{first}], {len}, {});", pair.join(", "))
}
