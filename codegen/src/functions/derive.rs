//! Conversion of a row of the catalogue to a function with documentation.

use super::assemble::{arguments_in, assemble};
use super::catalogue::{self, Argument, FrameQuantity, Quantity, QuantityResult};
use super::form::{self, Derived, Forms};
use super::function::{FrameFunction, Function};
use crate::dynamics::forces;
use crate::dynamics::search::routes::Formulations;
use crate::kinematics::lower_pose;
use crate::model::{Definiteness, Frame, Model};
use crate::program::Program;

pub(super) fn derive_quantity(
    model: &Model,
    formulations: &Formulations<'_>,
    quantity: &'static Quantity,
    forms: &Forms<'_>,
) -> Function {
    let Derived { program, arrays } = forms.derive(quantity);
    let mut notes: Vec<String> = quantity.notes.iter().map(|&note| note.to_owned()).collect();
    if arrays.is_some() {
        // The first note of a function with loops describes the derivation of its straight-line code.
        let note = arrays.as_ref().map_or(form::NOTE, form::note);
        notes = std::iter::once(note.to_owned()).chain(notes.into_iter().skip(1)).collect();
    } else {
        notes.extend((quantity.route)(formulations).map(str::to_owned));
    }
    let mut function = described(model, quantity.arguments, quantity.results, program).named(
        quantity.name.to_owned(),
        quantity.summary.to_owned(),
        quantity.equation,
        notes,
    );
    catalogue::otherwise(model, quantity.name).for_each(|said| said.describe(&mut function));
    (quantity.describe)(model, &mut function);
    function.arrays = arrays;
    function.notes.extend(forces::jump_note(model, &function.program));
    function.constants = (quantity.constants)(model, formulations, &function.program);
    function
}

/// Replaces "positive definite" in the documentation of results if the mass matrix is not positive definite.
pub(super) fn say_definiteness(found: Definiteness, function: &mut Function) {
    const REGULAR: &str = "positive definite";
    let found = match found {
        Definiteness::Positive => return,
        Definiteness::Semidefinite => "positive semidefinite",
        Definiteness::Indefinite => "indefinite with the masses of the description",
    };
    for result in &mut function.results {
        *result = result.replace(REGULAR, found);
    }
}

pub(super) fn derive_frame(
    model: &Model,
    formulations: &Formulations<'_>,
    frame: &Frame,
    quantity: &FrameQuantity,
) -> Function {
    let summary = format!("{} `{}`.", quantity.summary, frame.name);
    let program =
        assemble(model, formulations, quantity.arguments, quantity.results, |equations, arguments| {
            let pose = lower_pose(equations.graph, &frame.pose);
            (quantity.build)(equations, arguments, frame.link, &pose)
        });
    let of_frame = FrameFunction::new(frame, quantity.kind);
    let mut function = described(model, quantity.arguments, quantity.results, program).named(
        of_frame.name(),
        summary,
        quantity.equation,
        Vec::new(),
    );
    function.frame = Some(of_frame);
    catalogue::otherwise(model, quantity.kind.pattern()).for_each(|said| said.describe(&mut function));
    function
}

/// Makes a function with program and documentation, but without a name.
fn described(
    model: &Model,
    arguments: &[Argument],
    results: &[QuantityResult],
    program: Program,
) -> Function {
    Function {
        name: String::new(),
        frame: None,
        summary: String::new(),
        equation: String::new(),
        arguments: arguments_in(model, arguments).iter().map(|argument| argument.text(model)).collect(),
        results: results.iter().map(|(.., meaning)| (*meaning).to_owned()).collect(),
        notes: Vec::new(),
        constants: Vec::new(),
        program,
        arrays: None,
    }
}

impl Function {
    fn named(self, name: String, summary: String, equation: &str, notes: Vec<String>) -> Self {
        Self { name, summary, equation: equation.to_owned(), notes, ..self }
    }
}
