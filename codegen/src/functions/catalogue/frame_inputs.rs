//! What the catalogue says of robots with forces at frames. Where inputs are such forces, B depends on the
//! coordinates.

use super::motion::INPUT_MATRIX_BY_POSITION;
use super::quantity::Quantity;
use crate::formula::Formula;
use crate::functions::function::Function;
use crate::model::{Model, PointForce};
use crate::wording;

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
    if function.name == "potential_energy" && !model.point_forces.is_empty() {
        describe_energy(model, function);
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

/// Which of the forces between frames are in the potential energy.
fn describe_energy(model: &Model, function: &mut Function) {
    let forces = |wanted: fn(Option<&Formula>) -> bool| -> Vec<&PointForce> {
        model.point_forces.iter().filter(|force| wanted(force.law.energy().as_ref())).collect()
    };
    // Dampers have neither energy nor something that is missing.
    let known = forces(|energy| energy.is_some_and(|energy| !energy.is_zero()));
    let unknown = forces(|energy| energy.is_none());
    let named = |forces: &[&PointForce]| wording::list(forces.iter().map(|force| force.name.as_str()));
    if !known.is_empty() {
        "Potential energy of gravity and of forces between frames.".clone_into(&mut function.summary);
        "V = −g · Σ m c + Σ ∫ F(l, l̇ = 0) dl".clone_into(&mut function.equation);
        "energy [J], that of gravity zero with the masses at the height of the base frame; springs of joints not included"
            .clone_into(&mut function.results[0]);
        function.notes.push(format!(
            "Contained are the laws of {}, at standstill. A summand c (l − l₀)ⁿ has no energy at l₀, another polynomial none \
             at l = 0.",
            named(&known)
        ));
    }
    if !unknown.is_empty() {
        function.notes.push(format!(
            "Not contained are the laws of {}, which are no polynomials of the distance.",
            named(&unknown)
        ));
    }
}
