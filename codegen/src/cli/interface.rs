//! Signatures and documentation of a C module as JSON, for tools that make bindings.

use serde_json::{Map, Value, json};

use crate::emit::interface::{Argument, Callable, Interface, Written};
use crate::functions::function::{Constant, ConstantValue};
use crate::layout::Extent;
use crate::model::Parameter;
use crate::module::Module;

/// Returns a JSON object with all functions (C names, shapes, meanings and units), the free parameters, and
/// the values of all constants.
pub(super) fn json(interface: &Interface, module: &Module) -> Value {
    let fields = module.parameters.iter().zip(&interface.parameters);
    let of_functions = module.functions.iter().flat_map(|function| &function.constants);
    let constants = module.constants.iter().chain(of_functions).chain(&module.substeps);
    json!({
        "prefix": interface.prefix,
        "description": module.description,
        "coordinates": module.coordinates,
        "inputs": module.inputs,
        "constants": constants.map(constant).collect::<Vec<_>>(),
        "parameters": fields.map(|(parameter, field)| self::parameter(parameter, field)).collect::<Vec<_>>(),
        "functions": interface.functions.iter().map(function).collect::<Vec<_>>(),
    })
}

fn parameter(parameter: &Parameter, field: &str) -> Value {
    json!({
        "name": parameter.name,
        "field": field,
        "unit": parameter.unit,
        "description": parameter.description,
        "default": parameter.default,
    })
}

fn function(function: &Callable) -> Value {
    json!({
        "name": function.name,
        "summary": function.summary,
        "equation": function.equation,
        "arguments": function.arguments.iter().map(argument).collect::<Vec<_>>(),
        "results": function.results.iter().map(result).collect::<Vec<_>>(),
        "takes_parameters": function.takes_parameters,
        "returns_number": function.returns_number,
        "lanes": function.lanes,
        "cost": function.cost,
        "notes": function.notes,
    })
}

fn argument(argument: &Argument) -> Value {
    let entry = |(name, unit): &(String, String)| json!({ "name": name, "unit": unit });
    json!({
        "name": argument.name,
        "shape": shape(&argument.extents),
        "dimensions": dimensions(&argument.extents),
        "meaning": argument.meaning,
        "entries": argument.entries.iter().map(entry).collect::<Vec<_>>(),
    })
}

fn result(result: &Written) -> Value {
    json!({
        "name": result.name,
        "symbol": result.symbol,
        "shape": shape(&result.extents),
        "dimensions": dimensions(&result.extents),
        "meaning": result.meaning,
    })
}

fn shape(extents: &[Extent]) -> Vec<usize> {
    extents.iter().map(|extent| extent.len).collect()
}

/// For each length of an array the name of its constant; `None` if the length does not depend on the robot.
fn dimensions(extents: &[Extent]) -> Vec<Option<&'static str>> {
    extents.iter().map(|extent| extent.dimension.length()).collect()
}

fn constant(constant: &Constant) -> Value {
    let (kind, value) = value(&constant.value);
    let mut entry = Map::new();
    entry.insert("name".to_owned(), json!(constant.name));
    entry.insert("kind".to_owned(), json!(kind));
    entry.insert("summary".to_owned(), json!(constant.summary));
    entry.insert("items".to_owned(), json!(constant.items));
    entry.insert("value".to_owned(), value);
    Value::Object(entry)
}

fn value(value: &ConstantValue) -> (&'static str, Value) {
    let numbers = |numbers: &[f64]| -> Value { numbers.iter().map(|&x| number(x)).collect() };
    match value {
        ConstantValue::Count(count) => ("count", json!(count)),
        ConstantValue::Hash(hash) => ("count", json!(hash)),
        ConstantValue::Names(_, names) => ("names", json!(names)),
        ConstantValue::Indices(_, indices) => ("indices", json!(indices)),
        ConstantValue::Pairs(pairs) => ("indices", json!(pairs)),
        ConstantValue::Numbers(_, entries) => ("numbers", numbers(entries)),
        ConstantValue::Ranges(_, ranges) => ("numbers", ranges.iter().map(|range| numbers(range)).collect()),
        ConstantValue::Rows(_, rows) => ("numbers", rows.iter().map(|row| numbers(row)).collect()),
        ConstantValue::Sparse(entries) => {
            let entries = entries.iter().map(|&(row, column, x)| json!([row, column, number(x)]));
            ("sparse", entries.collect())
        }
        ConstantValue::Pattern(rows) => ("pattern", json!(rows)),
    }
}

/// A number for JSON. Infinity is the text `"inf"` or `"-inf"`, because JSON has no infinity.
fn number(x: f64) -> Value {
    match x.is_finite() {
        true => json!(x),
        false => json!(format!("{x}")),
    }
}
