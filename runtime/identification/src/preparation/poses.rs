//! Smoothing of the poses of joints with a quaternion.
//!
//! The path of a joint is the sum of its displacements `y ⊖ y_before` from sample to sample. Paths are smoothed like the
//! positions of other joints, and the time derivatives of the paths are the velocities. A path does not determine the pose.
//! Therefore a smoothed pose is the nearest measured pose, moved by the difference between the smoothed and the measured
//! path at this sample. The difference is at most the noise plus the motion in half a period. Because it is small, its
//! rotations nearly commute.

use super::super::pose::QuaternionJoint;
use super::super::run::Run;
use super::channel::{Channel, nearest};

/// Measured poses and path of a joint, for each sample that is not a spike.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PoseSignal {
    joint: QuaternionJoint,
    times: Vec<f64>,
    poses: Vec<Vec<f64>>,
    ways: Vec<Vec<f64>>,
}

impl PoseSignal {
    /// The measured poses of a joint without spikes and missing values.
    ///
    /// - `channels`: path of the joint, one channel for each velocity
    pub(super) fn new(joint: &QuaternionJoint, run: &Run, channels: &[Channel]) -> Self {
        let row = |columns: &[Vec<f64>], i: usize| columns.iter().map(|c| c[i]).collect::<Vec<f64>>();
        let pose = |i: usize| row(&run.poses[joint.positions()], i);
        let way = |i: usize| row(&run.positions[joint.velocities()], i);
        let is_spike = |i: &usize| channels.iter().any(|channel| channel.spikes.contains(i));
        let is_known = |i: &usize| pose(*i).iter().chain(&way(*i)).all(|x| x.is_finite());
        let kept: Vec<usize> = (0..run.times.len()).filter(|i| is_known(i) && !is_spike(i)).collect();
        Self {
            joint: joint.clone(),
            times: kept.iter().map(|i| run.times[*i]).collect(),
            poses: kept.iter().map(|i| pose(*i)).collect(),
            ways: kept.iter().map(|i| way(*i)).collect(),
        }
    }

    /// Writes the poses at `times` to the columns of the robot's positions y. The other columns are already
    /// filled.
    ///
    /// - `positions`: smoothed positions or paths, one column for each velocity of the robot
    pub(super) fn write(&self, times: &[f64], positions: &[Vec<f64>], y: &mut [Vec<f64>]) {
        for (i, time) in times.iter().enumerate() {
            let nearest = nearest(&self.times, *time);
            let smoothed = positions[self.joint.velocities()].iter().map(|column| column[i]);
            let left: Vec<f64> =
                smoothed.zip(&self.ways[nearest]).map(|(smoothed, way)| smoothed - way).collect();
            let pose = self.joint.moved(&self.poses[nearest], &left);
            y[self.joint.positions()].iter_mut().zip(pose).for_each(|(column, entry)| column[i] = entry);
        }
    }
}
