//! Prints a long C function as several private functions (parts), which exchange values through arrays.

use super::body::Body;
use super::{layout, signature};
use crate::program::split::Part;

/// Statements of a split function: one call for each part, then the stores to results.
pub(super) fn calls(body: &Body<'_>, name: &str, parts: &[Part]) -> Vec<String> {
    let ty = body.ty();
    let helpers = body.fresh(parts.iter().flat_map(|_| ["taken", "made"]));
    let mut statements = vec![];
    for (index, part) in parts.iter().enumerate() {
        let [taken, made] = [&helpers[2 * index], &helpers[2 * index + 1]];
        let inputs = part.inputs.iter().map(|&input| body.names.arguments[input].clone());
        let mut arguments: Vec<String> = inputs.collect();
        if !part.takes.is_empty() {
            let values: Vec<String> = part.takes.iter().map(|&value| body.name(value).to_owned()).collect();
            let head = format!("const {ty} {taken}[{}] = ", values.len());
            statements.push(format!("{head}{};", layout::braces(4, &values)));
            arguments.push(taken.clone());
        }
        arguments.extend(body.context.passed_parameters().filter(|_| part.reads_parameters));
        arguments.push(made.clone());
        statements.push(format!("{ty} {made}[{}];", part.returns.len().max(1)));
        statements.push(layout::call(4, &part_name(name, index), &arguments, ";"));
        for (entry, &value) in part.returns.iter().enumerate() {
            statements.push(format!("const {ty} {} = {made}[{entry}];", body.name(value)));
        }
    }
    match body.return_statement() {
        Some(statement) => statements.push(statement),
        None => statements.extend(body.stores(|_| true)),
    }
    statements
}

/// The texts of the private functions into which a long function is split.
///
/// - `body`: a body without stores to results
pub(super) fn items(body: &Body<'_>, name: &str, parts: &[Part]) -> Vec<String> {
    let parts = parts.iter().enumerate();
    parts.map(|(index, part)| private(body, &part_name(name, index), part)).collect()
}

/// The private function of one part of a long function. It is never inlined, because inlining would undo the
/// division into parts.
fn private(body: &Body<'_>, name: &str, part: &Part) -> String {
    let context = body.context;
    let ty = body.ty();
    let helpers = body.fresh(["taken", "made"]);
    let inputs = part.inputs.iter().map(|&input| signature::read(context, &body.names.arguments[input]));
    let taken =
        (!part.takes.is_empty()).then(|| signature::pointer(context, &format!("const {ty}"), &helpers[0]));
    let parameters = context.declared_parameters().filter(|_| part.reads_parameters);
    let made = signature::pointer(context, &ty, &helpers[1]);
    let arguments: Vec<String> = inputs.chain(taken).chain(parameters).chain([made]).collect();
    let takes = part.takes.iter().enumerate();
    let takes =
        takes.map(|(entry, &value)| format!("const {ty} {} = {}[{entry}];", body.name(value), helpers[0]));
    let returns = part.returns.iter().enumerate();
    let returns = returns.map(|(entry, &value)| format!("{}[{entry}] = {};", helpers[1], body.name(value)));
    let statements: Vec<String> = takes.chain(body.statements(part.range.clone())).chain(returns).collect();
    let head = format!("{} static void {name}", context.constant("NOINLINE"));
    layout::function(&layout::call(0, &head, &arguments, ""), &statements)
}

fn part_name(name: &str, index: usize) -> String {
    format!("{name}_part_{}", index + 1)
}
