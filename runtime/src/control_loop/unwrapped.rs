//! Positions by velocity entry, so that guard, filter and limits can subtract them.

use super::law::JointLaw;
use crate::dynamics::plain_positions;

/// Positions, and coordinates with which they can be told apart joint by joint.
///
/// The coordinates of joints without quaternion are their positions. Those of a joint with one are the sum of the
/// differences `y ⊖ y_before` from one pose to the next: their rate is v, and no turn makes them jump. They say nothing of
/// where the joint is, only of how it moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unwrapped<const N: usize, const NY: usize> {
    pub positions: [f64; NY],
    pub coordinates: [f64; N],
}

impl<const N: usize, const NY: usize> Unwrapped<N, NY> {
    /// Coordinates of joints with a quaternion begin at 0.
    pub fn at<const M: usize>(positions: [f64; NY], law: &impl JointLaw<N, M, NY>) -> Self {
        Self { positions, coordinates: plain_positions(law.quaternion_joints(), &positions) }
    }

    /// The same at other positions, where the robot or its reference has moved.
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
