//! A robot for tests of logs: names, limits, units and gears, without dynamics.

use super::super::super::pose::QuaternionJoint;
use super::super::super::robot::{FollowerLimits, JointLimits, Robot};
use super::super::{ColumnOptions, runs_of};

/// Joints with limits and drives, as the reader of logs needs them.
pub(super) struct Fake {
    pub joints: Vec<String>,
    pub inputs: Vec<String>,
    pub units: Vec<&'static str>,
    pub limits: Vec<JointLimits>,
    pub followers: Vec<FollowerLimits>,
    pub gear: f64,
    pub quaternions: Vec<QuaternionJoint>,
}

impl Fake {
    /// Creates rotary joints within ±3 rad, 4 rad/s and 100 N·m, with ideal drives.
    pub(super) fn new(joints: &[&str]) -> Self {
        let joints: Vec<String> = joints.iter().map(|j| (*j).to_owned()).collect();
        Self {
            inputs: joints.clone(),
            units: vec!["rad"; joints.len()],
            limits: vec![JointLimits { position: [-3.0, 3.0], velocity: 4.0, effort: 100.0 }; joints.len()],
            followers: vec![],
            gear: 1.0,
            quaternions: vec![],
            joints,
        }
    }

    /// Creates a floating base with four inputs.
    pub(super) fn floating() -> Self {
        let base = QuaternionJoint { name: "base".into(), position: 0, velocity: 0, is_floating: true };
        let inputs = ["front_right", "rear_left", "front_left", "rear_right"].map(str::to_owned).to_vec();
        let robot = Self::new(&["base_x", "base_y", "base_z", "base_rx", "base_ry", "base_rz"]);
        Self { inputs, quaternions: vec![base], ..robot }
    }

    /// Creates `count` joints with the names `joint_1`, …
    pub(super) fn numbered(count: usize) -> Self {
        let names: Vec<String> = (1..=count).map(|i| format!("joint_{i}")).collect();
        Self::new(&names.iter().map(String::as_str).collect::<Vec<_>>())
    }
}

impl Robot for Fake {
    fn joint_names(&self) -> Vec<String> {
        self.joints.clone()
    }
    fn input_names(&self) -> Vec<String> {
        self.inputs.clone()
    }
    fn position_units(&self) -> Vec<&'static str> {
        self.units.clone()
    }
    fn limits(&self) -> Vec<JointLimits> {
        self.limits.clone()
    }
    fn followers(&self) -> Vec<FollowerLimits> {
        self.followers.clone()
    }
    fn quaternion_joints(&self) -> Vec<QuaternionJoint> {
        self.quaternions.clone()
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
        let (n, m) = (self.joints.len(), self.inputs.len());
        (0..n * m).map(|i| if i / m == i % m { self.gear } else { 0.0 }).collect()
    }
    fn inertial_regressor(&self, _: &[f64], _: &[f64], _: &[f64], _: &mut [f64]) {}
    fn rigid_forces(&self, _: &[f64], _: &[f64], _: &[f64], forces: &mut [f64]) {
        forces.fill(0.0);
    }
}

/// Returns the error message about a log of two joints.
pub(super) fn message(text: &str, columns: &str) -> String {
    let columns = Some(columns.to_owned()).filter(|c| !c.is_empty());
    let options = ColumnOptions { columns, ..ColumnOptions::default() };
    runs_of(text.as_bytes(), "log.csv", &Fake::numbered(2), &options).unwrap_err().to_string()
}
