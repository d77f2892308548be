//! The robot model for the identification. An interpreter evaluates its regressor.

use std::sync::OnceLock;

use gelenk_formula::Formula;
use gelenk_identification::pose::QuaternionJoint;
use gelenk_identification::robot::{FollowerLimits, JointLimits, Robot, TorqueSpeedLine};
use gelenk_identification::shafts::{JointTerm, Shaft};

use super::parameters::{derive, free, result};
use super::shafts::{joint_terms, shaft_rotor, shafts, shared_drives};
use crate::diagnostic::Diagnostics;
use crate::dynamics::parameters::regressor::parameter_names;
use crate::functions::catalogue::IDENTIFICATION;
use crate::functions::function::Function;
use crate::model::{
    Actuator, Dependent, Drive, FrictionTerm, Input, Joint, LimitedInput, Model, Motion, Parameter,
    QuaternionKind,
};

/// Functions of a described robot that the identification calls. An interpreter evaluates them, so no
/// compiler is needed. The inertial parameters are those of `INERTIAL_PARAMETER_NAMES`.
#[derive(Debug)]
pub struct InterpretedRobot {
    model: Model,
    regressor: Function,
    inverse_dynamics: Function,
    parameters: Vec<f64>,
    input_matrix: Vec<f64>,
    /// Regressor W of the inertial parameters, with three additional free parameters for gravity. It is
    /// derived at the first use.
    at_rest: OnceLock<Option<Function>>,
    /// Function for the input matrix B(y); `None` if no input acts at a frame.
    input_matrix_at: Option<Function>,
    /// For each joint, whether it is moved from outside, so that its force is not measured.
    unmeasured: Vec<bool>,
    /// Shafts of drives whose friction is identified.
    shafts: Vec<Shaft>,
    /// Described friction of the joints whose equations in the fit are replaced by those of drives' shafts.
    joint_terms: Vec<(JointTerm, FrictionTerm)>,
    /// Described friction for each row of the fit, which belongs to a joint or a shaft.
    friction: Vec<Vec<FrictionTerm>>,
    /// Described values of the free parameters.
    free: Vec<f64>,
}

/// Choices about a robot before the identification.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RobotChoices {
    /// Names of joints that are moved from outside. Logs contain the motion of these joints, but not their
    /// forces.
    pub unmeasured: Vec<String>,
    /// Whether friction is identified only at joints. Friction of the shafts of drives that act on several
    /// joints then stays as described.
    pub friction_at_joints: bool,
}

impl InterpretedRobot {
    /// Creates the robot with default choices, see [`Self::with`].
    ///
    /// # Errors
    /// The errors are those of [`Self::with`].
    pub fn new(model: &Model) -> Result<Self, Diagnostics> {
        Self::with(model, &RobotChoices::default())
    }

    /// Creates the robot and derives its equations of motion. The equations do not contain the friction that
    /// is identified. They contain the friction that is not identified:
    ///
    /// - friction of spherical and floating joints
    /// - friction of joints that follow other joints, because the written description does not replace their
    ///   law
    /// - friction of the shafts of drives, if [`RobotChoices::friction_at_joints`] is set or the shaft
    ///   replaces no joint in the fit
    ///
    /// # Errors
    /// The errors are those of [`derive_in_form`](crate::functions::selection::derive_in_form). The error is `driven-joint` if joints have a prescribed
    /// motion.
    pub fn with(model: &Model, choices: &RobotChoices) -> Result<Self, Diagnostics> {
        IDENTIFICATION.check(model)?;
        let mut model = model.clone();
        let free = free(&model);
        let shafts =
            if choices.friction_at_joints { Vec::new() } else { shafts(&model, &choices.unmeasured, &free) };
        let joint_terms = joint_terms(&model, &shafts, &free);
        let friction = described_friction(&model, &shafts);
        let is_shaft = |name: &str| shafts.iter().any(|shaft| shaft.name == name);
        let rubbing = model.drives.iter_mut().filter(|drive| is_shaft(&drive.name));
        rubbing.for_each(|drive| drive.friction.clear());
        let attitudes: Vec<usize> =
            model.quaternion_joints.iter().flat_map(|joint| joint.coordinates()).collect();
        let kept: Vec<usize> = attitudes.iter().map(|coordinate| model.coordinates[*coordinate]).collect();
        let links = model.links.iter_mut().enumerate().filter(|(link, _)| !kept.contains(link));
        let joints = links.filter_map(|(_, link)| link.joint.as_mut());
        for joint in joints.filter(|joint| !matches!(joint.motion, Motion::Follower(_))) {
            joint.friction.clear();
            joint.load_friction.clear();
        }
        let input_matrix_at = (!model.force_inputs.is_empty()).then(|| derive(&model, ["input_matrix"]));
        let input_matrix_at = input_matrix_at.transpose()?.map(|[function]| function);
        // The forces of these inputs depend on the positions.
        let frame_inputs = std::mem::take(&mut model.force_inputs);
        let [regressor, inverse_dynamics, parameters, input_matrix] = derive(
            &model,
            ["inertial_regressor", "inverse_dynamics", "inertial_parameters", "input_matrix"],
        )?;
        Ok(Self {
            unmeasured: model.joints().map(|joint| choices.unmeasured.contains(&joint.name)).collect(),
            shafts,
            joint_terms,
            friction,
            parameters: result(&parameters, &[], &free),
            input_matrix: with_zero_columns(&result(&input_matrix, &[], &free), frame_inputs.len(), &model),
            model: Model { force_inputs: frame_inputs, ..model },
            regressor,
            inverse_dynamics,
            at_rest: OnceLock::new(),
            input_matrix_at,
            free,
        })
    }

    /// Returns the names of the drives on several joints whose shafts have no equation in the fit. The
    /// friction of these drives stays as described.
    #[must_use]
    pub fn shafts_as_described(&self) -> Vec<&str> {
        let is_shaft = |name: &str| self.shafts.iter().any(|shaft| shaft.name == name);
        let names = shared_drives(&self.model).map(|drive| drive.name.as_str());
        names.filter(|name| !is_shaft(name)).collect()
    }

    /// Returns the limits of a joint that follows coordinates, or of a motor that moves several joints;
    /// `None` if it follows a joint with prescribed motion.
    fn follower(&self, one: &Dependent<'_>) -> Option<FollowerLimits> {
        let (ratios, of_driven) = one.ratios.as_ref()?.split_at(self.model.coordinates.len());
        of_driven.iter().all(|ratio| *ratio == 0.0).then(|| FollowerLimits {
            name: one.name.to_owned(),
            ratios: ratios.to_vec(),
            offset: one.offset,
            position: one.position,
            velocity: one.velocity,
        })
    }

    /// Returns the model without the friction that is identified.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }
}

/// Returns the described friction of each row of the fit, which is the equation of a joint, or of the shaft
/// that replaces the joint.
fn described_friction(model: &Model, shafts: &[Shaft]) -> Vec<Vec<FrictionTerm>> {
    let of_row = |(row, joint): (usize, &Joint)| {
        let shaft = shafts.iter().find(|shaft| shaft.joint == row);
        let drive = shaft.and_then(|shaft| model.drives.iter().find(|drive| drive.name == shaft.name));
        drive.map_or(&joint.friction, |drive| &drive.friction).clone()
    };
    model.joints().enumerate().map(of_row).collect()
}

/// Returns the regressor of the model's inertial parameters, with three additional free parameters for
/// gravity; `None` if it cannot be derived.
fn regressor_under_gravity(model: &Model) -> Option<Function> {
    let mut model = model.clone();
    model.force_inputs.clear();
    let first = model.parameters.len();
    for axis in ["x", "y", "z"] {
        let name = format!("identified_gravity_{axis}");
        model.parameters.push(Parameter {
            name,
            default: 1.0,
            unit: "m/s²".into(),
            description: String::new(),
        });
    }
    model.gravity = [0, 1, 2].map(|axis| Formula::Parameter(first + axis));
    derive(&model, ["inertial_regressor"]).ok().map(|[regressor]| regressor)
}

/// Returns the input matrix B with columns of zeros for `more` inputs.
fn with_zero_columns(drives: &[f64], more: usize, model: &Model) -> Vec<f64> {
    let (n, m) = (model.coordinates.len(), model.inputs().count());
    let row = |i: usize| drives[i * m..(i + 1) * m].iter().copied().chain(std::iter::repeat_n(0.0, more));
    (0..n).flat_map(row).collect()
}

impl Robot for InterpretedRobot {
    fn joint_names(&self) -> Vec<String> {
        self.model.joints().map(|joint| joint.name.clone()).collect()
    }

    fn input_names(&self) -> Vec<String> {
        self.model.inputs().map(|input| input.name().to_owned()).collect()
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

    fn followers(&self) -> Vec<FollowerLimits> {
        self.model.dependent(&self.free).iter().filter_map(|one| self.follower(one)).collect()
    }

    fn parameter_names(&self) -> Vec<String> {
        parameter_names(&self.model)
    }

    fn parameters(&self) -> Vec<f64> {
        self.parameters.clone()
    }

    fn bodies(&self) -> usize {
        self.model.carrying_joints().len()
    }

    fn quaternion_joints(&self) -> Vec<QuaternionJoint> {
        let joints = self.model.quaternion_joints.iter().map(|joint| QuaternionJoint {
            name: joint.name.clone(),
            position: self.model.first_position(joint.first),
            velocity: joint.first,
            is_floating: joint.kind == QuaternionKind::Floating,
        });
        joints.collect()
    }

    fn shafts(&self) -> Vec<Shaft> {
        self.shafts.clone()
    }

    fn joint_terms(&self) -> Vec<JointTerm> {
        self.joint_terms.iter().map(|(term, _)| term.clone()).collect()
    }

    fn joint_term_values(&self, y: &[f64], v: &[f64], values: &mut [f64]) {
        for ((term, formula), value) in self.joint_terms.iter().zip(values) {
            let position = y[self.model.first_position(term.joint)];
            *value = formula.basis.evaluate(&self.free, position, v[term.joint]);
        }
    }

    fn input_matrix(&self) -> Vec<f64> {
        self.input_matrix.clone()
    }

    fn described_currents(&self) -> Vec<bool> {
        let is_current = |input| matches!(input, Actuator::Drive(Drive { input: Input::Current(_), .. }));
        self.model.inputs().map(is_current).collect()
    }

    fn input_limits(&self) -> Vec<[f64; 2]> {
        let limits = self.model.inputs().map(|input| match input {
            Actuator::Force(force) => force.limits.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]),
            Actuator::Drive(drive) => {
                let constant = match &drive.input {
                    Input::Torque | Input::None => 1.0,
                    Input::Current(constant) => constant.evaluate(&self.free, 0.0, 0.0).abs(),
                };
                let most = drive.torque.peak.or(drive.torque.nominal).map_or(f64::INFINITY, |t| t / constant);
                [-most, most]
            }
        });
        limits.collect()
    }

    fn torque_speed_lines(&self) -> Vec<TorqueSpeedLine> {
        let lines = self.model.limited_inputs(&self.free).into_iter();
        let line = |LimitedInput { input, slopes, limit }| TorqueSpeedLine { input, slopes, limit };
        lines.map(line).collect()
    }

    fn input_forces(&self, y: &[f64], u: &[f64], forces: &mut [f64]) {
        let at_positions = self.input_matrix_at.as_ref().map(|function| result(function, &[y], &self.free));
        let matrix = at_positions.as_ref().unwrap_or(&self.input_matrix);
        for (force, row) in forces.iter_mut().zip(matrix.chunks_exact(u.len().max(1))) {
            *force = row.iter().zip(u).map(|(b, u)| b * u).sum();
        }
    }

    fn has_inputs_at_frames(&self) -> bool {
        self.model.inputs_depend_on_position()
    }

    fn unmeasured(&self) -> Vec<bool> {
        self.unmeasured.clone()
    }

    /// Returns whether each joint has its own input. No joint has one if the robot has couplings or inputs
    /// at frames, because the generator does not support load-dependent friction for such robots.
    fn own_inputs(&self) -> Vec<bool> {
        let joints = self.model.joints().len();
        if self.model.is_coupled() || !self.model.force_inputs.is_empty() {
            return vec![false; joints];
        }
        let driven = |joint| self.model.input_drives().any(|drive| drive.coordinate() == Some(joint));
        (0..joints).map(driven).collect()
    }

    /// Returns for each row of the fit whether an inertia may be added. A drive is written with only one
    /// inertia, so the rotor of the row must not be a parameter.
    fn takes_inertia(&self) -> Vec<bool> {
        let takes = |row: usize| {
            let shaft = self.shafts.iter().find(|shaft| shaft.joint == row);
            let mut drives = self.model.input_drives().filter(|drive| match shaft {
                Some(shaft) => drive.name == shaft.name,
                None => drive.coordinate() == Some(row),
            });
            drives.any(|drive| shaft_rotor(&self.model, &drive.name).is_none())
        };
        (0..self.model.joints().len()).map(takes).collect()
    }

    fn friction(&self, row: usize, v: f64) -> f64 {
        let terms = self.friction.get(row).into_iter().flatten();
        let value = |term: &FrictionTerm| {
            term.coefficient.evaluate(&self.free, 0.0, v) * term.basis.evaluate(&self.free, 0.0, v)
        };
        terms.map(value).sum()
    }

    fn gravity(&self) -> Option<[f64; 3]> {
        Some(self.model.gravity.each_ref().map(|entry| entry.evaluate(&self.free, 0.0, 0.0)))
    }

    fn regressor_at_rest(&self, y: &[f64], gravity: [f64; 3], regressor: &mut [f64]) {
        let function = self.at_rest.get_or_init(|| regressor_under_gravity(&self.model));
        let Some(function) = function else { return regressor.fill(0.0) };
        let (zero, free) = (vec![0.0; self.unmeasured.len()], [&self.free[..], &gravity].concat());
        regressor.copy_from_slice(&result(function, &[y, &zero, &zero], &free));
    }

    fn inertial_regressor(&self, y: &[f64], v: &[f64], a: &[f64], regressor: &mut [f64]) {
        regressor.copy_from_slice(&result(&self.regressor, &[y, v, a], &self.free));
    }

    fn rigid_forces(&self, y: &[f64], v: &[f64], a: &[f64], forces: &mut [f64]) {
        forces.copy_from_slice(&result(&self.inverse_dynamics, &[y, v, a], &self.free));
    }
}
