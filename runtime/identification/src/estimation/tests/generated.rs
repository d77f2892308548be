//! A generated module as a robot.

use crate::robot::{FollowerLimits, JointLimits, Robot, TorqueSpeedLine};
use gelenk_dynamics::dynamics::{Dynamics, Limits, load};

/// Function `inertial_regressor` of a generated module: the regressor at positions y, velocities ẏ and
/// accelerations ÿ.
type Regressor<const N: usize, const P: usize> = fn(&[f64; N], &[f64; N], &[f64; N]) -> [[f64; P]; N];

/// A generated module as a [`Robot`]: its [`Dynamics`] and its `inertial_regressor`.
#[derive(Debug, Clone)]
pub(super) struct Generated<D, const N: usize, const M: usize, const P: usize> {
    /// The generated module as [`Dynamics`].
    pub(super) model: D,
    /// Unit of each joint's position: `JOINT_UNITS` of the module.
    pub(super) units: [&'static str; N],
    /// Names of the inertial parameters: `INERTIAL_PARAMETER_NAMES` of the module.
    pub(super) parameter_names: [&'static str; P],
    /// Described inertial parameters: `inertial_parameters()` of the module.
    pub(super) parameters: [f64; P],
    /// Number of bodies. Their `10 · bodies` parameters come before the parameters of the rotors.
    pub(super) bodies: usize,
    /// Regressor of the inertial parameters: `inertial_regressor` of the module.
    pub(super) regressor: Regressor<N, P>,
}

impl<D: Dynamics<N, M>, const N: usize, const M: usize, const P: usize> Robot for Generated<D, N, M, P> {
    fn joint_names(&self) -> Vec<String> {
        self.model.joint_names().map(String::from).to_vec()
    }

    fn input_names(&self) -> Vec<String> {
        self.model.input_names().map(String::from).to_vec()
    }

    fn position_units(&self) -> Vec<&'static str> {
        self.units.to_vec()
    }

    fn limits(&self) -> Vec<JointLimits> {
        let Limits { position, velocity, effort, .. } = self.model.limits();
        let of = |j: usize| JointLimits { position: position[j], velocity: velocity[j], effort: effort[j] };
        (0..N).map(of).collect()
    }

    fn input_limits(&self) -> Vec<[f64; 2]> {
        self.model.limits().peak_input.to_vec()
    }

    fn torque_speed_lines(&self) -> Vec<TorqueSpeedLine> {
        let lines = self.model.limits().torque_speed.iter();
        let line = |line: &gelenk_dynamics::dynamics::TorqueSpeedLine<N>| TorqueSpeedLine {
            input: line.input,
            slopes: line.slopes.to_vec(),
            limit: line.limit,
        };
        lines.map(line).collect()
    }

    fn followers(&self) -> Vec<FollowerLimits> {
        let joints = self.model.limits().dependent.iter().filter(|joint| !joint.follows_driven_joints());
        let limits = joints.map(|joint| FollowerLimits {
            name: joint.name.to_owned(),
            ratios: joint.ratios.to_vec(),
            offset: joint.offset,
            position: joint.position,
            velocity: joint.velocity,
        });
        limits.collect()
    }

    fn parameter_names(&self) -> Vec<String> {
        self.parameter_names.map(String::from).to_vec()
    }

    fn parameters(&self) -> Vec<f64> {
        self.parameters.to_vec()
    }

    fn bodies(&self) -> usize {
        self.bodies
    }

    fn input_matrix(&self) -> Vec<f64> {
        self.model.drive_matrix().concat()
    }

    fn has_inputs_at_frames(&self) -> bool {
        self.model.drives() < M
    }

    fn friction(&self, row: usize, v: f64) -> f64 {
        let speeds = std::array::from_fn(|joint| if joint == row { v } else { 0.0 });
        self.model.friction_torques(&[0.0; N], &speeds)[row]
    }

    fn inertial_regressor(&self, y: &[f64], v: &[f64], a: &[f64], regressor: &mut [f64]) {
        let [y, v, a] = [y, v, a].map(columns::<N>);
        for (row, values) in regressor.chunks_exact_mut(P).zip((self.regressor)(&y, &v, &a)) {
            row.copy_from_slice(&values);
        }
    }

    fn rigid_forces(&self, y: &[f64], v: &[f64], a: &[f64], forces: &mut [f64]) {
        let [y, v, a] = [y, v, a].map(columns::<N>);
        let all = self.model.inverse_dynamics(&y, &v, &a);
        let (friction, shares) = (self.model.friction_torques(&y, &v), self.model.load_friction(&y, &v));
        for (j, force) in forces.iter_mut().enumerate() {
            *force = load(all[j] - friction[j], shares[j]);
        }
    }
}

/// The first N values. The trait promises that there are N.
fn columns<const N: usize>(values: &[f64]) -> [f64; N] {
    std::array::from_fn(|i| values[i])
}
