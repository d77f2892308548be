//! Unwrapped coordinates with one entry for each velocity. Guard, filter and limits can subtract them.

use super::law::JointLaw;
use crate::dynamics::plain_positions;

/// Positions, and unwrapped coordinates that can be subtracted.
///
/// For joints without quaternions the coordinates are the positions. For a joint with a quaternion they are
/// the sum of the differences `y ⊖ y_before` between consecutive poses. Their rate is v, and they never jump.
/// They describe only the motion, not the pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unwrapped<const N: usize, const NY: usize> {
    pub positions: [f64; NY],
    pub coordinates: [f64; N],
}

impl<const N: usize, const NY: usize> Unwrapped<N, NY> {
    /// Returns the coordinates at the start of the loop. They are 0 for joints with quaternions.
    pub fn at<const M: usize>(positions: [f64; NY], law: &impl JointLaw<N, M, NY>) -> Self {
        Self { positions, coordinates: plain_positions(law.quaternion_joints(), &positions) }
    }

    /// Returns the coordinates after a motion from the present positions to `positions`.
    pub fn moved_to<const M: usize>(&self, positions: &[f64; NY], law: &impl JointLaw<N, M, NY>) -> Self {
        let mut coordinates: [f64; N] = plain_positions(law.quaternion_joints(), positions);
        if N != NY {
            let way = law.difference(&self.positions, positions);
            for joint in law.quaternion_joints() {
                for i in joint.velocity..joint.angular_velocity() + 3 {
                    coordinates[i] = self.coordinates[i] + way[i];
                }
            }
        }
        Self { positions: *positions, coordinates }
    }
}
