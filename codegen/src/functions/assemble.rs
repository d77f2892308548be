//! Conversion of a row of the catalogue of functions to a program.

use super::catalogue::Argument::{
    self, Accelerations, Coordinates, Driven, Inputs, Multipliers, Velocities, Wrenches,
};
use super::catalogue::{Quantity, QuantityResult, Value, vector};
use crate::dynamics::arguments::Arguments;
use crate::dynamics::equations::Equations;
use crate::dynamics::search::routes::Formulations;
use crate::graph::{Graph, Scalar};
use crate::layout::Dimension;
use crate::model::Model;
use crate::program::{GraphOutput, InputArray, Program, Shape, lower, lower_branches};
use crate::spatial::Force;

/// Arguments of a function for a robot. If the robot has driven joints, functions of y, ẏ or ÿ also have the
/// prescribed motion d of these joints as an argument.
pub(super) fn arguments_in(model: &Model, arguments: &[Argument]) -> Vec<Argument> {
    let depends = arguments.iter().any(|each| matches!(each, Coordinates | Velocities | Accelerations));
    let driven = (depends && !model.driven.is_empty()).then_some(Driven);
    arguments.iter().copied().chain(driven).collect()
}

/// Creates the inputs of the expression graph for the arguments of a function.
pub(super) fn arguments_of<'g>(
    graph: &'g Graph,
    model: &Model,
    arguments: &[Argument],
) -> (Arguments<'g>, Vec<InputArray>) {
    let arguments = arguments_in(model, arguments);
    let scalars = |argument: Argument| match arguments.iter().position(|&other| other == argument) {
        Some(array) => (0..argument.extent(model).len).map(|index| graph.input(array, index)).collect(),
        None => Vec::new(),
    };
    let inputs = arguments
        .iter()
        .map(|argument| InputArray { name: argument.name().to_owned(), extent: argument.extent(model) });
    let inputs = inputs.collect();
    let driven = scalars(Driven);
    // Entries of driven joints follow the entries of the coordinates. An argument that the function does not
    // have stays empty.
    let with_driven = |mut own: Vec<Scalar<'g>>, part: usize| {
        if !own.is_empty() {
            own.extend(driven.iter().skip(part).step_by(3));
        }
        own
    };
    let arguments = Arguments {
        y: with_driven(positions(graph, model, scalars(Coordinates)), 0),
        v: with_driven(scalars(Velocities), 1),
        a: with_driven(scalars(Accelerations), 2),
        driven: driven.iter().skip(2).step_by(3).copied().collect(),
        u: scalars(Inputs),
        lambda: scalars(Multipliers),
        w: scalars(Wrenches).chunks_exact(6).map(Force::of_wrench).collect(),
    };
    (arguments, inputs)
}

/// Position of each coordinate: its entry of y, or 0 for a coordinate of a joint with a quaternion.
fn positions<'g>(graph: &'g Graph, model: &Model, entries: Vec<Scalar<'g>>) -> Vec<Scalar<'g>> {
    if entries.is_empty() || model.quaternion_joints.is_empty() {
        return entries;
    }
    let position = |coordinate| model.position_of(coordinate).map_or(graph.constant(0.0), |k| entries[k]);
    (0..model.coordinates.len()).map(position).collect()
}

/// Derives a function as straight-line code.
pub(super) fn straight_program(
    model: &Model,
    formulations: &Formulations<'_>,
    quantity: &Quantity,
) -> Program {
    assemble(model, formulations, quantity.arguments, quantity.results, |equations, arguments| {
        (quantity.build)(equations, arguments)
    })
}

/// Builds the expression graph of a function and converts it to a program.
pub(super) fn assemble(
    model: &Model,
    formulations: &Formulations<'_>,
    arguments: &[Argument],
    results: &[QuantityResult],
    build: impl for<'g> FnOnce(&Equations<'_, 'g>, &Arguments<'g>) -> Vec<Value<'g>>,
) -> Program {
    let graph = Graph::new();
    let (inputs_of_graph, inputs) = arguments_of(&graph, model, arguments);
    let driven = &inputs_of_graph.driven;
    let values = build(&Equations { graph: &graph, model, formulations, driven }, &inputs_of_graph);
    let outputs: Vec<_> = values
        .into_iter()
        .zip(results)
        .map(|(value, (symbol, dimensions, _))| {
            let (value, dimensions) = without_driven(model, value, dimensions);
            GraphOutput {
                name: (*symbol).to_owned(),
                shape: Shape::new(&dimensions, &value.lengths),
                entries: value.entries.iter().map(|x| x.edge()).collect(),
            }
        })
        .collect();
    match formulations.mechanism().branches() {
        true => lower_branches(&graph, inputs, &outputs),
        false => lower(&graph, inputs, &outputs),
    }
}

/// Removes the rows and columns of driven coordinates (with a prescribed motion) from a result. Jacobians of
/// frames keep these columns, because driven coordinates move frames, too.
fn without_driven<'g>(
    model: &Model,
    value: Value<'g>,
    dimensions: &[Dimension],
) -> (Value<'g>, Vec<Dimension>) {
    let n = model.coordinates.len();
    if model.driven.is_empty() {
        return (value, dimensions.to_vec());
    }
    match *dimensions {
        [Dimension::Fixed, Dimension::Velocities] => (value, vec![Dimension::Fixed; 2]),
        [Dimension::Velocities] => (vector(value.entries.into_iter().take(n).collect()), dimensions.to_vec()),
        [Dimension::Velocities, by] => {
            let columns = value.lengths[1];
            let kept = if by == Dimension::Velocities { n } else { columns };
            let rows = value.entries.chunks(columns.max(1)).take(n);
            let entries: Vec<_> = rows.flat_map(|row| &row[..kept.min(row.len())]).copied().collect();
            (Value { lengths: vec![n, kept], entries }, dimensions.to_vec())
        }
        _ => (value, dimensions.to_vec()),
    }
}
