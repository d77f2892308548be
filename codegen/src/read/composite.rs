//! Joints with several degrees of freedom, read as a chain of joints with massless links between them.

use crate::description::{DriveChoice, JointDescription, Name, PartOf};
use crate::diagnostic::At;
use crate::model::{JointKind, Pose, QuaternionKind};

/// A joint with several degrees of freedom, which is read as a chain of joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Composite {
    /// Rotation about the joint's axis and translation along it.
    Cylindrical,
    /// Rotation about the x axis of the joint's frame, then about the y axis.
    Universal,
    /// Translation along two directions of a plane, then rotation about its normal.
    Planar,
    /// A joint with a quaternion. It is read as one joint for each of its velocities in the body's own frame.
    Quaternion(QuaternionKind),
}

/// One of the joints as which a joint with several degrees of freedom is read.
#[derive(Debug)]
pub(crate) struct Part {
    /// Suffix of the part's joint name, and key of its values in tables of the joint, for example `turn`.
    pub name: &'static str,
    pub kind: JointKind,
    axis: PartAxis,
}

/// Axis of one part of the joint, in a frame whose z axis is the axis of the whole joint.
#[derive(Debug, Clone, Copy)]
enum PartAxis {
    X,
    Y,
    Z,
}

const CYLINDRICAL: &[Part] = &[
    Part { name: "turn", kind: JointKind::Revolute, axis: PartAxis::Z },
    Part { name: "slide", kind: JointKind::Prismatic, axis: PartAxis::Z },
];
const UNIVERSAL: &[Part] = &[
    Part { name: "x", kind: JointKind::Revolute, axis: PartAxis::X },
    Part { name: "y", kind: JointKind::Revolute, axis: PartAxis::Y },
];
const PLANAR: &[Part] = &[
    Part { name: "x", kind: JointKind::Prismatic, axis: PartAxis::X },
    Part { name: "y", kind: JointKind::Prismatic, axis: PartAxis::Y },
    Part { name: "theta", kind: JointKind::Revolute, axis: PartAxis::Z },
];
const FLOATING: &[Part] = &[
    Part { name: "x", kind: JointKind::Prismatic, axis: PartAxis::X },
    Part { name: "y", kind: JointKind::Prismatic, axis: PartAxis::Y },
    Part { name: "z", kind: JointKind::Prismatic, axis: PartAxis::Z },
    Part { name: "rx", kind: JointKind::Continuous, axis: PartAxis::X },
    Part { name: "ry", kind: JointKind::Continuous, axis: PartAxis::Y },
    Part { name: "rz", kind: JointKind::Continuous, axis: PartAxis::Z },
];

impl Composite {
    pub const ALL: [Self; 5] = [
        Self::Cylindrical,
        Self::Universal,
        Self::Planar,
        Self::Quaternion(QuaternionKind::Spherical),
        Self::FLOATING,
    ];

    /// A floating joint, with three translations and a rotation.
    pub const FLOATING: Self = Self::Quaternion(QuaternionKind::Floating);

    /// Type of the joint with a quaternion; `None` for other joints.
    pub fn quaternion(self) -> Option<QuaternionKind> {
        match self {
            Self::Quaternion(kind) => Some(kind),
            _ => None,
        }
    }

    /// The joint type with this name; `None` if it is not a type with several degrees of freedom.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|composite| composite.name() == name)
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Cylindrical => "cylindrical",
            Self::Universal => "universal",
            Self::Planar => "planar",
            Self::Quaternion(kind) => kind.name(),
        }
    }

    /// The chain of joints that replaces this joint, from the base outwards.
    pub fn parts(self) -> &'static [Part] {
        match self {
            Self::Cylindrical => CYLINDRICAL,
            Self::Universal => UNIVERSAL,
            Self::Planar => PLANAR,
            Self::Quaternion(QuaternionKind::Floating) => FLOATING,
            Self::Quaternion(QuaternionKind::Spherical) => &FLOATING[3..],
        }
    }

    /// List of the names of the joint's parts, for messages.
    pub fn listed(self) -> String {
        let names: Vec<String> = self.parts().iter().map(|part| format!("`{}`", part.name)).collect();
        names.join(", ")
    }
}

/// Pose and links of a joint with several degrees of freedom.
#[derive(Debug)]
pub(crate) struct Place {
    pub parent: Option<Name>,
    pub child: Option<Name>,
    pub origin: Option<Pose>,
    pub axis: [f64; 3],
}

/// The chain of joints as which a joint with several degrees of freedom is read. The first joint of the chain
/// has the pose of the whole joint. The last joint carries its link.
///
/// - `values`: returns the joint of a part with this name, with limits, drive, friction and spring
pub(crate) fn expand(
    composite: Composite,
    name: &Name,
    place: Place,
    mut values: impl FnMut(&'static Part, Name) -> JointDescription,
) -> Vec<JointDescription> {
    let mut carrier = place.parent;
    let mut origin = place.origin;
    let last = place.child.unwrap_or_else(|| name.clone());
    let parts = composite.parts();
    let mut joints = Vec::with_capacity(parts.len());
    for (index, part) in parts.iter().enumerate() {
        // A velocity of a joint with a quaternion has a drive only if the description has one.
        let passive = || composite.quaternion().map(|_| At::new(DriveChoice::Passive, name.span));
        let own = At::new(format!("{}_{}", name.value, part.name), name.span);
        let link = if index + 1 == parts.len() { last.clone() } else { own.clone() };
        let values = values(part, own);
        joints.push(JointDescription {
            kind: Some(part.kind),
            parent: carrier.replace(link.clone()),
            child: Some(link),
            origin: origin.take(),
            axis: Some(part.axis.along(place.axis)),
            part_of: composite.quaternion().map(|kind| PartOf { joint: name.clone(), kind, index }),
            leads_on: index + 1 < parts.len(),
            drive: values.drive.or_else(passive),
            ..values
        });
    }
    joints
}

impl PartAxis {
    /// The axis of the part in the joint's frame. `z` is the axis of the joint.
    ///
    /// The axes x and y of the joint's frame are rotated by the shortest rotation from e_z to z:
    /// `R = 1 + [w]ₓ + [w]ₓ² / (1 + c)` with w = e_z × z, c = e_z · z. If z is opposite to e_z, they are
    /// rotated by 180° about x.
    fn along(self, z: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = z;
        let below = 1.0 + c;
        let axis = match self {
            Self::Z => z,
            Self::X if below < OPPOSITE => [1.0, 0.0, 0.0],
            Self::Y if below < OPPOSITE => [0.0, -1.0, 0.0],
            Self::X => [1.0 - a * a / below, -a * b / below, -a],
            Self::Y => [-a * b / below, 1.0 - b * b / below, -b],
        };
        axis.map(|x| x + 0.0) // −0 becomes 0
    }
}

/// If 1 + cos of the angle between the axis and e_z is smaller than this value, the axis is opposite to e_z
/// up to rounding.
const OPPOSITE: f64 = 1e-12;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_of_a_plane_are_right_handed_with_its_normal() {
        for z in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.6, 0.0, -0.8], [0.48, -0.6, 0.64]] {
            let [x, y, normal] = [PartAxis::X, PartAxis::Y, PartAxis::Z].map(|axis| axis.along(z));
            let cross = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
            for k in 0..3 {
                assert!((cross[k] - z[k]).abs() < 1e-15, "{z:?}: {x:?} × {y:?} is {cross:?}");
            }
            let length: f64 = x.iter().map(|x| x * x).sum();
            assert!((length - 1.0).abs() < 1e-15, "{z:?}: {x:?}");
            assert_eq!(normal, z);
        }
    }
}
