//! Joints and inputs of a robot, with which columns are matched.

use super::super::super::error::Result;
use super::super::super::pose::{QuaternionJoint, rows_of};
use super::super::super::robot::Robot;
use super::super::super::run::{Effort, Run};
use super::families::Targets;
use super::pattern::ColumnOptions;

/// Joints and inputs of a robot that may have columns in a log. Joints with a quaternion are separate: their velocities do
/// not count as joints.
pub(in crate::log) struct RobotColumns {
    /// Joints that the user does not hold at fixed positions (`hold=…` of [`ColumnOptions`]).
    pub joints: Targets,
    /// Joints whose torques a log may have. These joints are neither held nor moved from outside.
    pub torques: Targets,
    /// All inputs except those that act only on held joints.
    pub inputs: Targets,
    /// Inputs at frames, such as measured contact forces.
    pub frame_inputs: Targets,
    /// Joints with a quaternion.
    pub quaternions: Vec<QuaternionJoint>,
    /// Position of each joint that is held, in rad or m; `None` for other joints.
    pub held: Vec<Option<f64>>,
    /// All joints, including held ones.
    pub all_joints: Targets,
    /// Unit of each joint, `rad` or `m`.
    pub units: Vec<&'static str>,
    /// Unit of the position of the joint that an input drives, `rad` or `m`. It is `rad` if the input drives several
    /// joints.
    pub input_units: Vec<&'static str>,
    /// Whether the input matrix B is the identity, so that forces at the joints and inputs are equal.
    pub direct: bool,
}

impl RobotColumns {
    /// # Errors
    /// [`IdentificationError::File`](super::super::super::error::IdentificationError::File) if a pattern of held joints
    /// matches no joint.
    pub(in crate::log) fn new(robot: &dyn Robot, options: &ColumnOptions) -> Result<Self> {
        let (names, inputs) = (robot.joint_names(), robot.input_names());
        let quaternions = robot.quaternion_joints();
        let rows = rows_of(&quaternions, names.len());
        let lines: Vec<usize> = (0..names.len()).filter(|joint| !rows[*joint]).collect();
        let joints: Vec<String> = lines.iter().map(|line| names[*line].clone()).collect();
        let (n, m) = (joints.len(), inputs.len());
        let held = options.held(&joints)?;
        let matrix = robot.input_matrix();
        let entry = |row: usize, column: usize| matrix.get(row * m + column).copied().unwrap_or(0.0);
        let moved =
            |input: usize| -> Vec<usize> { (0..n).filter(|j| entry(lines[*j], input) != 0.0).collect() };
        let driven: Vec<Option<usize>> =
            (0..m).map(|input| <[usize; 1]>::try_from(moved(input)).ok().map(|[j]| j)).collect();
        let others: Vec<Option<String>> = driven.iter().map(|j| j.map(|j| joints[j].clone())).collect();
        let all_units = robot.position_units();
        let units: Vec<&'static str> =
            lines.iter().map(|line| all_units.get(*line).copied().unwrap_or("rad")).collect();
        let acts = |input: usize| (0..names.len()).any(|row| entry(row, input) != 0.0);
        let at_frames: Vec<bool> = (0..m).map(|input| robot.has_inputs_at_frames() && !acts(input)).collect();
        let unmeasured = robot.unmeasured();
        let is_identity =
            |row: usize| (0..m).all(|column| entry(lines[row], column) == f64::from(u8::from(row == column)));
        let only_held =
            |input: usize| !moved(input).is_empty() && moved(input).iter().all(|j| held[*j].is_some());
        let all_joints = Targets::new(&joints, &[]);
        let all_inputs = Targets::new(&inputs, &others);
        Ok(Self {
            joints: all_joints.only(|j| held[j].is_none()),
            torques: all_joints.only(|j| held[j].is_none() && !unmeasured[lines[j]]),
            all_joints,
            frame_inputs: all_inputs.only(|input| at_frames[input]),
            inputs: all_inputs.only(|input| !only_held(input)),
            input_units: driven.into_iter().map(|j| j.map_or("rad", |j| units[j])).collect(),
            units,
            direct: n == m && (0..n).all(is_identity),
            quaternions,
            held,
        })
    }

    /// Returns the part of `--columns` that holds joints; `None` if no joint is held.
    pub(super) fn hold_option(&self) -> Option<String> {
        let held: Vec<String> = self.held_values().map(|(name, value)| format!("{name}={value}")).collect();
        (!held.is_empty()).then(|| format!("hold={}", held.join("|")))
    }

    /// Returns names and positions of the joints that are held.
    pub(super) fn held_values(&self) -> impl Iterator<Item = (&str, f64)> {
        self.all_joints
            .names
            .iter()
            .zip(&self.held)
            .filter_map(|(name, value)| Some((name.as_str(), (*value)?)))
    }

    /// Adds columns that the log does not have: positions of held joints, and NaN for efforts that were not measured.
    ///
    /// - `recorded`: indices of the joints or inputs whose efforts the log has
    pub(in crate::log) fn add_unrecorded(&self, run: &mut Run, recorded: &[usize]) {
        let samples = run.times.len();
        let count = if run.effort == Effort::Joint { self.held.len() } else { self.input_units.len() };
        for place in (0..count).filter(|place| !recorded.contains(place)) {
            run.efforts.insert(place, vec![f64::NAN; samples]);
        }
        let held = self.held.iter().enumerate().filter_map(|(joint, value)| Some((joint, (*value)?)));
        for (joint, value) in held {
            run.positions.insert(joint, vec![value; samples]);
            run.velocities.insert(joint, None);
        }
    }
}
