//! Joints with quaternions in a mechanism.
//!
//! Such a joint is a chain of bodies, one for each velocity, of which the last has the mass and carries the
//! others. All of them stand at zero: the pose that the positions give lies before the first, and their motions
//! are those of the joint in its body's own frame.

use nalgebra::{Matrix3, Vector3 as Numeric3};

use crate::graph::{Graph, Scalar};
use crate::model::{Model, QuaternionJoint, QuaternionKind};
use crate::spatial::{Attitude, Pose, Vector3};

/// The place of a body in the chain of a joint with a quaternion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChainPlace {
    /// The first body of the chain.
    pub first: usize,
    /// The last one.
    pub last: usize,
    /// The axis of the body's motion in the frame of the last: 0, 1, 2 for x, y, z.
    pub axis: usize,
}

/// Where the joint of a velocity stands; `None` for joints without a quaternion.
///
/// - `index`: of the body, in a list where the chain stands together
pub(super) fn chain_place(model: &Model, coordinate: usize, index: usize) -> Option<ChainPlace> {
    let joint = model.quaternion_joint_of(coordinate)?;
    let place = coordinate - joint.first;
    let first = index - place;
    Some(ChainPlace { first, last: first + joint.kind.velocities() - 1, axis: place % 3 })
}

/// Every chain begins with a motion along or about x.
const FIRST: usize = 0;

/// The axes of the described frame that are x, y, z of the body that moves along this one.
fn axes(axis: usize) -> [usize; 3] {
    [(axis + 1) % 3, (axis + 2) % 3, axis]
}

/// The frame of a body in a chain, in that of the link: z along its motion.
pub(super) fn frame(graph: &Graph, place: ChainPlace) -> Pose<Scalar<'_>> {
    let columns =
        axes(place.axis).map(|axis| Numeric3::from_fn(|row, _| if row == axis { 1.0 } else { 0.0 }));
    Pose { rotation: Matrix3::from_columns(&columns), ..Pose::identity(graph) }
}

/// Displacement of the first body of a joint's chain by the joint's positions.
pub(super) struct Displaced<'g> {
    /// Rotation between the frames of that body without and with the positions.
    pub attitude: Attitude<Scalar<'g>>,
    /// Origin in the described frame of the joint; `None` if the joint does not slide.
    pub origin: Option<Vector3<Scalar<'g>>>,
}

/// The displacement of a joint. The positions are entries of the first array of the graph's inputs, as those of
/// every function that has them.
pub(super) fn displaced<'g>(graph: &'g Graph, model: &Model, joint: &QuaternionJoint) -> Displaced<'g> {
    let entries = position_entries(graph, model, joint);
    Displaced {
        attitude: Attitude::of_quaternion(entries.quaternion).permuted(axes(FIRST)),
        origin: entries.origin,
    }
}

/// The position entries of a joint.
pub struct PositionEntries<'g> {
    /// Position of the origin, where the joint slides.
    pub origin: Option<Vector3<Scalar<'g>>>,
    /// The quaternion x y z w.
    pub quaternion: [Scalar<'g>; 4],
}

/// The entries of y that belong to a joint.
pub fn position_entries<'g>(graph: &'g Graph, model: &Model, joint: &QuaternionJoint) -> PositionEntries<'g> {
    let first = model.first_position(joint.first);
    let entry = |k: usize| graph.input(POSITIONS, first + k);
    PositionEntries {
        origin: (joint.kind == QuaternionKind::Floating).then(|| Vector3([0, 1, 2].map(entry))),
        quaternion: [0, 1, 2, 3].map(|k| entry(joint.kind.quaternion() + k)),
    }
}

/// The array of inputs that holds the positions.
pub const POSITIONS: usize = 0;
