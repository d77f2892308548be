//! Loops over many states for Python: the functions as NumPy's generalized universal functions call them.
//!
//! NumPy hands over plain pointers, lengths and steps, so that the text needs no header of Python or NumPy.

use super::context::Context;
use super::{comment, header, interface, layout};
use crate::emit::interface::{Callable, Interface, entries};
use crate::layout::Extent;

/// The text of `<name>_python.c`.
pub(super) fn text(context: &Context<'_>) -> String {
    let interface = interface::of(context);
    let shared = context.pasted_loops(SHARED);
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

/// What all loops share: numbers may stand apart in memory, as in a column of a matrix.
const SHARED: &str = r#"
#include <fenv.h>
#include <stdint.h>
#include <string.h>

// Loops over many states, as NumPy calls generalized universal functions: `args` has the first state of each
// operand, `dimensions` begins with the number of states, `steps` with the bytes from one state to the next. The
// bytes from one entry to the next follow, for each dimension of each operand.
#if defined(_WIN32)
#define GELENK_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define GELENK_EXPORT __attribute__((visibility("default")))
#else
#define GELENK_EXPORT
#endif

#ifdef __cplusplus
extern "C" {
#endif

// The lengths of an operand, outermost first.
typedef struct {
    int rank;
    int lengths[4];
} gelenk_operand;

static int gelenk_entries(const gelenk_operand *operand)
{
    int count = 1;
    for (int axis = 0; axis < operand->rank; ++axis)
        count *= operand->lengths[axis];
    return count;
}

// Tells whether the entries stand one behind the other.
static int gelenk_is_dense(const gelenk_operand *operand, const intptr_t *steps)
{
    intptr_t expected = (intptr_t)sizeof(double);
    for (int axis = operand->rank - 1; axis >= 0; --axis) {
        if (operand->lengths[axis] > 1 && steps[axis] != expected)
            return 0;
        expected *= operand->lengths[axis];
    }
    return 1;
}

static intptr_t gelenk_offset(const gelenk_operand *operand, const intptr_t *steps, int entry)
{
    intptr_t offset = 0;
    for (int axis = operand->rank - 1; axis >= 0; --axis) {
        offset += entry % operand->lengths[axis] * steps[axis];
        entry /= operand->lengths[axis];
    }
    return offset;
}

// NumPy would make warnings of the processor's flags. Results tell by themselves that they are not finite, and a branch
// that was computed for nothing raises flags too.
static void gelenk_clear_flags(void)
{
    if (fetestexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW | FE_UNDERFLOW))
        feclearexcept(FE_ALL_EXCEPT);
}

// Calls a function for each state. Operands whose entries stand apart pass through `buffer`, which holds the entries
// of all of them.
static void gelenk_loop(
    void (*call)(double *const *x), const gelenk_operand *operands, int inputs, int count, double **x, double *buffer,
    char **args, intptr_t states, const intptr_t *steps)
{
    int has_gaps = 0;
    const intptr_t *inner = steps + count;
    for (int i = 0; i < count; ++i) {
        has_gaps |= !gelenk_is_dense(&operands[i], inner);
        inner += operands[i].rank;
    }
    if (!has_gaps) {
        for (intptr_t state = 0; state < states; ++state) {
            for (int i = 0; i < count; ++i)
                x[i] = (double *)(void *)(args[i] + state * steps[i]);
            call(x);
        }
        gelenk_clear_flags();
        return;
    }
    for (intptr_t state = 0; state < states; ++state) {
        double *next = buffer;
        inner = steps + count;
        for (int i = 0; i < count; ++i) {
            const int entries = gelenk_entries(&operands[i]);
            x[i] = next;
            for (int entry = 0; i < inputs && entry < entries; ++entry)
                memcpy(&next[entry], args[i] + state * steps[i] + gelenk_offset(&operands[i], inner, entry), sizeof *next);
            next += entries;
            inner += operands[i].rank;
        }
        call(x);
        inner = steps + count;
        for (int i = 0; i < count; ++i) {
            const int entries = gelenk_entries(&operands[i]);
            for (int entry = 0; i >= inputs && entry < entries; ++entry)
                memcpy(args[i] + state * steps[i] + gelenk_offset(&operands[i], inner, entry), &x[i][entry], sizeof *next);
            inner += operands[i].rank;
        }
    }
    gelenk_clear_flags();
}
"#;

/// The loop of a function; none where no result has entries. Operands without entries are left out: NumPy has no
/// lengths of zero.
fn function(context: &Context<'_>, interface: &Interface, function: &Callable) -> Option<String> {
    let arguments = function.arguments.iter().map(|argument| argument.extents.clone());
    let parameters = context.has_parameters().then(|| vec![Extent::fixed(interface.parameters.len())]);
    let inputs: Vec<Vec<Extent>> = arguments.chain(parameters).filter(|each| entries(each) > 0).collect();
    let results = function.results.iter().map(|result| result.extents.clone());
    let results: Vec<Vec<Extent>> = results.filter(|each| entries(each) > 0).collect();
    if results.is_empty() {
        return None;
    }
    let operands = [inputs.as_slice(), &results].concat();
    let (name, ty) = (context.function(&format!("python_{}", function.name)), context.ty());
    let total: usize = operands.iter().map(|each| entries(each)).sum();
    let (inputs, count) = (inputs.len(), operands.len());
    let operands: Vec<String> = operands.iter().map(|each| operand(each)).collect();
    let operands = layout::braces(4, &operands);
    let about = comment::paragraph(&function.summary);
    let arguments = ["char **args", "const intptr_t *dimensions", "const intptr_t *steps", "void *data"];
    let arguments = arguments.map(str::to_owned);
    let (export, operand) = (context.constant("EXPORT"), context.function("operand"));
    let declared = layout::call(0, &format!("{export} void {name}"), &arguments, ";");
    let head = layout::call(0, &format!("void {name}"), &arguments, "");
    let run = [
        format!("{name}_call"),
        "operands".to_owned(),
        inputs.to_string(),
        count.to_string(),
        "x, buffer, args, dimensions[0], steps".to_owned(),
    ];
    let statements = [
        format!("static const {operand} operands[] = {operands};"),
        format!("{ty} buffer[{total}], *x[{count}];"),
        "(void)data;".to_owned(),
        layout::call(4, &context.function("loop"), &run, ";"),
    ];
    Some(format!(
        "static void {name}_call({ty} *const *x)\n{{\n{call}}}\n\n{about}{declared}\n\n{function}",
        call = call(context, function),
        function = layout::function(&head, &statements),
    ))
}

fn operand(extents: &[Extent]) -> String {
    let mut lengths: Vec<String> = extents.iter().map(|extent| extent.len.to_string()).collect();
    lengths.resize(4, "1".to_owned());
    format!("{{{}, {{{}}}}}", extents.len(), lengths.join(", "))
}

/// The statements that call a function with the operands `x`.
fn call(context: &Context<'_>, function: &Callable) -> String {
    let mut operands = (0..).map(|index| format!("x[{index}]"));
    let mut next = |is_there: bool| match is_there {
        true => operands.next().unwrap_or_default(),
        false => format!("({} *)0", context.ty()),
    };
    let mut words: Vec<String> = vec![];
    let mut statements = String::new();
    for argument in &function.arguments {
        let operand = next(entries(&argument.extents) > 0);
        words.push(if argument.is_number() { format!("*{operand}") } else { operand });
    }
    if context.has_parameters() {
        let ty = context.function("parameters");
        statements.push_str(&format!("    {ty} p;\n    memcpy(&p, {}, sizeof p);\n", next(true)));
        words.push("&p".to_owned());
    }
    let results: Vec<String> =
        function.results.iter().map(|result| next(entries(&result.extents) > 0)).collect();
    let name = context.function(&function.name);
    match (function.returns_number, results.as_slice()) {
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
