//! Elementary joints of the recursive equations: rotation and translation.

use crate::graph::Scalar;
use crate::model::JointKind;
use crate::spatial::{Force, Motion, Vector3};

/// Elementary motion of a joint. It determines the motion of the joint's body per unit of velocity, in the
/// frame after the joint (Featherstone 2008, section 3.5). z is the joint's axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointAxis {
    /// Rotation about the z axis, the joint's axis.
    Revolute,
    /// Translation along the z axis, the joint's axis.
    Prismatic,
}

impl JointAxis {
    /// Elementary motions of a type of joint, from the base outwards. Each motion has its rate per unit of
    /// the joint's velocity.
    pub fn of(kind: JointKind) -> Vec<(Self, f64)> {
        match kind {
            JointKind::Revolute | JointKind::Continuous => vec![(Self::Revolute, 1.0)],
            JointKind::Prismatic => vec![(Self::Prismatic, 1.0)],
            // The rotation is last, so masses on its axis can be shifted to the slide, which only translates.
            JointKind::Helical { pitch } => vec![(Self::Prismatic, pitch), (Self::Revolute, 1.0)],
            JointKind::Fixed => vec![],
        }
    }

    /// Name of the elementary motion, for example `revolute`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Revolute => "revolute",
            Self::Prismatic => "prismatic",
        }
    }

    /// Whether the joint's velocity is an angular velocity.
    pub fn turns(self) -> bool {
        self == Self::Revolute
    }

    /// Motion of the joint's body per unit of velocity, about the body's origin.
    pub fn unit_motion(self, any: Scalar<'_>) -> Motion<'_> {
        let zero = any.constant(0.0);
        self.along(Vector3([zero, zero, any.constant(1.0)]), Vector3::zero(any))
    }

    /// Motion of the joint's body per unit of velocity, for a joint with the direction `axis`, about another
    /// point than the body's origin. `origin` is the vector from this point to the body's origin.
    pub fn along<'g>(self, axis: Vector3<Scalar<'g>>, origin: Vector3<Scalar<'g>>) -> Motion<'g> {
        match self {
            Self::Revolute => Motion { angular: axis, linear: origin.cross(axis) },
            Self::Prismatic => Motion { angular: Vector3::zero(axis[0]), linear: axis },
        }
    }

    /// Generalized force `Sᵀ f` of a spatial force f on the body, with the motion S per unit of the joint's
    /// velocity. f is about the body's origin and in the body's frame.
    pub fn force(self, f: Force<'_>) -> Scalar<'_> {
        match self {
            Self::Revolute => f.moment[2],
            Self::Prismatic => f.force[2],
        }
    }
}
