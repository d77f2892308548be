//! Checks of a trajectory against the limits of a model.

use crate::dynamics::{DependentJoint, Dynamics, Named, plain_entries, plain_positions};
use crate::feed_forward::{FeedForward, FeedForwardError};
#[cfg(not(feature = "std"))]
use crate::no_std::*;
use crate::trajectory::{MAX_SAMPLES, Trajectory, TrajectoryError, require_positive, whole_periods};
use core::fmt;
use thiserror::Error;

/// Selects the torque limits for the check.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rating {
    /// Nominal (continuous) torques of the drives.
    Nominal,
    /// Peak (short-time) torques of the drives.
    Peak,
}

/// Quantity with a limit. A follower is a joint whose position is a function of coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Position of a coordinate or follower [rad or m].
    Position,
    /// Speed of a coordinate or follower [rad/s or m/s].
    Velocity,
    /// Drive force at a joint [N m or N], the entry `(B u)_i` of the input matrix B times the inputs u.
    Effort,
    /// Input [N m, N or A].
    Input,
    /// Sum `u + c ẏ` with the input u of a motor, the slopes c of its torque–speed line and the velocities ẏ, in
    /// the unit of u. The torque–speed line limits the magnitude of this sum.
    TorqueSpeed,
    /// Force that the trajectory requires at a coordinate, but that no input can produce [N m or N]. The robot
    /// cannot follow such a trajectory.
    Unreachable,
}

/// A time interval in which a limit is violated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Violation {
    /// Quantity that exceeds its limit.
    pub quantity: Quantity,
    /// Index of the coordinate or input. An index i ≥ N refers to the follower i − N in
    /// [`Limits::dependent`](crate::dynamics::Limits::dependent).
    pub index: usize,
    /// Name of the coordinate, follower or input.
    pub name: &'static str,
    /// Time of the first sample beyond the limit (s).
    pub from: f64,
    /// Time of the last sample beyond the limit (s).
    pub to: f64,
    /// Time of the largest violation (s).
    pub worst_time: f64,
    /// Value of the quantity at `worst_time`, in the unit of the quantity.
    pub value: f64,
    /// Violated limit, in the unit of the quantity.
    pub limit: f64,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match self.quantity {
            Quantity::Position => "position",
            Quantity::Velocity => "velocity",
            Quantity::Effort => "joint effort",
            Quantity::Input => "input",
            Quantity::TorqueSpeed => "torque–speed sum",
            Quantity::Unreachable => "force that no input can produce",
        };
        write!(
            f,
            "{what} of {} is outside its limit {:.6} from {:.3} s to {:.3} s. The worst value is {:.6} at {:.3} s",
            Named(self.name),
            self.limit,
            self.from,
            self.to,
            self.value,
            self.worst_time
        )
    }
}

/// Error of the check of a trajectory.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CheckError {
    /// The period is not positive and finite.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
    /// The feed-forward of the model cannot be computed.
    #[error(transparent)]
    FeedForward(#[from] FeedForwardError),
    /// The trajectory is infinitely long, or has too many periods.
    #[error("a trajectory of {duration} s has more than {MAX_SAMPLES} periods of {period} s")]
    Duration {
        /// Duration of the trajectory (s).
        duration: f64,
        /// Period of the samples (s).
        period: f64,
    },
}

/// Largest force that counts as zero in the check for forces that no input can produce [N m or N].
const FEASIBLE: f64 = 1e-6;

/// Returns the time intervals in which `trajectory` violates position, speed or torque limits of `model`. The
/// trajectory is sampled every `period` (s). The result is empty if the trajectory keeps all limits. Limits of
/// followers and torque–speed lines are included. Torques are those of the feed-forward. Joints with quaternions
/// have no position limits. Numbers that are not finite count as violations.
///
/// # Errors
/// [`CheckError`] for an invalid period, a model without feed-forward, or a trajectory that is too long.
pub fn violations<D: Dynamics<N, M, NY>, const N: usize, const M: usize, const NY: usize>(
    trajectory: &impl Trajectory<N, NY>,
    model: D,
    rating: Rating,
    period: f64,
) -> Result<Vec<Violation>, CheckError> {
    require_positive("period", period)?;
    let limits = model.limits();
    let input_matrix = model.drive_matrix();
    let (effort, input) = match rating {
        Rating::Nominal => (limits.effort, limits.input),
        Rating::Peak => (limits.peak_effort, limits.peak_input),
    };
    let (joints, inputs) = (model.joint_names(), model.input_names());
    let quaternions = model.quaternion_joints();
    let plain: Vec<(usize, usize)> = plain_entries(quaternions, N).collect();
    let feed_forward = FeedForward::new(model)?;
    let mut watch = Watch::default();
    let duration = trajectory.duration();
    let steps = whole_periods(duration, period).ok_or(CheckError::Duration { duration, period })?;
    for k in 0..=steps {
        let time = (k as f64 * period).min(trajectory.duration());
        let sample = trajectory.sample(time);
        let command = feed_forward.at_time(time, &sample);
        watch.time = time;
        for &(i, position) in &plain {
            watch.see(Quantity::Position, i, joints[i], sample.positions[position], limits.position[i]);
        }
        let coordinates = plain_positions(quaternions, &sample.positions);
        feed_forward.model().at_time(time, |model| {
            watch.see_dependent(limits.dependent, &coordinates, &sample.velocities, model.driven_motion());
        });
        for i in 0..N {
            let force: f64 = input_matrix[i].iter().zip(&command.inputs).map(|(b, u)| b * u).sum();
            let name = joints[i];
            watch.see(Quantity::Velocity, i, name, sample.velocities[i], bound(limits.velocity[i]));
            watch.see(Quantity::Effort, i, name, force, bound(effort[i]));
            watch.see(Quantity::Unreachable, i, name, command.residual[i], bound(FEASIBLE));
        }
        for line in limits.torque_speed {
            let value = line.value(command.inputs[line.input], &sample.velocities);
            watch.see(Quantity::TorqueSpeed, line.input, line.name, value, bound(line.limit));
        }
        for j in 0..M {
            watch.see(Quantity::Input, j, inputs[j], command.inputs[j], input[j]);
        }
    }
    Ok(watch.finish())
}

/// Collects violations. `open` contains the violations that last until the present sample.
#[derive(Default)]
struct Watch {
    time: f64,
    open: Vec<Violation>,
    closed: Vec<Violation>,
}

const fn bound(most: f64) -> [f64; 2] {
    [-most, most]
}

impl Watch {
    /// Checks followers, for positions and velocities of the coordinates and the motion of driven joints.
    fn see_dependent<const N: usize>(
        &mut self,
        joints: &[DependentJoint<N>],
        positions: &[f64; N],
        velocities: &[f64; N],
        driven: &[[f64; 3]],
    ) {
        for (k, joint) in joints.iter().enumerate() {
            let [position, velocity] = joint.motion(positions, velocities, driven);
            if joint.has_position_limit() {
                self.see(Quantity::Position, N + k, joint.name, position, joint.position);
            }
            if joint.has_velocity_limit() {
                self.see(Quantity::Velocity, N + k, joint.name, velocity, bound(joint.velocity));
            }
        }
    }

    fn see(
        &mut self,
        quantity: Quantity,
        index: usize,
        name: &'static str,
        value: f64,
        [low, high]: [f64; 2],
    ) {
        let place = self.open.iter().position(|v| v.quantity == quantity && v.index == index);
        // A rounding error at a limit is not a violation. NaN is a violation.
        let slack = 1e-9 * low.abs().min(high.abs()).min(1e9);
        let within = value >= low - slack && value <= high + slack;
        if within {
            if let Some(place) = place {
                self.closed.push(self.open.remove(place));
            }
            return;
        }
        let limit = if value > high { high } else { low };
        let now = Violation {
            quantity,
            index,
            name,
            from: self.time,
            to: self.time,
            worst_time: self.time,
            value,
            limit,
        };
        let Some(place) = place else {
            self.open.push(now);
            return;
        };
        let open = &mut self.open[place];
        open.to = self.time;
        if (value - limit).abs() > (open.value - open.limit).abs() {
            (open.worst_time, open.value, open.limit) = (self.time, value, limit);
        }
    }

    fn finish(mut self) -> Vec<Violation> {
        self.closed.append(&mut self.open);
        self.closed.sort_by(|a, b| a.from.total_cmp(&b.from));
        self.closed
    }
}
