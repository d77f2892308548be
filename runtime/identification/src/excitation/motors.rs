//! Motors that a planned motion must not ask too much of: limits of their torques, and torque–speed lines.

use super::Instant;
use super::inputs::input_matrix;
use super::smallest_inputs::{SmallestInputs, smallest_inputs};
use crate::robot::{FollowerLimits, JointLimits, Robot, TorqueSpeedLine, narrowed_limits};
use nalgebra::{DMatrix, DVector};

/// The motors of a robot, where something limits them. What inputs at frames may exert stands in [`super::inputs`].
pub(super) struct Motors<'a> {
    robot: &'a dyn Robot,
    lines: Vec<TorqueSpeedLine>,
    /// Lowest and highest inputs that the motion may need.
    usable: Vec<[f64; 2]>,
    /// Share of the lines that the motion may need.
    share: f64,
    /// Inputs of which more than their limits is found by [`super::inputs`].
    at_frames: bool,
    /// B, where it is constant.
    constant: Option<SmallestInputs>,
}

impl<'a> Motors<'a> {
    /// - `share`: of the described limits
    pub(super) fn of(robot: &'a dyn Robot, share: f64) -> Option<Self> {
        let lines = robot.torque_speed_lines();
        let at_frames = robot.has_inputs_at_frames();
        let limits = robot.input_limits().into_iter();
        let usable: Vec<[f64; 2]> = limits.map(|limits| limits.map(|end| share * end)).collect();
        let has_limits = !at_frames && usable.iter().flatten().any(|end| end.is_finite());
        let is_limited = !lines.is_empty() || has_limits;
        let constant = (is_limited && !at_frames).then(|| SmallestInputs::new(constant_matrix(robot)));
        is_limited.then_some(Self { robot, lines, usable, share, at_frames, constant })
    }

    /// Name of the first motor of which a motion asks more than it may.
    pub(super) fn exceeded(&self, instants: &[Instant]) -> Option<String> {
        let counts = |input: usize| !self.at_frames || self.lines.iter().any(|line| line.input == input);
        let input = instants.iter().find_map(|instant| {
            let count = self.usable.len();
            let ranges: Vec<[f64; 2]> = (0..count).map(|input| self.range(input, &instant[1])).collect();
            let inputs = self.inputs(instant, &ranges)?;
            let mut needed = inputs.iter().zip(&ranges).enumerate();
            needed.position(|(input, (u, [low, high]))| counts(input) && !(low..=high).contains(&u))
        })?;
        self.robot.input_names().into_iter().nth(input)
    }

    /// Lowest and highest value of an input at velocities v. Faster than without load, a motor brakes: there the whole line counts.
    fn range(&self, input: usize, v: &[f64]) -> [f64; 2] {
        self.lines.iter().filter(|line| line.input == input).fold(self.usable[input], |[low, high], line| {
            let [least, most] = line.range(v);
            [low.max(least.max(self.share * least)), high.min(most.min(self.share * most))]
        })
    }

    /// The smallest inputs that the described robot needs without friction; none where it has too few of them.
    fn inputs(&self, instant: &Instant, ranges: &[[f64; 2]]) -> Option<Vec<f64>> {
        let [y, v, a] = instant;
        let Some(constant) = &self.constant else {
            return smallest_inputs(self.robot, &input_matrix(self.robot, y), instant, ranges);
        };
        let mut forces = vec![0.0; v.len()];
        self.robot.rigid_forces(y, v, a, &mut forces);
        constant.closest(&DVector::from_vec(forces)).map(|inputs| inputs.as_slice().to_vec())
    }
}

/// B, where all inputs are drives.
fn constant_matrix(robot: &dyn Robot) -> DMatrix<f64> {
    let count = robot.input_names().len();
    DMatrix::from_row_slice(robot.joint_names().len(), count, &robot.input_matrix())
}

/// Speeds at which motors have no torque left, as limits of sums of the joints' speeds.
pub(super) fn no_load_speeds(robot: &dyn Robot) -> impl Iterator<Item = FollowerLimits> {
    let names = robot.input_names();
    robot.torque_speed_lines().into_iter().map(move |line| FollowerLimits {
        name: names[line.input].clone(),
        ratios: line.slopes,
        offset: 0.0,
        position: [f64::NEG_INFINITY, f64::INFINITY],
        velocity: line.limit,
    })
}

/// Limits of the joints, narrowed by the joints that follow one of them alone and by motors that turn with one alone.
pub(super) fn joint_limits(robot: &dyn Robot) -> Vec<JointLimits> {
    let mut limits = narrowed_limits(robot);
    for (joint, _, speed) in no_load_speeds(robot).filter_map(|speed| speed.allowed()) {
        limits[joint].velocity = limits[joint].velocity.min(speed);
    }
    limits
}
