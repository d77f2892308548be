//! From a row of the catalogue to a program.

use super::catalogue::Argument::{
    self, Accelerations, Coordinates, Inputs, Multipliers, Velocities, Wrenches,
};
use super::catalogue::{Quantity, QuantityResult, Value};
use crate::dynamics::arguments::Arguments;
use crate::dynamics::equations::Equations;
use crate::dynamics::search::routes::Formulations;
use crate::graph::{Graph, Scalar};
use crate::model::Model;
use crate::program::{GraphOutput, InputArray, Program, Shape, lower};
use crate::spatial::Force;

/// Inputs of a graph for the arguments of a function.
pub(super) fn arguments_of<'g>(
    graph: &'g Graph,
    model: &Model,
    arguments: &[Argument],
) -> (Arguments<'g>, Vec<InputArray>) {
    let scalars = |argument: Argument| match arguments.iter().position(|&other| other == argument) {
        Some(array) => (0..argument.extent(model).len).map(|index| graph.input(array, index)).collect(),
        None => Vec::new(),
    };
    let inputs = arguments
        .iter()
        .map(|argument| InputArray { name: argument.name().to_owned(), extent: argument.extent(model) });
    let inputs = inputs.collect();
    let arguments = Arguments {
        y: positions(graph, model, scalars(Coordinates)),
        v: scalars(Velocities),
        a: scalars(Accelerations),
        u: scalars(Inputs),
        lambda: scalars(Multipliers),
        w: scalars(Wrenches).chunks_exact(6).map(Force::of_wrench).collect(),
    };
    (arguments, inputs)
}

/// Positions by coordinate: entries of y, and 0 where the position is a quaternion's.
fn positions<'g>(graph: &'g Graph, model: &Model, entries: Vec<Scalar<'g>>) -> Vec<Scalar<'g>> {
    if entries.is_empty() || model.quaternion_joints.is_empty() {
        return entries;
    }
    let position = |coordinate| model.position_of(coordinate).map_or(graph.constant(0.0), |k| entries[k]);
    (0..model.coordinates.len()).map(position).collect()
}

/// A function as straight-line code.
pub(super) fn straight_program(
    model: &Model,
    formulations: &Formulations<'_>,
    quantity: &Quantity,
) -> Program {
    assemble(model, formulations, quantity.arguments, quantity.results, |equations, arguments| {
        (quantity.build)(equations, arguments)
    })
}

/// Builds the graph of a function and lowers it.
pub(super) fn assemble(
    model: &Model,
    formulations: &Formulations<'_>,
    arguments: &[Argument],
    results: &[QuantityResult],
    build: impl for<'g> FnOnce(&Equations<'_, 'g>, &Arguments<'g>) -> Vec<Value<'g>>,
) -> Program {
    let graph = Graph::new();
    let (inputs_of_graph, inputs) = arguments_of(&graph, model, arguments);
    let values = build(&Equations { graph: &graph, model, formulations }, &inputs_of_graph);
    let outputs: Vec<_> = values
        .iter()
        .zip(results)
        .map(|(value, (symbol, dimensions, _))| GraphOutput {
            name: (*symbol).to_owned(),
            shape: Shape::new(dimensions, &value.lengths),
            entries: value.entries.iter().map(|x| x.edge()).collect(),
        })
        .collect();
    lower(&graph, inputs, &outputs)
}
