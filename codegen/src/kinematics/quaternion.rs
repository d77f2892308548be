//! Joints with quaternions in a mechanism.
//!
//! A joint with a quaternion is a chain of bodies, one per velocity. The last body has the mass and carries
//! other bodies. All joints of the chain are at position 0, because the pose given by the position entries
//! comes before the first body. The velocities are velocities of the last body in the frame of this body.

use nalgebra::{Matrix3, Vector3 as Numeric3};

use crate::graph::{Graph, Scalar};
use crate::model::{Model, QuaternionJoint, QuaternionKind};
use crate::spatial::{Attitude, Pose, Vector3};

/// Place of a body in the chain of bodies that replaces a joint with a quaternion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChainPlace {
    /// Index of the first body of the chain.
    pub first: usize,
    /// Index of the last body of the chain.
    pub last: usize,
    /// Axis of the body's motion in the frame of the last body: 0, 1, 2 for x, y, z.
    pub axis: usize,
}

/// Place in the chain of the body that belongs to a coordinate; `None` for joints without a quaternion.
///
/// - `index`: index of the body in a list that contains the chain
pub(super) fn chain_place(model: &Model, coordinate: usize, index: usize) -> Option<ChainPlace> {
    let joint = model.quaternion_joint_of(coordinate)?;
    let place = coordinate - joint.first;
    let first = index - place;
    Some(ChainPlace { first, last: first + joint.kind.velocities() - 1, axis: place % 3 })
}

/// Axis along or about which the first body of every joint with a quaternion moves: x.
const FIRST: usize = 0;

/// Axes of the description's frame that become the axes x, y, z of the body that moves along or about `axis`.
fn axes(axis: usize) -> [usize; 3] {
    [(axis + 1) % 3, (axis + 2) % 3, axis]
}

/// Frame of a body that replaces one velocity of a joint with a quaternion, in the link's frame. z is along
/// the body's motion.
pub(super) fn frame(graph: &Graph, place: ChainPlace) -> Pose<Scalar<'_>> {
    let columns =
        axes(place.axis).map(|axis| Numeric3::from_fn(|row, _| if row == axis { 1.0 } else { 0.0 }));
    Pose { rotation: Matrix3::from_columns(&columns), ..Pose::identity(graph) }
}

/// Displacement by the position entries of a joint with a quaternion, applied at the joint's first body.
pub(super) struct Displaced<'g> {
    /// Rotation of the first body's frame by the quaternion.
    pub attitude: Attitude<Scalar<'g>>,
    /// Origin of the moved body in the joint's frame of the description; `None` for a spherical joint.
    pub origin: Option<Vector3<Scalar<'g>>>,
}

/// Displacement by the position entries of a joint with a quaternion. The entries belong to the first input
/// array, which all functions with positions have.
pub(super) fn displaced<'g>(graph: &'g Graph, model: &Model, joint: &QuaternionJoint) -> Displaced<'g> {
    let entries = position_entries(graph, model, joint);
    Displaced {
        attitude: Attitude::of_quaternion(entries.quaternion).permuted(axes(FIRST)),
        origin: entries.origin,
    }
}

/// Position entries of a joint with a quaternion.
pub struct PositionEntries<'g> {
    /// Position of the body's origin in the parent's frame; `None` for a spherical joint.
    pub origin: Option<Vector3<Scalar<'g>>>,
    /// The unit quaternion x y z w of the joint's rotation.
    pub quaternion: [Scalar<'g>; 4],
}

/// The position entries that belong to a joint with a quaternion, as inputs of the graph.
pub fn position_entries<'g>(graph: &'g Graph, model: &Model, joint: &QuaternionJoint) -> PositionEntries<'g> {
    let first = model.first_position(joint.first);
    let entry = |k: usize| graph.input(POSITIONS, first + k);
    PositionEntries {
        origin: (joint.kind == QuaternionKind::Floating).then(|| Vector3([0, 1, 2].map(entry))),
        quaternion: [0, 1, 2, 3].map(|k| entry(joint.kind.quaternion() + k)),
    }
}

/// Index of the input array that contains the positions.
pub const POSITIONS: usize = 0;
