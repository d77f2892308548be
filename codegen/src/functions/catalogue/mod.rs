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
mod otherwise;
mod quantity;
mod quaternions;
mod reactions;
mod regressors;
mod wrenches;

pub(super) use frames::FRAME_QUANTITIES;
pub(super) use otherwise::Otherwise;
pub(super) use quantity::vector;
pub use quantity::{Argument, Quantity, Value};
pub(super) use quantity::{BuildLoops, Estimate, FrameQuantity, Loops, QuantityResult};

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dynamics::forces;
use crate::dynamics::load_friction::is_there as has_load_friction;
use crate::function_names::{GROUPS, select_all};
use crate::functions::composition::Composition;
use crate::functions::function::FrameFunction;
use crate::model::Model;
use motion::{FRICTION_BY_POSITION, INPUT_MATRIX_BY_POSITION, LINEARIZE_ON_TANGENT, QUANTITIES};

/// Every function but those of named frames, in the order of the generated module.
pub fn quantities() -> impl Iterator<Item = &'static Quantity> {
    QUANTITIES.iter().chain(regressors::QUANTITIES)
}

/// [`quantities()`] with the rows that a model adds or replaces.
fn quantities_of(model: &Model) -> impl Iterator<Item = &'static Quantity> {
    let depends_on_position = forces::friction_depends_on_position(model);
    let friction = rows_if(depends_on_position, FRICTION_BY_POSITION);
    let of_friction = rows_if(depends_on_position, &regressors::FRICTION_BY_POSITION);
    let at_frames = rows_if(model.inputs_depend_on_position(), INPUT_MATRIX_BY_POSITION);
    let on_tangent = rows_if(!model.quaternion_joints.is_empty(), LINEARIZE_ON_TANGENT);
    let quantities = quantities().map(move |quantity| {
        let mut rows = friction.iter().chain(of_friction).chain(at_frames).chain(on_tangent);
        rows.find(|row| row.name == quantity.name).unwrap_or(quantity)
    });
    let of_inputs = rows_if(model.inputs_depend_on_position(), frame_inputs::QUANTITIES);
    let of_the_load = rows_if(has_load_friction(model), load_friction::QUANTITIES);
    quantities
        .chain(of_inputs)
        .chain(of_the_load)
        .chain(rows_if(!model.wrenches.is_empty(), wrenches::QUANTITIES))
}

fn rows_if(are_there: bool, rows: &'static [Quantity]) -> &'static [Quantity] {
    if are_there { rows } else { &[] }
}

/// The quantities of a model, and those that are derived if they are asked for by name.
pub(super) fn all_quantities(model: &Model) -> impl Iterator<Item = &'static Quantity> {
    let of_driven = rows_if(!model.driven.is_empty(), driven::QUANTITIES);
    quantities_of(model).chain(ON_REQUEST).chain(of_driven)
}

/// Whether a function is derived only if it is asked for by name.
pub(super) fn is_on_request(name: &str) -> bool {
    ON_REQUEST.iter().chain(driven::QUANTITIES).any(|quantity| quantity.name == name)
}

/// Functions that are derived if they are asked for by name: few need them.
const ON_REQUEST: &[Quantity] = {
    let [center, jacobian, matrix, momentum] = momentum::QUANTITIES;
    &[hessian::QUANTITY, reactions::QUANTITY, center, jacobian, matrix, momentum]
};

/// Whether a function may be written as loops over joints.
pub(crate) fn may_be_loops(name: &str) -> bool {
    row(name).is_some_and(|quantity| quantity.loops.is_some())
}

/// The row of a function of whatever robot.
pub(super) fn row(name: &str) -> Option<&'static Quantity> {
    all().find(|row| row.name == name)
}

/// The rows of every function of whatever robot.
fn all() -> impl Iterator<Item = &'static Quantity> {
    let of_some = frame_inputs::QUANTITIES
        .iter()
        .chain(load_friction::QUANTITIES)
        .chain(wrenches::QUANTITIES)
        .chain(driven::QUANTITIES);
    quantities().chain(ON_REQUEST).chain(of_some)
}

/// Whether a function differentiates friction by the velocity.
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

/// The selected functions that call others.
pub fn compositions(selection: &[String]) -> Vec<Composition> {
    let is_selected =
        |each: &Composition| select_all(selection) || selection.iter().any(|name| name == each.name());
    Composition::ALL.into_iter().filter(is_selected).collect()
}

/// # Errors
/// `unknown-function` for each name that the model does not have, other than [`GROUPS`].
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
