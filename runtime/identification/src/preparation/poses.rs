//! Smoothed poses of joints with a quaternion.
//!
//! Their ways are smoothed like the positions of other joints, and the rates of the ways are the velocities. The ways do
//! not tell the pose: a smoothed pose is the nearest measured one, moved by how far the smoothed way is from the measured
//! one there. This is a step of noise and of half a sample, in which rotations commute to second order.

use super::super::pose::QuaternionJoint;
use super::super::run::Run;
use super::channel::Channel;

/// The measured poses of a joint and their path, for each sample that is not a spike.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PoseSignal {
    joint: QuaternionJoint,
    times: Vec<f64>,
    poses: Vec<Vec<f64>>,
    ways: Vec<Vec<f64>>,
}

impl PoseSignal {
    /// - `channels`: the joint's ways
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

    /// Writes the poses at `times` into the columns of y, which has all other entries.
    ///
    /// - `positions`: smoothed, for each velocity of the robot
    pub(super) fn write(&self, times: &[f64], positions: &[Vec<f64>], y: &mut [Vec<f64>]) {
        for (i, time) in times.iter().enumerate() {
            let nearest = self.nearest(*time);
            let smoothed = positions[self.joint.velocities()].iter().map(|column| column[i]);
            let left: Vec<f64> =
                smoothed.zip(&self.ways[nearest]).map(|(smoothed, way)| smoothed - way).collect();
            let pose = self.joint.moved(&self.poses[nearest], &left);
            y[self.joint.positions()].iter_mut().zip(pose).for_each(|(column, entry)| column[i] = entry);
        }
    }

    fn nearest(&self, time: f64) -> usize {
        let after = self.times.partition_point(|t| *t < time).min(self.times.len().saturating_sub(1));
        let before = after.saturating_sub(1);
        if time - self.times[before] < self.times[after] - time { before } else { after }
    }
}
