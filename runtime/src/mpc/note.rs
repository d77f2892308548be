//! Notes about unexpected behaviour of a predictive controller, collected at construction.

use super::options::MpcOptions;
use super::row::MpcRow;
use crate::dynamics::{DependentJoint, Discretizable, Dynamics, Named, jumps, plain_positions, under_load};
use crate::trajectory::{Sample, Trajectory};
use std::fmt;

/// Number of equal time intervals of the trajectory. It is compared with the soft limits at their ends.
const INTERVALS: usize = 256;

/// Note about a behaviour of the controller that the user may not expect. The construction of a controller collects
/// these notes, see [`LtvMpc::notes`](super::LtvMpc::notes).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MpcNote {
    /// The trajectory moves a joint faster than its soft limit. The robot will lag behind the trajectory. This
    /// following error is not a fault of the robot.
    Speed {
        /// Name of the joint.
        joint: &'static str,
        /// Time at which the speed exceeds its limit most (s).
        time: f64,
        /// Speed of the joint at `time` [rad/s or m/s].
        speed: f64,
        /// Limit in [`MpcOptions::velocity_limits`] [rad/s or m/s].
        limit: f64,
    },
    /// The trajectory leaves the soft position limits of a joint. The controller will stop the joint near the limit.
    Position {
        /// Name of the joint.
        joint: &'static str,
        /// Time at which the position is furthest beyond its limits (s).
        time: f64,
        /// Position of the joint at `time` [rad or m].
        position: f64,
        /// Limits in [`MpcOptions::position_limits`] [rad or m].
        limits: [f64; 2],
    },
    /// The trajectory with its feed-forward violates a row ([`MpcRow`](super::MpcRow)). The robot will lag behind the
    /// trajectory or stop at the limit.
    Row {
        /// Name of the row.
        row: &'static str,
        /// Time at which the row is violated most (s).
        time: f64,
        /// Value of the row at `time`, in the unit of the row.
        value: f64,
        /// Lower and upper limit of the row.
        limits: [f64; 2],
    },
    /// A joint with limits follows a driven joint. The controller does not keep these limits, because the allowed
    /// positions of the coordinates change with the driven motion.
    Dependent {
        /// Name of the joint.
        joint: &'static str,
    },
    /// The friction of a joint is discontinuous at rest, for example because it contains an exact `sign`. Linear
    /// predictions use the slope 0 on both sides of the jump, so they do not predict sticking. The joint may stop
    /// before its goal. Use a model with smooth friction for the controller.
    DryFriction {
        /// Name of the joint.
        joint: &'static str,
        /// Height of the jump [N m or N].
        jump: f64,
    },
    /// The implicit midpoint rule predicts that the sign of a joint velocity alternates from period to period. The
    /// reason is that friction at rest stops the joint within much less than a period. The joint is checked at the
    /// start of the trajectory. See
    /// [`PredictionRule::ImplicitMidpoint`](super::PredictionRule::ImplicitMidpoint).
    Alternating {
        /// Name of the joint.
        joint: &'static str,
        /// Predicted ratio of the velocity after a period to the velocity before the period. The ratio is
        /// negative.
        share: f64,
    },
    /// The Riccati equation of a terminal weight was not solved to rounding accuracy. The weight is the cost
    /// of a regulator that is stabilizing, but may not be optimal.
    Terminal {
        /// Time on the trajectory at which the residual is largest (s).
        time: f64,
        /// Largest residual of the Riccati equation relative to the weight.
        residual: f64,
    },
}

impl fmt::Display for MpcNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Speed { joint, time, speed, limit } => write!(
                f,
                "at {time:.3} s the trajectory moves joint {} at {speed:.4} rad/s (or m/s), above its soft limit of {limit:.4}. \
                 The robot will lag behind. Slow the trajectory down, or raise `velocity_limits`",
                Named(joint)
            ),
            Self::Position { joint, time, position, limits: [low, high] } => write!(
                f,
                "at {time:.3} s the trajectory has joint {} at {position:.4} rad (or m), outside its soft limits of {low:.4} to \
                 {high:.4}. The controller will stop the joint near the limit. Change the trajectory, or `position_limits`",
                Named(joint)
            ),
            Self::Row { row, time, value, limits: [low, high] } => write!(
                f,
                "at {time:.3} s the trajectory gives row {} the value {value:.4}, outside its limits of {low:.4} to {high:.4}. \
                 The robot will not follow the trajectory. Slow the trajectory down or change it",
                Named(row)
            ),
            Self::Dependent { joint } => write!(
                f,
                "the controller does not enforce the limits of joint {}, because it follows a driven joint. The loop brakes at \
                 these limits. Check the trajectory together with the driven motion by `limits::violations`",
                Named(joint)
            ),
            Self::DryFriction { joint, jump } => write!(
                f,
                "the friction of joint {} jumps by {jump:.3} N m (or N) at rest, so the joint may stop before its goal. Linear \
                 predictions cannot represent the jump. Generate a smooth model with `--control-model`",
                Named(joint)
            ),
            Self::Alternating { joint, share } => write!(
                f,
                "friction of joint {} at rest is too steep for the implicit midpoint rule. The rule predicts that a small \
                 velocity is multiplied by {share:.2} in each period. Use the exact zero-order hold (`prediction`), a smoother \
                 control model, or a shorter period",
                Named(joint)
            ),
            Self::Terminal { time, residual } => write!(
                f,
                "the terminal weight at {time:.3} s is inaccurate (residual of its Riccati equation: {residual:.1e}). The \
                 regulator is stabilizing, but may not be optimal. Choose weights that differ by fewer orders of magnitude"
            ),
        }
    }
}

/// Notes about positions and speeds of the trajectory beyond the soft limits, at most one for each joint and limit.
/// Samples that are not finite are ignored here, because the constructor reports them as an error.
pub(super) fn beyond_limits<const N: usize, const M: usize, const NR: usize, const NY: usize>(
    model: &impl Dynamics<N, M, NY>,
    trajectory: &impl Trajectory<N, NY>,
    options: &MpcOptions<N, M, NR>,
) -> Vec<MpcNote> {
    let samples = samples(trajectory);
    let mut notes = Vec::new();
    for (i, joint) in model.joint_names().into_iter().enumerate() {
        let limit = options.velocity_limits[i];
        let speed = |sample: &Sample<N, NY>| sample.velocities[i].abs();
        if let Some((time, sample)) = worst(&samples, |_, sample| speed(sample) - limit) {
            let speed = speed(sample);
            notes.push(MpcNote::Speed { joint, time, speed, limit });
        }
        let limits @ [low, high] = options.position_limits[i];
        let position = |sample: &Sample<N, NY>| coordinates(model, sample).positions[i];
        let outside = |_, sample: &_| (low - position(sample)).max(position(sample) - high);
        if let Some((time, sample)) = worst(&samples, outside) {
            notes.push(MpcNote::Position { joint, time, position: position(sample), limits });
        }
    }
    notes
}

/// Notes about joints with limits that follow a driven joint.
pub(super) fn not_kept<const N: usize>(joints: &[DependentJoint<N>]) -> Vec<MpcNote> {
    let limited = |joint: &&DependentJoint<N>| joint.has_position_limit() || joint.has_velocity_limit();
    let following = joints.iter().filter(limited).filter(|joint| joint.follows_driven_joints());
    following.map(|joint| MpcNote::Dependent { joint: joint.name }).collect()
}

/// Samples of the whole trajectory, with their times.
fn samples<const N: usize, const NY: usize>(
    trajectory: &impl Trajectory<N, NY>,
) -> Vec<(f64, Sample<N, NY>)> {
    (0..=INTERVALS)
        .map(|k| trajectory.duration() * k as f64 / INTERVALS as f64)
        .map(|time| (time, trajectory.sample(time)))
        .collect()
}

/// Sample with one position for each velocity entry. The positions of joints with a quaternion are 0, because they
/// have neither limits nor rows.
fn coordinates<const N: usize, const M: usize, const NY: usize>(
    model: &impl Dynamics<N, M, NY>,
    sample: &Sample<N, NY>,
) -> Sample<N> {
    Sample {
        positions: plain_positions(model.quaternion_joints(), &sample.positions),
        velocities: sample.velocities,
        accelerations: sample.accelerations,
    }
}

/// Notes about rows that the trajectory with its feed-forward violates, at most one for each row. `inputs` returns the
/// feed-forward for a time and a sample.
pub(super) fn beyond_rows<const N: usize, const M: usize, const NR: usize, const NY: usize>(
    model: &impl Dynamics<N, M, NY>,
    trajectory: &impl Trajectory<N, NY>,
    rows: &[MpcRow<N, M>; NR],
    inputs: impl Fn(f64, &Sample<N, NY>) -> [f64; M],
) -> Vec<MpcNote> {
    if NR == 0 {
        return Vec::new();
    }
    let samples = samples(trajectory);
    let of_row = |row: &MpcRow<N, M>| {
        let excess = |time, sample: &_| row.excess(&coordinates(model, sample), &inputs(time, sample));
        let (time, sample) = worst(&samples, excess)?;
        let positions = coordinates(model, sample).positions;
        let value = row.value(&positions, &sample.velocities, &inputs(time, sample));
        Some(MpcNote::Row { row: row.name, time, value, limits: [row.lower, row.upper] })
    };
    rows.iter().filter_map(of_row).collect()
}

/// Notes about joints whose friction is discontinuous at rest at `positions`. Load-dependent friction is evaluated with
/// the forces of gravity and springs at these positions.
pub(super) fn dry_friction<const N: usize, const M: usize, const NY: usize>(
    model: &impl Dynamics<N, M, NY>,
    positions: &[f64; NY],
) -> Vec<MpcNote> {
    let (joints, at_rest) = (model.joint_names(), model.friction_at_rest(positions));
    let shares = model.load_friction_at_rest(positions);
    let (gravity, springs) = (model.gravity_forces(positions), model.spring_forces(positions, &[0.0; N]));
    (0..N)
        .filter(|&i| jumps(at_rest[i]) || jumps(shares[i]))
        .map(|i| {
            let [[before, after], load] =
                [at_rest[i], shares[i].map(|share| under_load(gravity[i] + springs[i], share))];
            MpcNote::DryFriction { joint: joints[i], jump: after - before + load[1] - load[0] }
        })
        .collect()
}

/// Notes about joints whose velocity alternates with the implicit midpoint rule, at rest at `positions`.
pub(super) fn alternating<const N: usize, const M: usize, const NY: usize>(
    model: &impl Discretizable<N, M, NY>,
    positions: &[f64; NY],
    period: f64,
) -> Vec<MpcNote> {
    let step = model.midpoint_step(positions, &[0.0; N], &[0.0; N], &[0.0; M], period);
    let [_, [_, by_velocities]] = step.state;
    let shares = model.joint_names().into_iter().enumerate().map(|(i, joint)| (joint, by_velocities[i][i]));
    let negative = shares.filter(|(_, share)| *share < 0.0);
    negative.map(|(joint, share)| MpcNote::Alternating { joint, share }).collect()
}

/// The sample with the largest `excess`; `None` if no sample exceeds its limit by more than rounding.
fn worst<const N: usize, const NY: usize>(
    samples: &[(f64, Sample<N, NY>)],
    excess: impl Fn(f64, &Sample<N, NY>) -> f64,
) -> Option<(f64, &Sample<N, NY>)> {
    samples
        .iter()
        .map(|(time, sample)| (*time, sample, excess(*time, sample)))
        .filter(|(_, _, excess)| *excess > 1e-9)
        .max_by(|a, b| a.2.total_cmp(&b.2))
        .map(|(time, sample, _)| (time, sample))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::Limits;

    /// A weight of 4 N on a gear with load-dependent friction. The dry friction is a quarter of the load.
    struct Lift;

    impl Dynamics<1, 1> for Lift {
        fn limits(&self) -> Limits<1, 1> {
            Limits {
                position: [[f64::NEG_INFINITY, f64::INFINITY]],
                velocity: [f64::INFINITY],
                effort: [5.0],
                peak_effort: [10.0],
                input: [[-5.0, 5.0]],
                peak_input: [[-10.0, 10.0]],
                dependent: &[],
                torque_speed: &[],
            }
        }
        fn mass_matrix(&self, _: &[f64; 1]) -> [[f64; 1]; 1] {
            [[2.0]]
        }
        fn coriolis_forces(&self, _: &[f64; 1], _: &[f64; 1]) -> [f64; 1] {
            [0.0]
        }
        fn gravity_forces(&self, _: &[f64; 1]) -> [f64; 1] {
            [-4.0]
        }
        fn spring_forces(&self, _: &[f64; 1], _: &[f64; 1]) -> [f64; 1] {
            [0.0]
        }
        fn friction_torques(&self, _: &[f64; 1], v: &[f64; 1]) -> [f64; 1] {
            [3.0 * v[0]]
        }
        fn load_friction(&self, _: &[f64; 1], v: &[f64; 1]) -> [f64; 1] {
            [0.25 * v[0].signum()]
        }
        fn friction_jumps(&self) -> &'static [[usize; 2]] {
            &[[0, 0]]
        }
        fn input_matrix(&self, _: &[f64; 1]) -> [[f64; 1]; 1] {
            [[1.0]]
        }
    }

    #[test]
    fn friction_that_jumps_with_the_load_alone_is_noted() {
        let notes = dry_friction(&Lift, &[0.0]);
        assert_eq!(notes, [MpcNote::DryFriction { joint: "1", jump: 2.0 }]);
    }
}
