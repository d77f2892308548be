//! From a row of the catalogue to a function.

use super::frames::frame_name;
use super::quantity::Argument::{Accelerations, Coordinates, Inputs, Multipliers, Velocities};
use super::quantity::{Argument, Arguments, FrameQuantity, Quantity, QuantityResult, Value};
use crate::diagnostic::Diagnostics;
use crate::dynamics::array_form::{self, Derived, Form, Forms};
use crate::dynamics::equations::{Equations, Formulations};
use crate::dynamics::forces;
use crate::dynamics::function::Function;
use crate::dynamics::selection::{self, Request};
use crate::graph::Graph;
use crate::kinematics::lower_pose;
use crate::model::{Definiteness, Frame, Model};
use crate::program::{GraphOutput, InputArray, Program, Shape, lower};

/// Derives the selected functions of a model, and those that selected ones call; an empty selection means all but those
/// on request and those that cannot be generated, `frames` all functions of named frames.
///
/// - `most`: operations of the largest function that is wanted, see [`MOST_OPERATIONS`](crate::dynamics::size::MOST_OPERATIONS)
///
/// # Errors
/// As [`selection::derive`](crate::dynamics::selection::derive()).
pub fn derive(
    model: &Model,
    selection: &[String],
    most: usize,
) -> Result<Vec<Function>, Diagnostics> {
    derive_in_form(model, selection, most, Form::Cheapest, &[])
}

/// As [`derive()`], with the form of large functions chosen.
///
/// - `straight`: functions that are straight-line code in any case
///
/// # Errors
/// As [`derive()`].
pub fn derive_in_form(
    model: &Model,
    selection: &[String],
    most: usize,
    form: Form,
    straight: &[String],
) -> Result<Vec<Function>, Diagnostics> {
    let request = Request {
        names: selection,
        most,
        form,
        straight,
    };
    Ok(selection::derive(model, &request)?.functions)
}

pub(in crate::dynamics) fn derive_quantity(
    model: &Model,
    formulations: &Formulations<'_>,
    quantity: &'static Quantity,
    forms: &Forms<'_>,
) -> Function {
    let Derived { program, arrays } = forms.derive(quantity);
    let mut notes: Vec<String> = quantity.notes.iter().map(|&note| note.to_owned()).collect();
    if arrays.is_some() {
        notes = vec![array_form::NOTE.to_owned()];
    } else {
        notes.extend((quantity.route)(formulations).map(str::to_owned));
    }
    let mut function = described(model, quantity.arguments, quantity.results, program).named(
        quantity.name.to_owned(),
        quantity.summary.to_owned(),
        quantity.equation,
        notes,
    );
    function.arrays = arrays;
    function
        .notes
        .extend(forces::jump_note(model, &function.program));
    function.constants = (quantity.constants)(model, formulations, &function.program);
    function
}

/// The mass matrix is positive definite, unless the description has it otherwise.
pub(in crate::dynamics) fn say_definiteness(found: Definiteness, function: &mut Function) {
    const REGULAR: &str = "positive definite";
    let found = match found {
        Definiteness::Positive => return,
        Definiteness::Semidefinite => "positive semidefinite",
        Definiteness::Indefinite => "indefinite as described",
    };
    for result in &mut function.results {
        *result = result.replace(REGULAR, found);
    }
}

pub(in crate::dynamics) fn derive_frame(
    model: &Model,
    formulations: &Formulations<'_>,
    frame: &Frame,
    quantity: &FrameQuantity,
) -> Function {
    let summary = format!("{} `{}`.", quantity.summary, frame.name);
    let program = assemble(
        model,
        formulations,
        quantity.arguments,
        quantity.results,
        |equations, arguments| {
            let pose = lower_pose(equations.graph, &frame.pose);
            (quantity.build)(equations, arguments, frame.link, &pose)
        },
    );
    described(model, quantity.arguments, quantity.results, program).named(
        frame_name(frame, quantity),
        summary,
        quantity.equation,
        Vec::new(),
    )
}

/// Inputs of a graph for the arguments of a function.
pub(in crate::dynamics) fn arguments_of<'g>(
    graph: &'g Graph,
    model: &Model,
    arguments: &[Argument],
) -> (Arguments<'g>, Vec<InputArray>) {
    let scalars = |argument: Argument| match arguments.iter().position(|&other| other == argument) {
        Some(array) => (0..argument.extent(model).len)
            .map(|index| graph.input(array, index))
            .collect(),
        None => Vec::new(),
    };
    let inputs = arguments.iter().map(|argument| InputArray {
        name: argument.name().to_owned(),
        extent: argument.extent(model),
    });
    let inputs = inputs.collect();
    let arguments = Arguments {
        y: scalars(Coordinates),
        v: scalars(Velocities),
        a: scalars(Accelerations),
        u: scalars(Inputs),
        lambda: scalars(Multipliers),
    };
    (arguments, inputs)
}

/// A function as straight-line code.
pub(in crate::dynamics) fn straight_program(
    model: &Model,
    formulations: &Formulations<'_>,
    quantity: &Quantity,
) -> Program {
    assemble(
        model,
        formulations,
        quantity.arguments,
        quantity.results,
        |equations, arguments| (quantity.build)(equations, arguments),
    )
}

/// Builds the graph of a function and lowers it.
fn assemble(
    model: &Model,
    formulations: &Formulations<'_>,
    arguments: &[Argument],
    results: &[QuantityResult],
    build: impl for<'g> FnOnce(&Equations<'_, 'g>, &Arguments<'g>) -> Vec<Value<'g>>,
) -> Program {
    let graph = Graph::new();
    let (inputs_of_graph, inputs) = arguments_of(&graph, model, arguments);
    let values = build(
        &Equations {
            graph: &graph,
            model,
            formulations,
        },
        &inputs_of_graph,
    );
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

/// A function without a name.
fn described(
    model: &Model,
    arguments: &[Argument],
    results: &[QuantityResult],
    program: Program,
) -> Function {
    Function {
        name: String::new(),
        summary: String::new(),
        equation: String::new(),
        arguments: arguments
            .iter()
            .map(|argument| argument.text(model))
            .collect(),
        results: results
            .iter()
            .map(|(.., meaning)| (*meaning).to_owned())
            .collect(),
        notes: Vec::new(),
        constants: Vec::new(),
        program,
        arrays: None,
    }
}

impl Function {
    fn named(self, name: String, summary: String, equation: &str, notes: Vec<String>) -> Self {
        Self {
            name,
            summary,
            equation: equation.to_owned(),
            notes,
            ..self
        }
    }
}
