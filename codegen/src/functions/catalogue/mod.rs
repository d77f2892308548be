//! The catalogue of functions. Each row has the documentation and the derivation of one generated function.
//!
//! `quantity` defines the type of a row. `motion`, `frames`, `regressors`, `hessian`, `momentum` and
//! `reactions` contain the rows. [`KINDS`] is the table of kinds of robots, with their additional rows and with
//! functions that differ or are missing.

mod driven;
mod frame_inputs;
mod frames;
mod hessian;
mod kind;
mod kinds;
mod load_friction;
mod momentum;
mod motion;
mod quantity;
mod reactions;
mod regressors;
mod wrenches;

pub(super) use frames::FRAME_QUANTITIES;
pub use kind::{ACADOS, CASADI, CLOSED_FORMS, EXPORT, IDENTIFICATION, LOOPS, PRODUCTS};
pub use kind::{Difference, Kind, Otherwise, Product};
pub use kinds::KINDS;
pub(crate) use kinds::otherwise;
pub(super) use kinds::{Refusal, Refusals};
pub(super) use quantity::vector;
pub use quantity::{Argument, Quantity, Value};
pub(super) use quantity::{BuildLoops, Estimate, FrameQuantity, Loops, QuantityResult};

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::function_names::{GROUPS, select_all};
use crate::functions::composition::Composition;
use crate::functions::function::FrameFunction;
use crate::model::Model;
use motion::QUANTITIES;

/// Functions of robots without special properties, in the order of the generated module. Functions of named
/// frames and functions that are generated only on request (by name) are not included.
pub fn quantities() -> impl Iterator<Item = &'static Quantity> {
    QUANTITIES.iter().chain(regressors::QUANTITIES)
}

/// Functions of a model in the catalogue. Functions that are generated only on request are last.
pub(super) fn all_quantities(model: &Model) -> impl Iterator<Item = &'static Quantity> {
    let of_model = |row: &'static Quantity| {
        let mut others = KINDS.iter().flat_map(|kind| kind.replaces.iter().map(move |row| (kind, row)));
        let other = others.find(|(kind, other)| other.name == row.name && kind.includes(model));
        other.map_or(row, |(_, other)| other)
    };
    let added = KINDS.iter().flat_map(move |kind| kind.adds.iter().filter(move |_| kind.includes(model)));
    let (on_request, added): (Vec<_>, Vec<_>) = added.partition(|row| is_on_request(row.name));
    quantities().map(of_model).chain(added).chain(ON_REQUEST).chain(on_request)
}

/// Whether a function is generated only if it is requested by name.
pub(super) fn is_on_request(name: &str) -> bool {
    ON_REQUEST.iter().chain(driven::QUANTITIES).any(|row| row.name == name)
}

/// Functions that are generated only if they are requested by name, because few robots need them.
const ON_REQUEST: &[Quantity] = {
    let [center, jacobian, matrix, momentum] = momentum::QUANTITIES;
    &[hessian::QUANTITY, reactions::QUANTITY, center, jacobian, matrix, momentum]
};

/// Whether a function may be written as loops over joints.
pub(crate) fn may_be_loops(name: &str) -> bool {
    row(name).is_some_and(|quantity| quantity.loops.is_some())
}

/// The catalogue's row of a function that some robots may have; `None` if the name is unknown.
pub(super) fn row(name: &str) -> Option<&'static Quantity> {
    all().find(|row| row.name == name)
}

/// The catalogue's rows of all functions that robots may have.
fn all() -> impl Iterator<Item = &'static Quantity> {
    quantities().chain(ON_REQUEST).chain(KINDS.iter().flat_map(|kind| kind.adds))
}

/// Whether a function contains the derivative of friction with respect to the velocity.
pub(crate) fn differentiates_friction(name: &str) -> bool {
    row(name).is_some_and(|row| row.differentiates_friction)
}

/// Names of all functions of a model, in the order of the generated module.
pub fn names(model: &Model) -> Vec<String> {
    let quantities = all_quantities(model).map(|quantity| quantity.name.to_owned());
    let of_frame = |frame| FRAME_QUANTITIES.iter().map(move |row| FrameFunction::new(frame, row.kind).name());
    let frames = model.frames.iter().flat_map(of_frame);
    let compositions = Composition::ALL.iter().map(|each| each.name().to_owned());
    quantities.chain(frames).chain(compositions).collect()
}

/// The selected functions that call other generated functions.
pub fn compositions(selection: &[String]) -> Vec<Composition> {
    let is_selected =
        |each: &Composition| select_all(selection) || selection.iter().any(|name| name == each.name());
    Composition::ALL.into_iter().filter(is_selected).collect()
}

/// Checks that a model has the selected functions.
///
/// Returns the error `unknown-function` for each name that is neither a function of the model nor one of
/// [`GROUPS`].
pub(crate) fn check_names(model: &Model, selection: &[String]) -> Result<(), Diagnostics> {
    let known = names(model);
    let unknown = selection.iter().filter(|name| !GROUPS.contains(&name.as_str()) && !known.contains(name));
    let problems: Vec<_> = unknown
        .map(|name| {
            Diagnostic::error("unknown-function", format!("there is no function `{name}`"))
                .help(format!("choose from: {}, frames, all", known.join(", ")))
        })
        .collect();
    if problems.is_empty() { Ok(()) } else { Err(Diagnostics::new(problems)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn descriptions_may_ask_for_every_function() {
        let names = all().map(|quantity| quantity.name);
        let composed = Composition::ALL.map(Composition::name);
        let mut names: Vec<&str> = names.chain(composed).chain(GROUPS).collect();
        let mut known: Vec<&str> = crate::function_names::listed().collect();
        names.sort_unstable();
        known.sort_unstable();
        assert_eq!(names, known);
    }
}
