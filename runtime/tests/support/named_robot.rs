//! A robot that logs are read for: names, limits and gears; its equations of motion are one weight.

use gelenk_identification::robot::{JointLimits, Robot};
use std::f64::consts::TAU;

/// Rotary joints of these names, each with a drive.
pub struct NamedRobot {
    pub names: Vec<String>,
    /// Largest speed [rad/s].
    pub speed: f64,
    /// Largest force [N·m].
    pub effort: f64,
    /// Ratio between motors and joints.
    pub gear: f64,
    /// Torque of gravity at the second joint [N·m].
    pub weight: f64,
}

impl Default for NamedRobot {
    fn default() -> Self {
        Self { names: Vec::new(), speed: f64::INFINITY, effort: f64::INFINITY, gear: 1.0, weight: 0.0 }
    }
}

impl Robot for NamedRobot {
    fn joint_names(&self) -> Vec<String> {
        self.names.clone()
    }

    fn input_names(&self) -> Vec<String> {
        self.names.clone()
    }

    fn position_units(&self) -> Vec<&'static str> {
        vec!["rad"; self.names.len()]
    }

    fn limits(&self) -> Vec<JointLimits> {
        let limits = JointLimits { position: [-TAU, TAU], velocity: self.speed, effort: self.effort };
        vec![limits; self.names.len()]
    }

    fn parameter_names(&self) -> Vec<String> {
        Vec::new()
    }

    fn parameters(&self) -> Vec<f64> {
        Vec::new()
    }

    fn bodies(&self) -> usize {
        0
    }

    fn input_matrix(&self) -> Vec<f64> {
        let n = self.names.len();
        (0..n * n).map(|i| if i / n == i % n { self.gear } else { 0.0 }).collect()
    }

    fn inertial_regressor(&self, _: &[f64], _: &[f64], _: &[f64], _: &mut [f64]) {}

    fn rigid_forces(&self, y: &[f64], _: &[f64], _: &[f64], forces: &mut [f64]) {
        forces.fill(0.0);
        if let (Some(force), Some(y)) = (forces.get_mut(1), y.get(1)) {
            *force = self.weight * y.sin();
        }
    }
}
