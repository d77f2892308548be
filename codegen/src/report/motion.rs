//! Positions along a smooth way, for differences.

use crate::model::{JointPosition, Model, QuaternionJoint, QuaternionKind};
use nalgebra::Quaternion;

/// Positions on a smooth way that begins at `y` with these velocities, after the time `by`: attitudes turn by the
/// rotation vector, origins move straight.
pub(super) fn moved(model: &Model, y: &[f64], by: f64, velocities: &[f64]) -> Vec<f64> {
    let mut moved = y.to_vec();
    for joint in model.joint_positions() {
        match joint {
            JointPosition::Coordinate(coordinate) => {
                moved[model.first_position(coordinate)] += by * velocities[coordinate];
            }
            JointPosition::Quaternion(joint) => {
                let first = model.first_position(joint.first);
                let entries = first..first + joint.kind.positions();
                move_body(&mut moved[entries], joint.kind, by, &velocities[joint.coordinates()]);
            }
        }
    }
    moved
}

/// The position entries of one joint after the time `by`.
fn move_body(entries: &mut [f64], kind: QuaternionKind, by: f64, velocities: &[f64]) {
    let (origin, attitude) = entries.split_at_mut(kind.quaternion());
    let q = Quaternion::new(attitude[3], attitude[0], attitude[1], attitude[2]);
    let (linear, turn) = velocities.split_at(kind.quaternion());
    if let ([x, y, z], &[a, b, c]) = (origin, linear) {
        // The linear velocity is one in the axes of the body: R v is the vector part of q v q*.
        let along = q * Quaternion::new(0.0, a, b, c) * q.conjugate();
        (*x, *y, *z) = (*x + by * along.i, *y + by * along.j, *z + by * along.k);
    }
    let [x, y, z, w] = QuaternionJoint::attitude([0, 1, 2].map(|k| by * turn[k]));
    let turned = q * Quaternion::new(w, x, y, z);
    attitude.copy_from_slice(&[turned.i, turned.j, turned.k, turned.w]);
}
