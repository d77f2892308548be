//! Limits of motors in a planned motion: torques, and torque–speed lines.

use super::Instant;
use super::smallest_inputs::SmallestInputs;
use crate::robot::{FollowerLimits, JointLimits, Robot, TorqueSpeedLine, narrowed_limits};
use nalgebra::{DMatrix, DVector};

/// Limits that the inputs keep along a planned motion.
pub(super) struct Torques {
    lines: Vec<TorqueSpeedLine>,
    /// Lowest and highest input that the motion may require, for each input.
    usable: Vec<[f64; 2]>,
    /// Usable share of the torque–speed lines.
    share: f64,
}

impl Torques {
    /// Limits of the motors as described, multiplied by `share`.
    ///
    /// - `share`: usable share of the described limits
    pub(super) fn of(robot: &dyn Robot, share: f64) -> Self {
        let usable = robot.input_limits().into_iter().map(|limits| limits.map(|end| share * end));
        Self { lines: robot.torque_speed_lines(), usable: usable.collect(), share }
    }

    fn are_limited(&self) -> bool {
        !self.lines.is_empty() || self.usable.iter().flatten().any(|end| end.is_finite())
    }

    /// Whether an input is a motor with a torque–speed line.
    pub(super) fn has_line(&self, input: usize) -> bool {
        self.lines.iter().any(|line| line.input == input)
    }

    /// Lowest and highest value of each input at velocities v.
    pub(super) fn ranges(&self, v: &[f64]) -> Vec<[f64; 2]> {
        (0..self.usable.len()).map(|input| self.range(input, v)).collect()
    }

    /// Lowest and highest value of one input. Beyond its no-load speed a motor can only brake. The limit there is the line
    /// itself, not the usable share of the line.
    fn range(&self, input: usize, v: &[f64]) -> [f64; 2] {
        self.lines.iter().filter(|line| line.input == input).fold(self.usable[input], |[low, high], line| {
            let [least, most] = line.range(v);
            [low.max(least.max(self.share * least)), high.min(most.min(self.share * most))]
        })
    }
}

/// The motors of a robot whose inputs are all drives, if a motor has a limit. The motors of other robots are in
/// [`super::inputs`].
pub(super) struct Motors<'a> {
    robot: &'a dyn Robot,
    torques: Torques,
    matrix: SmallestInputs,
}

impl<'a> Motors<'a> {
    /// Motors of a robot; `None` if they have no limits or if inputs act at frames.
    ///
    /// - `share`: usable share of the described limits
    pub(super) fn of(robot: &'a dyn Robot, share: f64) -> Option<Self> {
        let torques = Torques::of(robot, share);
        let counts = torques.are_limited() && !robot.has_inputs_at_frames();
        let (joints, inputs) = (robot.joint_names().len(), robot.input_names().len());
        let matrix = || SmallestInputs::new(DMatrix::from_row_slice(joints, inputs, &robot.input_matrix()));
        counts.then(|| Self { robot, torques, matrix: matrix() })
    }

    /// Name of the first motor whose limit a motion exceeds; `None` if all limits are kept.
    pub(super) fn exceeded(&self, instants: &[Instant]) -> Option<String> {
        let input = instants.iter().find_map(|instant| {
            let inputs = self.inputs(instant)?;
            let ranges = self.torques.ranges(&instant[1]);
            inputs.iter().zip(&ranges).position(|(u, [low, high])| !(low..=high).contains(&u))
        })?;
        self.robot.input_names().into_iter().nth(input)
    }

    /// The smallest inputs that the described robot requires without friction; `None` if there are no inputs.
    fn inputs(&self, [y, v, a]: &Instant) -> Option<Vec<f64>> {
        let mut forces = vec![0.0; v.len()];
        self.robot.rigid_forces(y, v, a, &mut forces);
        self.matrix.closest(&DVector::from_vec(forces)).map(|inputs| inputs.as_slice().to_vec())
    }
}

/// No-load speeds of motors, as limits of weighted sums of the joints' speeds.
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

/// Limits of the joints, narrowed by joints that follow a single joint and by motors that a single joint turns.
pub(super) fn joint_limits(robot: &dyn Robot) -> Vec<JointLimits> {
    let mut limits = narrowed_limits(robot);
    for (joint, _, speed) in no_load_speeds(robot).filter_map(|speed| speed.allowed()) {
        limits[joint].velocity = limits[joint].velocity.min(speed);
    }
    limits
}
