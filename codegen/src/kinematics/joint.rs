//! Types of moving joints, as used by the recursions.

use crate::graph::Scalar;
use crate::model::JointKind;
use crate::spatial::{Force, Motion, Vector3};

/// Motion of a joint's body per unit velocity, in the frame after the joint: a column of the motion subspace
/// S (Featherstone 2008, section 3.5). z is the axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointAxis {
    /// Rotation about z.
    Revolute,
    /// Translation along z.
    Prismatic,
}

impl JointAxis {
    /// Elementary motions of a joint kind from the base outwards, each with its rate per unit of the joint's
    /// velocity.
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

    /// Whether the joint's velocity is an angular one.
    pub fn turns(self) -> bool {
        self == Self::Revolute
    }

    /// S: unit motion of the joint about the origin of its body.
    pub fn unit_motion(self, any: Scalar<'_>) -> Motion<'_> {
        let zero = any.constant(0.0);
        self.along(Vector3([zero, zero, any.constant(1.0)]), Vector3::zero(any))
    }

    /// S with this axis, about a point; the body's origin is at `origin` relative to it.
    pub fn along<'g>(self, axis: Vector3<Scalar<'g>>, origin: Vector3<Scalar<'g>>) -> Motion<'g> {
        match self {
            Self::Revolute => Motion { angular: axis, linear: origin.cross(axis) },
            Self::Prismatic => Motion { angular: Vector3::zero(axis[0]), linear: axis },
        }
    }

    /// `Sᵀ f`: generalized force of a force on the body, about the body's origin and in its frame.
    pub fn force(self, f: Force<'_>) -> Scalar<'_> {
        match self {
            Self::Revolute => f.moment[2],
            Self::Prismatic => f.force[2],
        }
    }
}
