//! Limits of motors in a planned motion: torques, and torque–speed lines.

use crate::robot::{FollowerLimits, JointLimits, Robot, TorqueSpeedLine, narrowed_limits};

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

    /// Whether an input has a limit.
    pub(super) fn are_limited(&self) -> bool {
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
