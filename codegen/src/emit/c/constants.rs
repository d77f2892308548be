//! Prints the constants of a module. Lengths are macros, other constants are objects.

use super::context::Context;
use super::literal::string;
use super::{comment, layout};
use crate::emit::documentation::{Block, of_constant};
use crate::functions::function::{Constant, ConstantValue};
use crate::layout::{Dimension, Extent};

/// Definitions of the numbers of coordinates and inputs, with their documentation.
pub(super) fn sizes(context: &Context<'_>) -> Vec<String> {
    let size = |name: &str, about: &str, count: usize| {
        format!("{}#define {} {count}\n", comment::paragraph(about), context.constant(name))
    };
    vec![
        size("N", "Number of coordinates.", context.module.coordinates),
        size("M", "Number of inputs.", context.module.inputs),
    ]
}

/// Declaration of a constant with its documentation, for the header.
pub(super) fn declaration(context: &Context<'_>, constant: &Constant) -> String {
    let mut blocks = of_constant(constant);
    let name = context.constant(constant.name);
    let text = match object(context, constant) {
        Object::Macro(value) => format!("#define {name} {value}\n"),
        Object::Empty => {
            blocks
                .push(Block::Paragraph("This array is not declared, because it has no entries.".to_owned()));
            format!("// {name}\n")
        }
        Object::Array { ty, lengths, .. } => format!("extern const {ty}{name}{lengths};\n"),
    };
    [comment::documentation(&blocks), text].concat()
}

/// Definition of a constant, for the source; `None` if the declaration is complete. For the hash of the
/// description, the definition checks that header and source have the same hash.
pub(super) fn definition(context: &Context<'_>, constant: &Constant) -> Option<String> {
    let name = context.constant(constant.name);
    match object(context, constant) {
        Object::Macro(value) if matches!(constant.value, ConstantValue::Hash(_)) => {
            let file = &context.name;
            let error = format!("#error \"{file}.h and {file}.c were not generated together\"");
            Some(format!("#if {name} != {value}\n{error}\n#endif\n"))
        }
        Object::Macro(_) | Object::Empty => None,
        Object::Array { ty, lengths, entries } => {
            Some(format!("const {ty}{name}{lengths} = {};\n", layout::braces(0, &entries)))
        }
    }
}

/// Type of the entries of sparse matrices; `None` if the module has no sparse matrix.
pub(super) fn entry_type(context: &Context<'_>) -> Option<String> {
    let module = context.module;
    let constants = module.functions.iter().flat_map(|function| &function.constants);
    let mut constants = module.constants.iter().chain(constants);
    let has_sparse = constants.any(|constant| matches!(constant.value, ConstantValue::Sparse(_)));
    let about = comment::paragraph("An entry of a sparse matrix.");
    has_sparse.then(|| {
        let (ty, name) = (context.ty(), context.function("entry"));
        format!("{about}typedef struct {{\n    int row;\n    int column;\n    {ty} value;\n}} {name};\n")
    })
}

/// Declaration of a constant in C.
enum Object {
    Macro(String),
    /// An array without entries. It is left out, because C does not support it.
    Empty,
    Array {
        /// Type in front of the constant's name, with a space or a star at its end.
        ty: String,
        /// Lengths of the constant in brackets after its name.
        lengths: String,
        entries: Vec<String>,
    },
}

fn object(context: &Context<'_>, constant: &Constant) -> Object {
    let ty = format!("{} ", context.ty());
    let numbers = |numbers: &[f64]| -> Vec<String> { numbers.iter().map(|&x| context.literal(x)).collect() };
    let array = |ty: &str, extents: &[Extent], entries: Vec<String>| match extents
        .iter()
        .any(|extent| extent.len == 0)
    {
        true => Object::Empty,
        false => Object::Array { ty: ty.to_owned(), lengths: lengths(context, extents), entries },
    };
    match &constant.value {
        ConstantValue::Count(count) => Object::Macro(count.to_string()),
        ConstantValue::Hash(hash) => Object::Macro(format!("{hash:#018x}ULL")),
        ConstantValue::Names(dimension, names) => {
            let extent = Extent::new(*dimension, names.len());
            array("char *const ", &[extent], names.iter().map(|name| string(name)).collect())
        }
        ConstantValue::Indices(dimension, indices) => {
            let extent = Extent::new(*dimension, indices.len());
            array("int ", &[extent], indices.iter().map(ToString::to_string).collect())
        }
        ConstantValue::Pairs(pairs) => {
            let extents = [Extent::fixed(pairs.len()), Extent::fixed(2)];
            array(
                "int ",
                &extents,
                pairs.iter().map(|pair| row(&pair.map(|index| index.to_string()))).collect(),
            )
        }
        ConstantValue::Numbers(dimension, entries) => {
            array(&ty, &[Extent::new(*dimension, entries.len())], numbers(entries))
        }
        ConstantValue::Ranges(dimension, ranges) => {
            let extents = [Extent::new(*dimension, ranges.len()), Extent::fixed(2)];
            array(&ty, &extents, ranges.iter().map(|range| row(&numbers(range))).collect())
        }
        ConstantValue::Rows(columns, rows) => {
            let width = Extent::new(*columns, rows.first().map_or(0, Vec::len));
            let extents = [Extent::fixed(rows.len()), width];
            array(&ty, &extents, rows.iter().map(|entries| row(&numbers(entries))).collect())
        }
        ConstantValue::Sparse(entries) => {
            let shown = entries
                .iter()
                .map(|&(row, column, value)| format!("{{{row}, {column}, {}}}", context.literal(value)));
            let ty = format!("{} ", context.function("entry"));
            array(&ty, &[Extent::fixed(entries.len())], shown.collect())
        }
        ConstantValue::Pattern(rows) => {
            let width = Extent::new(Dimension::Fixed, rows.first().map_or(0, Vec::len));
            let bits = |entries: &Vec<bool>| -> Vec<String> {
                entries.iter().map(|&entry| u8::from(entry).to_string()).collect()
            };
            let extents = [Extent::fixed(rows.len()), width];
            array("unsigned char ", &extents, rows.iter().map(|entries| row(&bits(entries))).collect())
        }
    }
}

fn row(entries: &[String]) -> String {
    format!("{{{}}}", entries.join(", "))
}

fn lengths(context: &Context<'_>, extents: &[Extent]) -> String {
    let length = |extent: &Extent| match extent.dimension.length() {
        Some(name) => format!("[{}]", context.constant(name)),
        None => format!("[{}]", extent.len),
    };
    extents.iter().map(length).collect()
}
