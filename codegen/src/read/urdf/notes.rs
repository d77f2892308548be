//! Notes and warnings about skipped or changed parts of a URDF, with one note for each kind.

use super::foreign as urdf_foreign;
use crate::diagnostic::Severity;
use crate::read::skipped as notes;

/// Elements that do not affect the dynamics, unless [`urdf_foreign`] knows their content. All of them share
/// one note.
pub(super) const HARMLESS: [&str; 14] = [
    "<visual>",
    "<collision>",
    "<material>",
    "<transmission>",
    "<ros2_control>",
    "<gazebo>",
    "<mujoco>",
    "<sensor>",
    "<contact>",
    "<safety_controller>",
    "<calibration>",
    "<self_filter>",
    "<collision_checking>",
    "<self_collision_checking>",
];

/// A kind of remark about a description. A kind gives one note for all its places.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Remark {
    AxisMissing,
    AxisNormalized,
    ContinuousLimits,
    DuplicateElement,
    EmptyInertial,
    Foreign(usize),
    LimitMissing,
    LimitUnset,
    LimitUnusable,
    PlanarLimits,
    ReductionIgnored,
    RotorRead,
    SphericalWithoutDrive,
    Unknown,
}

impl notes::Remark for Remark {
    fn code(self) -> &'static str {
        match self {
            Self::AxisMissing => "axis-missing",
            Self::AxisNormalized => "axis-normalized",
            Self::ContinuousLimits => "continuous-limits",
            Self::DuplicateElement => "duplicate-element",
            Self::EmptyInertial => "empty-inertial",
            Self::Foreign(_) => "dynamics-skipped",
            Self::LimitMissing => "limit-missing",
            Self::LimitUnset => "limit-unset",
            Self::LimitUnusable => "limit-unusable",
            Self::PlanarLimits => "planar-limits",
            Self::ReductionIgnored => "transmission-ignored",
            Self::RotorRead => "rotor-read",
            Self::Unknown => "unknown-tag",
            Self::SphericalWithoutDrive => "spherical-without-drive",
        }
    }

    fn severity(self) -> Severity {
        match self {
            Self::AxisMissing
            | Self::DuplicateElement
            | Self::EmptyInertial
            | Self::Foreign(_)
            | Self::LimitUnusable
            | Self::Unknown => Severity::Warning,
            _ => Severity::Note,
        }
    }

    fn text(self) -> &'static str {
        match self {
            Self::AxisMissing => "an <axis> without `xyz` was taken as x",
            Self::AxisNormalized => "axes and quaternions were normalized",
            Self::ContinuousLimits => "continuous joints have no position limits; those given were ignored",
            Self::DuplicateElement => "only the first of several elements of the same kind was used",
            Self::Foreign(row) => urdf_foreign::text(row),
            Self::EmptyInertial => "links with an empty <inertial> have no mass",
            Self::LimitMissing => {
                "joints without <limit> have no limits here; ROS rejects such revolute and prismatic joints"
            }
            Self::LimitUnset => "limits that are 0 or infinite were ignored",
            Self::LimitUnusable => "limits that are reversed, equal or negative were ignored",
            Self::PlanarLimits => {
                "limits of joints with several degrees of freedom were ignored, because they do not name a \
                 motion; describe them in a TOML file for each part"
            }
            Self::ReductionIgnored => "mechanical reductions were ignored; inputs act at the joints",
            Self::RotorRead => {
                "rotors of transmissions were read as i² J at their joints, where the inputs act"
            }
            Self::Unknown => "unknown elements of the dynamics were skipped",
            Self::SphericalWithoutDrive => {
                "spherical joints of a URDF have no drive and no input; add inputs in a TOML file (`drive = \"ideal\"`)"
            }
        }
    }
}
