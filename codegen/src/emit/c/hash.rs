//! One number for a module: it tells header and source of one generation from those of another.

use super::context::Context;
use super::header;
use gelenk_kernels::hash::fnv1a;

/// Stands for the number in the texts that are hashed.
const VALUE: &str = "HASH_OF_THIS_TEXT";

/// The definition in the header.
pub(super) fn definition(context: &Context<'_>) -> String {
    let (name, version) = (context.constant("HASH"), env!("CARGO_PKG_VERSION"));
    format!("/// Hash of header and source, by gelenk {version}.\n#define {name} {VALUE}\n")
}

/// The check in the source.
pub(super) fn check(context: &Context<'_>) -> String {
    let (name, file) = (context.constant("HASH"), &context.name);
    format!("\n#if {name} != {VALUE}\n#error \"{file}.h and {file}.c were not generated together\"\n#endif\n")
}

/// The texts with their number, each below the comment at the top.
///
/// The comment is not hashed, since it holds the paths of a command line.
pub(super) fn stamped<const COUNT: usize>(context: &Context<'_>, texts: [String; COUNT]) -> [String; COUNT] {
    let value = format!("0x{:016x}ULL", fnv1a(texts.iter().flat_map(|text| text.bytes())));
    let top = header::top(context);
    texts.map(|text| format!("{top}{}", text.replace(VALUE, &value)))
}
