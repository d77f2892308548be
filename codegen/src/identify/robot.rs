//! A described robot as identification asks for it: its regressor, evaluated by the interpreter.

use gelenk_identification::robot::{JointLimits, Robot};

use crate::diagnostic::Diagnostics;
use crate::dynamics::parameters::regressor::{PER_LINK, drives_with_rotor, parameter_names};
use crate::functions::form::Form;
use crate::functions::function::Function;
use crate::functions::selection::derive_in_form;
use crate::functions::size::MOST_OPERATIONS;
use crate::model::{Drive, Joint, JointKind, Model};
use crate::program::interpret::{Functions, interpret};

/// Functions of a described robot that identification calls, evaluated without a compiler.
///
/// Its parameters are those of `INERTIAL_PARAMETER_NAMES`, and behind them the inertia that each drive without
/// a described rotor adds to its revolute joint, `reflected_inertia_NAME` [kg m²]: a torque `J ÿ` there. Its
/// described value is 0.
#[derive(Debug)]
pub struct InterpretedRobot {
    model: Model,
    functions: [Function; 4],
    /// Described values of the free parameters.
    free: Vec<f64>,
    /// Revolute joints, by coordinate, whose drive has no rotor.
    without_rotor: Vec<usize>,
}

const FUNCTIONS: [&str; 4] =
    ["inertial_regressor", "inverse_dynamics", "inertial_parameters", "input_matrix"];

impl InterpretedRobot {
    /// Derives the functions of a model; its friction is left out.
    ///
    /// # Errors
    /// As [`derive_in_form`]: a robot whose functions cannot be generated.
    pub fn new(model: &Model) -> Result<Self, Diagnostics> {
        let mut model = model.clone();
        for joint in model.links.iter_mut().filter_map(|link| link.joint.as_mut()) {
            joint.friction.clear();
        }
        let names = FUNCTIONS.map(str::to_owned);
        let all = derive_in_form(&model, &names, MOST_OPERATIONS, Form::Straight, &names)?;
        let function = |name: &str| {
            let found = all.iter().find(|function| function.name == name).cloned();
            found.unwrap_or_else(|| unreachable!("{name} was asked for by name, and no error was returned"))
        };
        let functions = FUNCTIONS.map(function);
        let has_rotor =
            |coordinate: usize| drives_with_rotor(&model).any(|drive| drive.coordinate == Some(coordinate));
        let turns = |coordinate: usize| {
            model.joints().nth(coordinate).is_some_and(|joint| joint.kind != JointKind::Prismatic)
        };
        let driven = model.inputs().filter_map(|drive| drive.coordinate);
        let without_rotor = driven.filter(|joint| turns(*joint) && !has_rotor(*joint)).collect();
        let free = model.parameters.iter().map(|parameter| parameter.default).collect();
        Ok(Self { model, functions, free, without_rotor })
    }

    /// The model, without friction.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// What each parameter behind those of the bodies is, in their order.
    #[must_use]
    pub fn drive_parameters(&self) -> Vec<DriveParameter<'_>> {
        let rotors = drives_with_rotor(&self.model).map(DriveParameter::Rotor);
        let drive =
            |coordinate: &usize| self.model.inputs().find(|drive| drive.coordinate == Some(*coordinate));
        let others = self.without_rotor.iter().filter_map(drive).map(DriveParameter::ReflectedInertia);
        rotors.chain(others).collect()
    }

    fn columns(&self) -> usize {
        PER_LINK * self.bodies() + drives_with_rotor(&self.model).count()
    }

    fn call(&self, index: usize, inputs: &[&[f64]]) -> Vec<f64> {
        let results = interpret(&self.functions[index].program, inputs, &self.free, &Functions::EMBEDDED);
        let results = results.unwrap_or_else(|error| panic!("{}: {error}", FUNCTIONS[index]));
        results.into_iter().next().unwrap_or_default()
    }
}

/// A parameter of a drive.
#[derive(Debug, Clone, Copy)]
pub enum DriveParameter<'a> {
    /// The axial inertia of the drive's rotor, J_R.
    Rotor(&'a Drive),
    /// The inertia that a drive without a described rotor adds to its joint.
    ReflectedInertia(&'a Drive),
}

impl Robot for InterpretedRobot {
    fn joint_names(&self) -> Vec<String> {
        self.model.joints().map(|joint| joint.name.clone()).collect()
    }

    fn input_names(&self) -> Vec<String> {
        self.model.inputs().map(|drive| drive.name.clone()).collect()
    }

    fn position_units(&self) -> Vec<&'static str> {
        self.model.joints().map(|joint| joint.kind.unit()).collect()
    }

    fn limits(&self) -> Vec<JointLimits> {
        let limits = |joint: &Joint| JointLimits {
            position: joint.limits.position.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]),
            velocity: joint.limits.velocity.unwrap_or(f64::INFINITY),
            effort: joint.limits.peak_effort.or(joint.limits.effort).unwrap_or(f64::INFINITY),
        };
        self.model.joints().map(limits).collect()
    }

    fn parameter_names(&self) -> Vec<String> {
        let described = parameter_names(&self.model);
        let joints = self.joint_names();
        let others = self.without_rotor.iter().map(|joint| format!("reflected_inertia_{}", joints[*joint]));
        described.into_iter().chain(others).collect()
    }

    fn parameters(&self) -> Vec<f64> {
        let mut values = self.call(2, &[]);
        values.resize(values.len() + self.without_rotor.len(), 0.0);
        values
    }

    fn bodies(&self) -> usize {
        self.model.coordinates.len()
    }

    fn input_matrix(&self) -> Vec<f64> {
        self.call(3, &[])
    }

    fn inertial_regressor(&self, y: &[f64], v: &[f64], a: &[f64], regressor: &mut [f64]) {
        let described = self.call(0, &[y, v, a]);
        let from = self.columns();
        let width = from + self.without_rotor.len();
        for (row, (to, from)) in
            regressor.chunks_exact_mut(width).zip(described.chunks_exact(from)).enumerate()
        {
            let (known, others) = to.split_at_mut(from.len());
            known.copy_from_slice(from);
            for (entry, joint) in others.iter_mut().zip(&self.without_rotor) {
                *entry = if *joint == row { a[row] } else { 0.0 };
            }
        }
    }

    fn rigid_forces(&self, y: &[f64], v: &[f64], a: &[f64], forces: &mut [f64]) {
        forces.copy_from_slice(&self.call(1, &[y, v, a]));
    }
}
