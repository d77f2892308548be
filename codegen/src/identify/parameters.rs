//! Functions of a model, evaluated by the interpreter.

use crate::diagnostic::Diagnostics;
use crate::functions::form::Form;
use crate::functions::function::Function;
use crate::functions::selection::derive_in_form;
use crate::functions::size::MOST_OPERATIONS;
use crate::model::Model;
use crate::program::interpret::interpret;

/// Derives functions of a model for the interpreter, in the order of their names.
pub(super) fn derive<const N: usize>(model: &Model, names: [&str; N]) -> Result<[Function; N], Diagnostics> {
    let names = names.map(str::to_owned);
    let functions = derive_in_form(model, &names, MOST_OPERATIONS, Form::Straight, &names)?;
    Ok(names.map(|name| {
        let found = functions.iter().find(|function| function.name == name).cloned();
        found.unwrap_or_else(|| {
            unreachable!("{name} was requested, but not derived, although no error was returned")
        })
    }))
}

/// Returns the described values of the free parameters of a model.
pub(super) fn free(model: &Model) -> Vec<f64> {
    model.parameters.iter().map(|parameter| parameter.default).collect()
}

/// Returns the first result of a function.
pub(super) fn result(function: &Function, inputs: &[&[f64]], free: &[f64]) -> Vec<f64> {
    let results = interpret(&function.program, inputs, free);
    let results = results.unwrap_or_else(|error| {
        unreachable!("{} failed on states of the model from which it was derived: {error}", function.name)
    });
    results.into_iter().next().unwrap_or_default()
}
