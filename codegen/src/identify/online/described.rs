//! Inverse dynamics and friction of the described robot.

use super::super::parameters::result;
use crate::diagnostic::Diagnostics;
use crate::function_names;
use crate::functions::form::Form;
use crate::functions::function::Function;
use crate::functions::selection::derive_in_form;
use crate::functions::size::MOST_OPERATIONS;
use crate::model::Model;
use gelenk_formula::Formula;

/// Inverse dynamics and friction torques of a robot. An interpreter evaluates them. The results have the
/// same bits as those of the generated module.
#[derive(Debug)]
pub struct DescribedForces {
    functions: [Function; 2],
    free: Vec<f64>,
}

impl DescribedForces {
    /// Derives the inverse dynamics and the friction torques of the robot.
    ///
    /// - `without_gravity`: whether gravity is left out, for logs whose efforts do not include the weight
    ///
    /// # Errors
    /// The errors are those of [`derive_in_form`].
    pub fn new(model: &Model, without_gravity: bool) -> Result<Self, Diagnostics> {
        let mut model = model.clone();
        if without_gravity {
            model.gravity = [0.0; 3].map(Formula::Number);
        }
        let names = [function_names::INVERSE_DYNAMICS, function_names::FRICTION_TORQUES].map(str::to_owned);
        let functions = derive_in_form(&model, &names, MOST_OPERATIONS, Form::Straight, &names)?;
        let function = |name: &String| {
            let found = functions.iter().find(|function| function.name == *name).cloned();
            found.unwrap_or_else(|| unreachable!("{name} was asked for by name, and no error was returned"))
        };
        Ok(Self {
            functions: names.each_ref().map(function),
            free: model.parameters.iter().map(|parameter| parameter.default).collect(),
        })
    }

    /// Returns the generalized forces of the inverse dynamics including friction, and the friction alone,
    /// both in N·m or N.
    ///
    /// - `y`, `v`, `a`: positions, velocities and accelerations of all joints
    #[must_use]
    pub fn at(&self, y: &[f64], v: &[f64], a: &[f64]) -> [Vec<f64>; 2] {
        let [inverse_dynamics, friction] = &self.functions;
        // The friction function has positions as arguments if a law depends on them.
        let arguments = [y, v];
        let of_friction = &arguments[2 - friction.program.inputs.len()..];
        [result(inverse_dynamics, &[y, v, a], &self.free), result(friction, of_friction, &self.free)]
    }
}
