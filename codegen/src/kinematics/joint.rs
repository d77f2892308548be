//! Types of moving joints: the table that the recursions read.

use crate::graph::Scalar;
use crate::model::JointKind;
use crate::spatial::{Force, Motion, Vector3};

/// The motion that a joint's velocity gives its body, in the frame behind the joint: a column of its motion
/// subspace S (Featherstone 2008, section 3.5). z is the axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointAxis {
    /// Rotation about z.
    Revolute,
    /// Translation along z.
    Prismatic,
}

impl JointAxis {
    /// The motions that joints of a described kind consist of, from the base outwards, each with its rate for a
    /// unit of the joint's velocity.
    pub fn of(kind: JointKind) -> Vec<(Self, f64)> {
        match kind {
            JointKind::Revolute | JointKind::Continuous => vec![(Self::Revolute, 1.0)],
            JointKind::Prismatic => vec![(Self::Prismatic, 1.0)],
            // The turn stands last: what lies on its axis then moves to the slide, which only slides.
            JointKind::Helical { pitch } => vec![(Self::Prismatic, pitch), (Self::Revolute, 1.0)],
            JointKind::Fixed => vec![],
        }
    }

    /// The type's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Revolute => "revolute",
            Self::Prismatic => "prismatic",
        }
    }

    /// Whether the joint's velocity turns the body.
    pub fn turns(self) -> bool {
        self == Self::Revolute
    }

    /// S: the motion at a unit of the joint's velocity, about the origin of its body.
    pub fn unit_motion(self, any: Scalar<'_>) -> Motion<'_> {
        let zero = any.constant(0.0);
        self.along(Vector3([zero, zero, any.constant(1.0)]), Vector3::zero(any))
    }

    /// S with this axis, about a point from which the body's origin lies at `origin`.
    pub fn along<'g>(self, axis: Vector3<Scalar<'g>>, origin: Vector3<Scalar<'g>>) -> Motion<'g> {
        match self {
            Self::Revolute => Motion { angular: axis, linear: origin.cross(axis) },
            Self::Prismatic => Motion { angular: Vector3::zero(axis[0]), linear: axis },
        }
    }

    /// `Sᵀ f`: the generalized force of a force on the body, about its origin and in its frame, along the joint.
    pub fn force(self, f: Force<'_>) -> Scalar<'_> {
        match self {
            Self::Revolute => f.moment[2],
            Self::Prismatic => f.force[2],
        }
    }
}
