//! Inertial parameters of a model, computed by the interpreter.

use crate::diagnostic::Diagnostics;
use crate::functions::form::Form;
use crate::functions::function::Function;
use crate::functions::selection::derive_in_form;
use crate::functions::size::MOST_OPERATIONS;
use crate::model::Model;
use crate::program::interpret::interpret;

/// Returns the inertial parameters of a model with the values of the description.
pub(super) fn parameters(model: &Model) -> Result<Vec<f64>, Diagnostics> {
    let name = ["inertial_parameters".to_owned()];
    let functions = derive_in_form(model, &name, MOST_OPERATIONS, Form::Straight, &name)?;
    let free: Vec<f64> = model.parameters.iter().map(|parameter| parameter.default).collect();
    Ok(functions.first().map_or(Vec::new(), |function| result(function, &[], &free)))
}

/// Returns the first result of a function.
pub(super) fn result(function: &Function, inputs: &[&[f64]], free: &[f64]) -> Vec<f64> {
    let results = interpret(&function.program, inputs, free);
    let results = results.unwrap_or_else(|error| {
        unreachable!("{} failed on states of the model from which it was derived: {error}", function.name)
    });
    results.into_iter().next().unwrap_or_default()
}
