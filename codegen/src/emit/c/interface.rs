//! Signatures and documentation of a C module as data.

use super::body::{Body, returns_number};
use super::context::Context;
use super::positions::{functions, results_of};
use crate::emit::interface::{Argument, Callable, Interface, Written};
use crate::emit::names::spelled;
use crate::functions::function::Function;
use crate::functions::position_functions::{PositionFunction, extents};
use crate::layout::{Dimension, Extent};
use crate::module::ComposedFunction;

/// The signatures and the documentation of all functions of a module.
pub(super) fn of(context: &Context<'_>) -> Interface {
    let functions = context.module.functions.iter().zip(&context.functions);
    let functions = functions.map(|(each, name)| function(context, each, name));
    let compositions = context.module.compositions.iter().map(|each| composition(context, each));
    Interface {
        prefix: context.function("").trim_end_matches('_').to_owned(),
        parameters: context.parameters.clone(),
        functions: functions.chain(compositions).chain(of_positions(context)).collect(),
    }
}

fn function(context: &Context<'_>, function: &Function, name: &str) -> Callable {
    let face = function.program.face();
    let body = Body::new(context, &face);
    let inputs = face.inputs.iter().zip(&body.names.arguments).enumerate();
    let arguments = inputs.map(|(index, (input, name))| {
        let told = function.arguments.get(index);
        let entries = told.map(|told| told.entries.as_slice()).unwrap_or_default();
        Argument {
            name: name.clone(),
            extents: rows(input.extent),
            meaning: told.map_or(String::new(), |told| told.meaning.clone()),
            entries: entries.iter().map(|(name, unit)| (name.clone(), (*unit).to_owned())).collect(),
        }
    });
    let results = face.outputs.iter().enumerate().map(|(index, output)| Written {
        name: body.names.results.get(index).cloned().unwrap_or_else(|| spelled(&output.name)),
        symbol: output.name.clone(),
        extents: output.shape.extents(),
        meaning: function.results.get(index).cloned().unwrap_or_default(),
    });
    Callable {
        name: unprefixed(context, name),
        summary: function.summary.clone(),
        equation: function.equation.clone(),
        arguments: arguments.collect(),
        results: results.collect(),
        takes_parameters: context.has_parameters(),
        returns_number: returns_number(&face),
        lanes: context.lanes_of(&function.name).map(|name| unprefixed(context, name)),
        cost: format!("Cost: {}.", function.cost()),
        notes: function.notes.clone(),
    }
}

fn composition(context: &Context<'_>, composed: &ComposedFunction) -> Callable {
    let (n, m) = (context.module.coordinates, context.module.inputs);
    let (positions, velocities) = match context.module.has_quaternions() {
        true => (
            Extent::new(Dimension::Positions, context.module.positions),
            "velocities v, written ẏ in equations",
        ),
        false => (Extent::new(Dimension::Coordinates, n), "velocities ẏ"),
    };
    let argument = |name: &str, extents: Vec<Extent>, meaning: &str| Argument {
        name: name.to_owned(),
        extents,
        meaning: meaning.to_owned(),
        entries: vec![],
    };
    let results = composed.results.iter().map(|result| Written {
        name: spelled(result.name),
        symbol: result.name.to_owned(),
        extents: result.extents.clone(),
        meaning: result.meaning.to_owned(),
    });
    Callable {
        name: composed.composition.name().to_owned(),
        summary: composed.composition.summary().to_owned(),
        equation: composed.equation.to_owned(),
        arguments: vec![
            argument("y", vec![positions], "coordinates"),
            argument("v", vec![Extent::new(Dimension::Velocities, n)], velocities),
            argument("u", vec![Extent::new(Dimension::Inputs, m)], "inputs"),
            argument("period", vec![], "sample time in s, over which u is constant"),
        ],
        results: results.collect(),
        takes_parameters: context.has_parameters(),
        returns_number: false,
        lanes: None,
        cost: composed.cost_text.clone(),
        notes: composed
            .composition
            .notes(composed.has_quaternions)
            .iter()
            .map(|&note| note.to_owned())
            .collect(),
    }
}

/// The functions of positions with quaternions, except `normalize`, which changes its argument.
fn of_positions(context: &Context<'_>) -> Vec<Callable> {
    let (positions, velocities) = (context.module.positions, context.module.coordinates);
    let callable = |function: &PositionFunction| {
        let results = function.results().into_iter().zip(results_of(*function));
        Callable {
            name: function.name().to_owned(),
            summary: function.summary().to_owned(),
            equation: function.equation().to_owned(),
            arguments: function
                .arguments()
                .iter()
                .map(|value| Argument {
                    name: value.name.to_owned(),
                    extents: extents(value, positions, velocities),
                    meaning: value.meaning.to_owned(),
                    entries: vec![],
                })
                .collect(),
            results: results
                .map(|(value, name)| Written {
                    name: (*name).to_owned(),
                    symbol: value.name.to_owned(),
                    extents: extents(&value, positions, velocities),
                    meaning: value.meaning.to_owned(),
                })
                .collect(),
            takes_parameters: false,
            returns_number: false,
            lanes: None,
            cost: "Cost: a few hundred operations.".to_owned(),
            notes: function.notes().iter().map(|&note| note.to_owned()).collect(),
        }
    };
    functions(context).iter().filter(|each| **each != PositionFunction::Normalize).map(callable).collect()
}

/// The lengths of an argument's array. The entries of wrenches and of driven joints (prescribed position,
/// velocity and acceleration) form rows.
fn rows(extent: Extent) -> Vec<Extent> {
    match extent.row() {
        Some(row) => vec![Extent::new(extent.dimension, extent.len / row), Extent::fixed(row)],
        None => vec![extent],
    }
}

fn unprefixed(context: &Context<'_>, name: &str) -> String {
    let prefix = context.function("");
    name.strip_prefix(&prefix).unwrap_or(name).to_owned()
}
