//! Skipped or changed parts of a URDF: one note or warning for each kind.

use super::foreign as urdf_foreign;
use crate::diagnostic::Severity;
use crate::read::skipped as notes;

/// Elements that do not enter the dynamics, except those that [`urdf_foreign`] knows; they share one note.
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

/// Something about a description that is worth a note, once for all places.
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
            Self::AxisNormalized => "axes and quaternions were brought to length 1",
            Self::ContinuousLimits => {
                "continuous joints turn without end; their position limits were not taken"
            }
            Self::DuplicateElement => "of several elements of one kind the first was taken",
            Self::Foreign(row) => urdf_foreign::text(row),
            Self::EmptyInertial => "links whose <inertial> is empty have no mass",
            Self::LimitMissing => {
                "joints without a <limit> have none here; ROS refuses such revolute and prismatic joints"
            }
            Self::LimitUnset => "limits that are 0 or infinite were taken as not given",
            Self::LimitUnusable => "limits that are reversed, equal or negative were taken as not given",
            Self::PlanarLimits => {
                "limits of joints with several degrees of freedom do not name the motion and were not read; describe them for the parts in a TOML file"
            }
            Self::ReductionIgnored => "mechanical reductions were ignored, inputs act at the joints",
            Self::RotorRead => {
                "rotors of transmissions were read as i² J at their joints, where the inputs act"
            }
            Self::Unknown => "unknown elements in the description of the dynamics were skipped",
            Self::SphericalWithoutDrive => {
                "spherical joints of a URDF have no drive, and so no input; a TOML file gives them some (`drive = \"ideal\"`)"
            }
        }
    }
}
