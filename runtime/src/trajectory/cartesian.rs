//! Motions through sequences of poses for arms with a spherical wrist.

use super::polynomial::RestToRest;
use super::{PointSequence, Sample, Sampled, Trajectory, TrajectoryError, require_periods, require_positive};
use crate::kinematics::{KinematicsError, Pose, Singularity, SphericalWrist};
use nalgebra::{Matrix3, Rotation3, Vector3};
use thiserror::Error;

/// Largest allowed step of a joint between two samples of a straight path (rad). A larger step is a jump to another branch
/// of the inverse kinematics, or the effect of a nearby singularity.
const LARGEST_STEP: f64 = 0.2;

/// Error of a sequence of poses.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CartesianError {
    /// The number of poses or durations, a duration or the period is invalid.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
    /// A pose cannot be reached.
    #[error("pose {} cannot be reached: {source}", .pose + 1)]
    Unreachable {
        /// Index of the pose, from 0. Messages count from 1.
        pose: usize,
        /// Reason why the arm cannot reach the pose.
        source: KinematicsError,
    },
    /// The straight path to a pose leaves the arm's workspace.
    #[error("the straight path to pose {} cannot be followed at {time} s: {source}", .pose + 1)]
    WayUnreachable {
        /// Index of the pose at the end of the path, from 0. Messages count from 1.
        pose: usize,
        /// Time since the start of the path (s).
        time: f64,
        /// Reason why the arm cannot reach this pose of the path.
        source: KinematicsError,
    },
    /// The straight path to a pose leads through a singularity.
    #[error(
        "the straight path to pose {} leads through a singularity at {time} s ({singularity:?}). Choose another path or a motion \
         in joint space",
        .pose + 1
    )]
    Singular {
        /// Index of the pose at the end of the path, from 0. Messages count from 1.
        pose: usize,
        /// Time since the start of the path (s).
        time: f64,
        /// Kind of the singularity.
        singularity: Singularity,
    },
    /// A joint would have to jump on the straight path to a pose, because the path is close to a singularity.
    #[error(
        "on the straight path to pose {}, joint {} would turn by {step} rad in one sample at {time} s, because the path is close \
         to a singularity. Choose another path or a motion in joint space",
        .pose + 1,
        .joint + 1
    )]
    Jump {
        /// Index of the pose at the end of the path, from 0. Messages count from 1.
        pose: usize,
        /// Time since the start of the path (s).
        time: f64,
        /// Index of the joint, from 0. Messages count from 1.
        joint: usize,
        /// Step of the joint (rad).
        step: f64,
    },
}

/// Returns joint angles for `poses` within `limits` (rad). Of the solutions for a pose, the one closest to the angles of
/// the previous pose is used. For the first pose, the solution closest to `start` (rad) is used. At a singular pose, joints
/// with an arbitrary angle keep their previous angle.
///
/// # Errors
/// [`CartesianError::Unreachable`] if a pose has no solution within the limits.
pub fn joint_points(
    arm: &SphericalWrist,
    poses: &[Pose],
    limits: &[[f64; 2]; 6],
    start: &[f64; 6],
) -> Result<Vec<[f64; 6]>, CartesianError> {
    let mut near = *start;
    let mut points = Vec::with_capacity(poses.len());
    for (k, pose) in poses.iter().enumerate() {
        let solution = arm
            .solve(pose, &near)
            .and_then(|found| found.within(limits, &near))
            .map_err(|source| CartesianError::Unreachable { pose: k, source })?;
        near = solution.positions;
        points.push(near);
    }
    Ok(points)
}

/// Returns a motion from pose to pose on straight lines in joint space, at rest in each pose. The arguments are those of
/// [`joint_points`] and of [`PointSequence::within`].
///
/// # Errors
/// The errors of [`joint_points`] and of [`PointSequence::within`].
pub fn pose_sequence(
    arm: &SphericalWrist,
    poses: &[Pose],
    limits: &[[f64; 2]; 6],
    start: &[f64; 6],
    speeds: &[f64; 6],
    accelerations: &[f64; 6],
) -> Result<PointSequence<6>, CartesianError> {
    let points = joint_points(arm, poses, limits, start)?;
    Ok(PointSequence::within(&points, speeds, accelerations, 0.0)?)
}

/// Returns a motion from pose to pose on straight lines in space, at rest in each pose. The first path begins at the joint
/// angles `start` (rad).
///
/// On each path the origin of the frame moves on a line, and the frame turns about a fixed axis. Both follow the profile
/// s(t/T) of [`RestToRest`]. T is the entry of `durations` (s) for this path, rounded up to whole periods. The inverse
/// kinematics gives the joint positions at every `period` (s). Velocities `ẏ = J⁻¹ V` and accelerations
/// `ÿ = J⁻¹ (A − J̇ ẏ)` follow from the Jacobian J, the velocity V and the acceleration A of the frame.
///
/// The frame turns in the shorter direction. For exactly 180°, rounding decides the direction.
///
/// # Errors
/// - [`CartesianError::WayUnreachable`], [`CartesianError::Singular`] or [`CartesianError::Jump`] for a path that the arm
///   cannot follow.
/// - [`CartesianError::Trajectory`] with [`TrajectoryError::TooFew`] if the number of durations differs from the number of
///   poses.
/// - [`CartesianError::Trajectory`] for a period or duration that is not positive and finite, or for too many samples.
pub fn straight_ways(
    arm: &SphericalWrist,
    start: &[f64; 6],
    poses: &[Pose],
    durations: &[f64],
    period: f64,
) -> Result<Sampled<6>, CartesianError> {
    require_positive("period", period)?;
    if durations.len() != poses.len() {
        return Err(CartesianError::Trajectory(TrajectoryError::TooFew {
            what: "durations",
            needed: poses.len(),
            given: durations.len(),
        }));
    }
    let mut samples = vec![Sample::at_rest(*start)];
    let mut from = arm.screws().pose(start);
    let mut near = *start;
    for (k, (to, duration)) in poses.iter().zip(durations).enumerate() {
        require_positive("duration", *duration)?;
        let steps = require_periods(*duration, period)?.max(1);
        // The duration is a whole number of periods, so that each path ends in a sample.
        let way = Way::new(&from, to, steps as f64 * period)?;
        for step in 1..=steps {
            let time = step as f64 * period;
            let sample = way.sample(arm, time, &near, k)?;
            near = sample.positions;
            samples.push(sample);
        }
        from = *to;
    }
    Ok(Sampled::new(samples, period)?)
}

/// One straight path of the frame between two poses.
struct Way {
    from: Vector3<f64>,
    line: Vector3<f64>,
    rotation: Matrix3<f64>,
    /// Rotation axis times angle (rad), in the base frame.
    turn: Vector3<f64>,
    course: RestToRest<1>,
}

impl Way {
    fn new(from: &Pose, to: &Pose, duration: f64) -> Result<Self, TrajectoryError> {
        let matrix = |pose: &Pose| Matrix3::from_fn(|i, j| pose.1[i][j]);
        let rotation = matrix(from);
        let turn = Rotation3::from_matrix_unchecked(matrix(to) * rotation.transpose());
        Ok(Self {
            from: Vector3::from(from.0),
            line: Vector3::from(to.0) - Vector3::from(from.0),
            rotation,
            turn: turn.scaled_axis(),
            course: RestToRest::new([0.0], [1.0], duration)?,
        })
    }

    fn sample(
        &self,
        arm: &SphericalWrist,
        time: f64,
        near: &[f64; 6],
        pose: usize,
    ) -> Result<Sample<6>, CartesianError> {
        let course = self.course.sample(time);
        let s = course.positions[0];
        let rotation = Rotation3::new(self.turn * s).into_inner() * self.rotation;
        let target = (
            (self.from + self.line * s).into(),
            core::array::from_fn(|i| core::array::from_fn(|j| rotation[(i, j)])),
        );
        let solution = arm
            .solve(&target, near)
            .map_err(|source| CartesianError::WayUnreachable { pose, time, source })?
            .closest(near);
        if let Some(singularity) = solution.singularities().next() {
            return Err(CartesianError::Singular { pose, time, singularity });
        }
        for joint in 0..6 {
            let step = solution.positions[joint] - near[joint];
            if step.abs() > LARGEST_STEP {
                return Err(CartesianError::Jump { pose, time, joint, step });
            }
        }
        let frame = |rate: f64| -> [f64; 6] {
            core::array::from_fn(|i| if i < 3 { self.line[i] * rate } else { self.turn[i - 3] * rate })
        };
        let (velocity, acceleration) = (frame(course.velocities[0]), frame(course.accelerations[0]));
        let (velocities, accelerations) =
            arm.screws()
                .rates(&solution.positions, &velocity, &acceleration)
                .ok_or(CartesianError::Singular { pose, time, singularity: Singularity::Elbow })?;
        Ok(Sample { positions: solution.positions, velocities, accelerations })
    }
}
