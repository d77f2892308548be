//! Joints whose positions do not form a vector space: spherical and floating ones.

use super::{Model, MovingJoint};

/// A spherical or floating joint. Its attitude is a unit quaternion, so it has one position entry more than
/// velocities.
///
/// The model describes it as a chain of joints with one degree of freedom each, one for every velocity, which
/// all stand at zero behind the joint's own pose: their motions are the joint's motions in its body's frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct QuaternionJoint {
    /// Name in the description.
    pub name: String,
    /// Whether it slides, too.
    pub kind: QuaternionKind,
    /// The coordinate of its first velocity; the others follow.
    pub first: usize,
}

/// Type of a joint with a quaternion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum QuaternionKind {
    /// It turns in all directions: the velocity is the angular velocity in the body's own frame.
    Spherical,
    /// It moves freely: the velocity is the linear velocity of the body's origin, then the angular velocity,
    /// both in the body's own frame.
    Floating,
}

/// Why a velocity has no law of a position.
pub(crate) const NO_LAW_OF_POSITION: &str = "a law of such a velocity is one of `v` alone: it has no position of its own; \
    `[[forces]]` between two frames are springs in any direction";

/// Why a velocity has no rotor.
pub(crate) const NO_ROTOR: &str = "a rotor turns about one axis, and this joint about all: `drive = \"ideal\"` is a torque in the body's \
    frame; a reaction wheel is a link with a joint of its own";

impl QuaternionKind {
    /// Why a velocity has no limits of a position. Limits stand by velocity in a module, and controllers take deviations
    /// along the velocities.
    pub(crate) fn why_unlimited(self, index: usize) -> &'static str {
        match self {
            Self::Floating if index < 3 => {
                "this velocity is along an axis of the body, which turns, so that no entry of the place belongs to it alone: keep the \
                 place within limits by the motion that is asked for; limits of velocity and effort are those that it can have"
            }
            _ => "its attitude is a quaternion: limits of velocity and effort are those that it can have",
        }
    }

    /// How to hold the joint, of which no part can be held.
    pub(crate) fn how_to_hold(self) -> &'static str {
        match self {
            Self::Spherical => "hold all of it: give the joint the type \"fixed\"",
            Self::Floating => {
                "hold all of it: leave the base fixed, or give the joint the type \"fixed\" where it is one of its own"
            }
        }
    }

    /// The number of velocities.
    #[must_use]
    pub fn velocities(self) -> usize {
        match self {
            Self::Spherical => 3,
            Self::Floating => 6,
        }
    }

    /// The number of position entries: a quaternion x y z w, behind the position of the origin where the joint is
    /// floating.
    #[must_use]
    pub fn positions(self) -> usize {
        self.velocities() + 1
    }

    /// The type as the format calls it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Spherical => "spherical",
            Self::Floating => "floating",
        }
    }

    /// Where the quaternion begins among the position entries of the joint.
    #[must_use]
    pub fn quaternion(self) -> usize {
        match self {
            Self::Spherical => 0,
            Self::Floating => 3,
        }
    }

    /// Names of the position entries, which follow the joint's name.
    #[must_use]
    pub fn position_names(self) -> &'static [&'static str] {
        const NAMES: [&str; 7] = ["x", "y", "z", "qx", "qy", "qz", "qw"];
        &NAMES[3 - self.quaternion()..]
    }
}

impl QuaternionJoint {
    /// The unit quaternion x y z w of a rotation vector.
    pub(crate) fn attitude(turn: [f64; 3]) -> [f64; 4] {
        let angle = turn.iter().map(|x| x * x).sum::<f64>().sqrt();
        let (sine, cosine) = crate::numeric::sin_cos(angle / 2.0);
        let share = if angle == 0.0 { 0.5 } else { sine / angle };
        [turn[0] * share, turn[1] * share, turn[2] * share, cosine]
    }

    /// The coordinates of its velocities.
    #[must_use]
    pub fn coordinates(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.kind.velocities()
    }
}

/// A joint among the positions.
#[derive(Debug, Clone, Copy)]
pub enum JointPosition<'m> {
    /// The position of this coordinate.
    Coordinate(usize),
    /// Several entries with a quaternion.
    Quaternion(&'m QuaternionJoint),
}

/// A joint that carries a described link.
#[derive(Debug, Clone)]
pub struct CarryingJoint<'m> {
    /// Name of the joint.
    pub name: &'m str,
    /// Its index among the moving joints.
    pub index: usize,
    /// The joint, or the last velocity of one with a quaternion.
    pub moving: MovingJoint<'m>,
}

impl Model {
    /// The number NY of position entries.
    #[must_use]
    pub fn position_count(&self) -> usize {
        self.coordinates.len() + self.quaternion_joints.len()
    }

    /// The position entry of a coordinate; `None` if it belongs to a quaternion.
    #[must_use]
    pub fn position_of(&self, coordinate: usize) -> Option<usize> {
        self.quaternion_joint_of(coordinate).is_none().then(|| self.first_position(coordinate))
    }

    /// The first position entry of the joint to which a coordinate belongs as its first.
    #[must_use]
    pub fn first_position(&self, coordinate: usize) -> usize {
        coordinate + self.quaternion_joints.iter().filter(|joint| joint.first < coordinate).count()
    }

    /// The joint with a quaternion to which a coordinate belongs.
    #[must_use]
    pub fn quaternion_joint_of(&self, coordinate: usize) -> Option<&QuaternionJoint> {
        self.quaternion_joints.iter().find(|joint| joint.coordinates().contains(&coordinate))
    }

    /// The joints in the order of the positions.
    pub fn joint_positions(&self) -> impl Iterator<Item = JointPosition<'_>> {
        (0..self.coordinates.len()).filter_map(|coordinate| match self.quaternion_joint_of(coordinate) {
            None => Some(JointPosition::Coordinate(coordinate)),
            Some(joint) => (joint.first == coordinate).then_some(JointPosition::Quaternion(joint)),
        })
    }

    /// The joints that carry a described link, each once: the moving joints, those with a quaternion by their last
    /// velocity.
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

    /// Positions y of NY entries from one value for each velocity. Those of a joint with a quaternion are the
    /// position and the rotation vector of its body.
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
