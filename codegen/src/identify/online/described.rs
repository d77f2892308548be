//! Inverse dynamics and friction of the described robot, for the comparison with measured efforts.

use super::super::parameters::{derive, free, result};
use crate::diagnostic::Diagnostics;
use crate::function_names;
use crate::functions::function::Function;
use crate::model::Model;
use gelenk_formula::Formula;

/// Inverse dynamics and friction torques of a described robot, evaluated by an interpreter. The results have
/// the same bits as those of the generated module.
#[derive(Debug)]
pub struct DescribedForces {
    functions: [Function; 2],
    /// Function for the load-dependent friction per unit of load; `None` if the robot has no such friction.
    shares: Option<Function>,
    free: Vec<f64>,
}

impl DescribedForces {
    /// Derives the inverse dynamics and the friction of the robot.
    ///
    /// - `without_gravity`: whether gravity is left out, for logs whose efforts do not include the weight
    ///
    /// # Errors
    /// The errors are those of [`derive_in_form`](crate::functions::selection::derive_in_form).
    pub fn new(model: &Model, without_gravity: bool) -> Result<Self, Diagnostics> {
        let mut model = model.clone();
        if without_gravity {
            model.gravity = [0.0; 3].map(Formula::Number);
        }
        let has_loads = model.joints().any(|joint| !joint.load_friction.is_empty());
        let shares = has_loads.then(|| derive(&model, [function_names::LOAD_FRICTION]));
        Ok(Self {
            functions: derive(&model, [function_names::INVERSE_DYNAMICS, function_names::FRICTION_TORQUES])?,
            shares: shares.transpose()?.map(|[function]| function),
            free: free(&model),
        })
    }

    /// Returns three vectors with an entry for each joint:
    ///
    /// - forces of the inverse dynamics including friction, in N·m or N
    /// - friction without its load-dependent part, in N·m or N
    /// - load-dependent friction per unit of load. The load is the force of the drive without all friction.
    ///
    /// Arguments:
    ///
    /// - `y`, `v`, `a`: positions, velocities and accelerations of all joints
    #[must_use]
    pub fn at(&self, y: &[f64], v: &[f64], a: &[f64]) -> [Vec<f64>; 3] {
        let [inverse_dynamics, friction] = &self.functions;
        // Friction functions have positions as arguments if a law depends on them.
        let law = |function: &Function| {
            let arguments = &[y, v][2 - function.program.inputs.len()..];
            result(function, arguments, &self.free)
        };
        let shares = self.shares.as_ref().map_or_else(|| vec![0.0; v.len()], law);
        [result(inverse_dynamics, &[y, v, a], &self.free), law(friction), shares]
    }
}
