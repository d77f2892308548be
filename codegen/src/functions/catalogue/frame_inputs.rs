//! What the catalogue says of robots with forces at frames. Where inputs are such forces, B depends on the
//! coordinates.

use super::motion::INPUT_MATRIX_BY_POSITION;
use super::quantity::Quantity;
use crate::functions::function::Function;
use crate::model::Model;

/// The rows that replace those of the same name.
pub fn rows(model: &Model) -> &'static [Quantity] {
    match model.inputs_depend_on_position() {
        true => INPUT_MATRIX_BY_POSITION,
        false => &[],
    }
}

/// Says what is otherwise.
pub fn describe(model: &Model, function: &mut Function) {
    let has_frame_forces = !model.point_forces.is_empty() || !model.wrenches.is_empty();
    if function.name == "joint_wrenches" && (has_frame_forces || model.inputs_depend_on_position()) {
        let note = "Forces at frames beyond a joint, those of springs, inputs and wrenches there, are part of its row: what the \
                    joint itself transmits is the row less these.";
        function.notes.push(note.to_owned());
    }
    if !model.inputs_depend_on_position() {
        return;
    }
    match function.name.as_str() {
        "forward_dynamics_derivatives" => {
            "∂ÿ = −M⁻¹ ∂(M ÿ + k − q − B(y) u), ∂ÿ/∂(B u) = M⁻¹".clone_into(&mut function.equation);
        }
        "inverse_dynamics_hessian" => {
            let note = "The constraint `M ÿ + k − q = B(y) u` with multipliers λ adds these blocks to the Hessian of the \
                        Lagrangian, and those of `−λᵀ B(y) u`, which are not in here.";
            function.notes = vec![note.to_owned()];
        }
        _ => {}
    }
}
