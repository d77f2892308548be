//! Spherical and floating joints, whose positions do not form a vector space.

use super::{Model, MovingJoint};

/// A spherical or floating joint. Its orientation is a unit quaternion, so the joint has one more position
/// entry than velocities.
///
/// In the model, the joint is a series of joints with one velocity each. The pose of the body comes before
/// these joints, and all of them stay at position 0. Their velocities are therefore the velocities of the
/// whole joint in the frame of its body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct QuaternionJoint {
    /// Name of the joint in the description.
    pub name: String,
    /// Type of the joint: spherical or floating.
    pub kind: QuaternionKind,
    /// Index of the coordinate of the joint's first velocity. The coordinates of its other velocities follow.
    pub first: usize,
}

/// Type of a joint with a quaternion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum QuaternionKind {
    /// A spherical joint. Its velocity is the angular velocity in the frame of its body.
    Spherical,
    /// A floating joint. Its velocity is the linear velocity of the body's origin, then the angular velocity.
    /// Both are in the frame of the body.
    Floating,
}

/// Help text, which says that force laws at a velocity of a joint with a quaternion cannot depend on a
/// position.
pub(crate) const NO_LAW_OF_POSITION: &str = "a law at such a velocity may depend only on `v`, because the \
                                             velocity has no position; for springs in any direction use \
                                             `[[forces]]` between two frames";

/// Help text, which says that a velocity of a joint with a quaternion has no rotor.
pub(crate) const NO_ROTOR: &str = "a rotor turns about one axis, but this joint turns about three: use `drive = \
                                   \"ideal\"` for a torque in the body's frame, and a link with its own \
                                   joint for a reaction wheel";

impl QuaternionKind {
    /// Help text, which says that a velocity of this joint has no position limits. Generated limits have one
    /// entry per velocity, but the position entries are a quaternion.
    pub(crate) fn why_unlimited(self, index: usize) -> &'static str {
        match self {
            Self::Floating if index < 3 => {
                "this velocity is along an axis of the turning body, so no position entry belongs to it: \
                 limit the position through the desired motion; limits of velocity and effort are available"
            }
            _ => {
                "the attitude is a quaternion, so it has no position limits; limits of velocity and effort are available"
            }
        }
    }

    /// Help text on how to hold the whole joint, because a part of the joint cannot be held.
    pub(crate) fn how_to_hold(self) -> &'static str {
        match self {
            Self::Spherical => "a single velocity cannot be held: give the joint the type \"fixed\"",
            Self::Floating => {
                "a single velocity cannot be held: leave the base fixed, or give the joint the type \
                 \"fixed\" if it is not the base"
            }
        }
    }

    /// Number of the joint's velocities: 3 for a spherical, 6 for a floating joint.
    #[must_use]
    pub fn velocities(self) -> usize {
        match self {
            Self::Spherical => 3,
            Self::Floating => 6,
        }
    }

    /// Number of the joint's position entries: 4 for a quaternion x y z w, and 3 more for the position of the
    /// origin of a floating joint, which precedes the quaternion.
    #[must_use]
    pub fn positions(self) -> usize {
        self.velocities() + 1
    }

    /// Name of the joint type in descriptions: `spherical` or `floating`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Spherical => "spherical",
            Self::Floating => "floating",
        }
    }

    /// Index of the quaternion's first entry among the joint's position entries.
    #[must_use]
    pub fn quaternion(self) -> usize {
        match self {
            Self::Spherical => 0,
            Self::Floating => 3,
        }
    }

    /// Suffixes of the names of the joint's position entries, for example `qx`.
    #[must_use]
    pub fn position_names(self) -> &'static [&'static str] {
        const NAMES: [&str; 7] = ["x", "y", "z", "qx", "qy", "qz", "qw"];
        &NAMES[3 - self.quaternion()..]
    }
}

impl QuaternionJoint {
    /// Unit quaternion x y z w of a rotation vector in rad.
    pub(crate) fn attitude(turn: [f64; 3]) -> [f64; 4] {
        let angle = turn.iter().map(|x| x * x).sum::<f64>().sqrt();
        let (sine, cosine) = crate::numeric::sin_cos(angle / 2.0);
        let share = if angle == 0.0 { 0.5 } else { sine / angle };
        [turn[0] * share, turn[1] * share, turn[2] * share, cosine]
    }

    /// Indices of the coordinates of the joint's velocities.
    #[must_use]
    pub fn coordinates(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.kind.velocities()
    }
}

/// A joint with the position entries that belong to it.
#[derive(Debug, Clone, Copy)]
pub enum JointPosition<'m> {
    /// A joint with one position entry, given by its coordinate.
    Coordinate(usize),
    /// A joint with a quaternion, which has several position entries.
    Quaternion(&'m QuaternionJoint),
}

/// A joint that carries a link of the description.
#[derive(Debug, Clone)]
pub struct CarryingJoint<'m> {
    /// Name of the joint in the description.
    pub name: &'m str,
    /// Index of the joint among the moving joints.
    pub index: usize,
    /// The joint. For a joint with a quaternion, this is the joint of its last velocity.
    pub moving: MovingJoint<'m>,
}

impl Model {
    /// Number of position entries of the robot. It is the constant `NY` of generated modules.
    #[must_use]
    pub fn position_count(&self) -> usize {
        self.coordinates.len() + self.quaternion_joints.len()
    }

    /// Index of the position entry of a coordinate; `None` if the coordinate belongs to a joint with a
    /// quaternion.
    #[must_use]
    pub fn position_of(&self, coordinate: usize) -> Option<usize> {
        self.quaternion_joint_of(coordinate).is_none().then(|| self.first_position(coordinate))
    }

    /// Index of the first position entry of the joint whose first velocity has this coordinate.
    #[must_use]
    pub fn first_position(&self, coordinate: usize) -> usize {
        coordinate + self.quaternion_joints.iter().filter(|joint| joint.first < coordinate).count()
    }

    /// The joint with a quaternion to which a coordinate belongs; `None` for other coordinates.
    #[must_use]
    pub fn quaternion_joint_of(&self, coordinate: usize) -> Option<&QuaternionJoint> {
        self.quaternion_joints.iter().find(|joint| joint.coordinates().contains(&coordinate))
    }

    /// The joints in the order of their position entries.
    pub fn joint_positions(&self) -> impl Iterator<Item = JointPosition<'_>> {
        (0..self.coordinates.len()).filter_map(|coordinate| match self.quaternion_joint_of(coordinate) {
            None => Some(JointPosition::Coordinate(coordinate)),
            Some(joint) => (joint.first == coordinate).then_some(JointPosition::Quaternion(joint)),
        })
    }

    /// The moving joints of the description, each once, in the order of the model. The model has one joint for
    /// each velocity of a joint with a quaternion. Only the last of them carries the link, so `index` is the
    /// index of the last velocity.
    #[must_use]
    pub fn carrying_joints(&self) -> Vec<CarryingJoint<'_>> {
        let moving = self.moving_joints().into_iter().enumerate();
        let carrying = moving.filter_map(|(index, moving)| {
            let name = match self.quaternion_joint_of(index) {
                Some(joint) if index + 1 < joint.coordinates().end => return None,
                Some(joint) => joint.name.as_str(),
                None => moving.joint.name.as_str(),
            };
            Some(CarryingJoint { name, index, moving })
        });
        carrying.collect()
    }

    /// Positions (one array of all entries) from one value per velocity. The values of a joint with a
    /// quaternion are the position (m) and the rotation vector (rad) of its body.
    pub(crate) fn positions_by(&self, values: &[f64]) -> Vec<f64> {
        let mut positions = Vec::with_capacity(self.position_count());
        for joint in self.joint_positions() {
            match joint {
                JointPosition::Coordinate(coordinate) => positions.push(values[coordinate]),
                JointPosition::Quaternion(joint) => {
                    let values = &values[joint.coordinates()];
                    let (linear, turn) = values.split_at(joint.kind.quaternion());
                    positions.extend(linear);
                    positions.extend(QuaternionJoint::attitude([turn[0], turn[1], turn[2]]));
                }
            }
        }
        positions
    }
}
