//! The functions that can be generated: one row each, with what their documentation says.
//!
//! `quantity` is the vocabulary, `motion`, `frames`, `regressors`, `hessian` and `reactions` hold the rows.

mod driven;
mod frame_inputs;
mod frames;
mod hessian;
mod load_friction;
mod momentum;
mod motion;
mod quantity;
mod quaternions;
mod reactions;
mod regressors;
mod wrenches;

pub(super) use frames::{FRAME_QUANTITIES, frame_name};
pub(super) use quantity::vector;
pub use quantity::{Argument, Quantity, Value};
pub(super) use quantity::{BuildLoops, Estimate, FrameQuantity, Loops, QuantityResult};

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dynamics::forces;
use crate::functions::composition::Composition;
use crate::functions::function::Function;
use crate::model::Model;
use motion::{FRICTION_BY_POSITION, QUANTITIES};

/// Says what is otherwise of a function in a robot where the rows of the catalogue are not the whole truth.
pub(super) fn describe(model: &Model, function: &mut Function) {
    driven::describe(model, function);
    load_friction::describe(model, function);
    frame_inputs::describe(model, function);
    quaternions::describe(model, function);
}

/// Every function but those of named frames, in the order of the generated module.
pub fn quantities() -> impl Iterator<Item = &'static Quantity> {
    QUANTITIES.iter().chain(regressors::QUANTITIES)
}

/// [`quantities()`] with the rows of friction that a model needs: where a friction law depends on the
/// position of its joint, or inputs act at frames, they take y too.
fn quantities_of(model: &Model) -> impl Iterator<Item = &'static Quantity> {
    let by_position: &[Quantity] = match forces::friction_depends_on_position(model) {
        true => FRICTION_BY_POSITION,
        false => &[],
    };
    let of_the_load: &[Quantity] = match load_friction::is_in(model) {
        true => load_friction::QUANTITIES,
        false => &[],
    };
    let quantities = quantities().map(move |quantity| {
        let mut rows = by_position.iter().chain(frame_inputs::rows(model)).chain(quaternions::rows(model));
        let replacement = rows.find(|row| row.name == quantity.name);
        replacement.unwrap_or(quantity)
    });
    let of_wrenches: &[Quantity] = match model.wrenches.is_empty() {
        true => &[],
        false => wrenches::QUANTITIES,
    };
    quantities.chain(of_the_load).chain(of_wrenches)
}

/// The quantities of a model, and those that are derived where they are asked for by name.
pub(super) fn all_quantities(model: &Model) -> impl Iterator<Item = &'static Quantity> {
    quantities_of(model).chain(ON_REQUEST).chain(driven::rows(model))
}

/// Tells whether a function is derived only where it is asked for by name.
pub(super) fn is_on_request(name: &str) -> bool {
    ON_REQUEST.iter().chain(driven::QUANTITIES).any(|quantity| quantity.name == name)
}

/// Functions that are derived where they are asked for by name: few need them.
const ON_REQUEST: &[Quantity] = {
    let [center, jacobian, matrix, momentum] = momentum::QUANTITIES;
    &[hessian::QUANTITY, reactions::QUANTITY, center, jacobian, matrix, momentum]
};

/// Tells whether a function may be written as loops over joints.
pub(crate) fn may_be_loops(name: &str) -> bool {
    row(name).is_some_and(|quantity| quantity.loops.is_some())
}

/// The row of a function of whatever robot.
pub(super) fn row(name: &str) -> Option<&'static Quantity> {
    all().find(|row| row.name == name)
}

/// The rows of every function of whatever robot.
fn all() -> impl Iterator<Item = &'static Quantity> {
    let of_some = load_friction::QUANTITIES.iter().chain(wrenches::QUANTITIES).chain(driven::QUANTITIES);
    quantities().chain(ON_REQUEST).chain(of_some)
}

/// Tells whether other functions may call a function.
pub(super) fn is_called(name: &str) -> bool {
    quantities().any(|row| matches!(row.loops, Some(Loops::Affine { called }) if called == name))
}

/// Tells whether a function differentiates friction by the velocity.
pub(crate) fn differentiates_friction(name: &str) -> bool {
    row(name).is_some_and(|row| row.differentiates_friction)
}

/// Names of all functions of a model, in the order of the generated module.
pub fn names(model: &Model) -> Vec<String> {
    let quantities = all_quantities(model).map(|quantity| quantity.name.to_owned());
    let frames = model.frames.iter().flat_map(|frame| FRAME_QUANTITIES.iter().map(|q| frame_name(frame, q)));
    let compositions = Composition::ALL.iter().map(|each| each.name().to_owned());
    quantities.chain(frames).chain(compositions).collect()
}

/// The selected functions that call others; an empty selection means all.
pub fn compositions(selection: &[String]) -> Vec<Composition> {
    let is_selected =
        |each: &Composition| selection.is_empty() || selection.iter().any(|name| name == each.name());
    Composition::ALL.into_iter().filter(is_selected).collect()
}

/// # Errors
/// `unknown-function` for each name that the model does not have; `frames` stands for all of named frames.
pub(crate) fn check_names(model: &Model, selection: &[String]) -> Result<(), Diagnostics> {
    let known = names(model);
    let unknown = selection.iter().filter(|name| *name != "frames" && !known.contains(name));
    let problems: Vec<_> = unknown
        .map(|name| {
            Diagnostic::error("unknown-function", format!("there is no function `{name}`"))
                .help(format!("choose from: {}, frames", known.join(", ")))
        })
        .collect();
    if problems.is_empty() { Ok(()) } else { Err(Diagnostics::new(problems)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::FUNCTIONS;

    #[test]
    fn descriptions_may_ask_for_every_function() {
        let names = all().map(|quantity| quantity.name);
        let composed = Composition::ALL.map(Composition::name);
        let mut names: Vec<&str> = names.chain(composed).chain(["frames"]).collect();
        let mut known = FUNCTIONS.to_vec();
        names.sort_unstable();
        known.sort_unstable();
        assert_eq!(names, known);
    }
}
