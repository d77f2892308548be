//! Notes of a predictive controller about its task, before it begins.

use super::options::MpcOptions;
use super::row::MpcRow;
use crate::dynamics::{DependentJoint, Discretizable, Dynamics, Named, jumps, plain_positions, under_load};
use crate::trajectory::{Sample, Trajectory};
use std::fmt;

/// Intervals of the trajectory at whose ends it is compared with the soft limits.
const INTERVALS: usize = 256;

/// Something that a controller does otherwise than its user may expect; found when it is made, see
/// [`LtvMpc::notes`](super::LtvMpc::notes).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MpcNote {
    /// The trajectory moves a joint faster than its soft limit: the controller will lag behind, and a
    /// following error is not a fault of the robot.
    Speed {
        /// Name of the joint.
        joint: &'static str,
        /// When it is furthest beyond (s).
        time: f64,
        /// Its speed then [rad/s or m/s].
        speed: f64,
        /// [`MpcOptions::velocity_limits`].
        limit: f64,
    },
    /// The trajectory leaves the soft limits of a joint's position: the controller will stay behind.
    Position {
        /// Name of the joint.
        joint: &'static str,
        /// When it is furthest beyond (s).
        time: f64,
        /// Its position then [rad or m].
        position: f64,
        /// [`MpcOptions::position_limits`].
        limits: [f64; 2],
    },
    /// The trajectory, or the feed-forward along it, is beyond a row: the controller will lag or stay behind.
    Row {
        /// Name of the row.
        row: &'static str,
        /// When it is furthest beyond (s).
        time: f64,
        /// Value of the row at that time, in its unit.
        value: f64,
        /// Its sides.
        limits: [f64; 2],
    },
    /// A joint follows a driven one and has limits, which change with the driven motion: the controller does not keep them.
    Dependent {
        /// Name of the joint.
        joint: &'static str,
    },
    /// Friction of a joint jumps at rest, as an exact `sign` does. Its slope is taken as 0 on either side, so
    /// that predictions know nothing of sticking: the joint may stop short of its goal. Controllers take a
    /// model with smooth friction.
    DryFriction {
        /// Name of the joint.
        joint: &'static str,
        /// Height of the jump [N m or N].
        jump: f64,
    },
    /// The predicted velocity of a joint alternates by the implicit midpoint rule: friction at rest, as at the start of the
    /// trajectory, stops it within much less than a period, see
    /// [`PredictionRule::ImplicitMidpoint`](super::PredictionRule::ImplicitMidpoint).
    Alternating {
        /// Name of the joint.
        joint: &'static str,
        /// Its velocity after a period as a part of that before, negative.
        share: f64,
    },
    /// The Riccati equation of a terminal weight was not solved to the digits that rounding allows. The
    /// weight is the cost of a stabilizing regulator that may not be the optimal one.
    Terminal {
        /// Where on the trajectory the residual is largest (s).
        time: f64,
        /// It, relative to the weight.
        residual: f64,
    },
}

impl fmt::Display for MpcNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Speed { joint, time, speed, limit } => write!(
                f,
                "at {time:.3} s the trajectory moves joint {} at {speed:.4}, beyond its soft limit of {limit:.4}: the controller will lag behind; \
                 slow the trajectory down, or raise `velocity_limits`",
                Named(joint)
            ),
            Self::Position { joint, time, position, limits: [low, high] } => write!(
                f,
                "at {time:.3} s the trajectory has joint {} at {position:.4}, outside its soft limits of {low:.4} to {high:.4}: the controller \
                 will stay behind; change the trajectory, or `position_limits`",
                Named(joint)
            ),
            Self::Row { row, time, value, limits: [low, high] } => write!(
                f,
                "at {time:.3} s the trajectory and its feed-forward give {value:.4} to row {}, outside its limits of {low:.4} to {high:.4}: \
                 the controller will lag or stay behind; slow the trajectory down or change it",
                Named(row)
            ),
            Self::Dependent { joint } => write!(
                f,
                "joint {} follows a driven joint, and this controller does not keep its limits: the loop brakes at them; check the trajectory together with the driven motion (`limits::violations`)",
                Named(joint)
            ),
            Self::DryFriction { joint, jump } => write!(
                f,
                "friction of joint {} jumps by {jump:.3} N m (or N) at rest, which linear predictions do not see: the joint may stop short of \
                 its goal; generate a smooth model for the controller (`--control-model`)",
                Named(joint)
            ),
            Self::Alternating { joint, share } => write!(
                f,
                "by the implicit midpoint rule a small velocity of joint {} is predicted to be {share:.2} times as large after a period: its \
                 friction at rest is too steep for the rule; take the exact hold (`prediction`), a smoother control model, or a \
                 shorter period",
                Named(joint)
            ),
            Self::Terminal { time, residual } => write!(
                f,
                "the terminal weight at {time:.3} s is that of a stabilizing regulator, but the residual of its Riccati equation is \
                 {residual:.1e}: weights or units are too far apart"
            ),
        }
    }
}

/// Where the trajectory is beyond the soft limits: one note for each joint and limit. Samples that are not
/// finite are reported elsewhere.
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

/// The joints whose limits follow a driven motion.
pub(super) fn not_kept<const N: usize>(joints: &[DependentJoint<N>]) -> Vec<MpcNote> {
    let limited = |joint: &&DependentJoint<N>| joint.has_position_limit() || joint.has_velocity_limit();
    let following = joints.iter().filter(limited).filter(|joint| joint.follows_driven_joints());
    following.map(|joint| MpcNote::Dependent { joint: joint.name }).collect()
}

/// Samples over the whole trajectory, with their times.
fn samples<const N: usize, const NY: usize>(
    trajectory: &impl Trajectory<N, NY>,
) -> Vec<(f64, Sample<N, NY>)> {
    (0..=INTERVALS)
        .map(|k| trajectory.duration() * k as f64 / INTERVALS as f64)
        .map(|time| (time, trajectory.sample(time)))
        .collect()
}

/// Sample with positions by velocity entry: 0 for joints with a quaternion, which have neither limits nor rows.
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

/// Where the trajectory with its feed-forward `inputs`, by time and sample, is beyond a row: one note for each row.
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

/// Joints whose friction jumps at rest at `positions`, under the load of gravity and springs there.
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

/// Joints whose velocity alternates by the implicit midpoint rule, at rest at these positions.
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

/// The sample furthest beyond, if one is; rounding at a limit that is just touched is not.
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

    /// A weight of 4 N on a gear whose dry friction is a quarter of the load.
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
