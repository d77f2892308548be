//! What was skipped or changed in a URDF: one note for each kind.

use super::notes;
use crate::diagnostic::Severity;

/// Elements that never enter the dynamics; they share one note.
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
    LimitMissing,
    LimitUnset,
    LimitUnusable,
    PlanarLimits,
    ReductionIgnored,
    SphericalWithoutDrive,
}

impl notes::Remark for Remark {
    fn code(self) -> &'static str {
        match self {
            Self::AxisMissing => "axis-missing",
            Self::AxisNormalized => "axis-normalized",
            Self::ContinuousLimits => "continuous-limits",
            Self::DuplicateElement => "duplicate-element",
            Self::EmptyInertial => "empty-inertial",
            Self::LimitMissing => "limit-missing",
            Self::LimitUnset => "limit-unset",
            Self::LimitUnusable => "limit-unusable",
            Self::PlanarLimits => "planar-limits",
            Self::ReductionIgnored => "transmission-ignored",
            Self::SphericalWithoutDrive => "spherical-without-drive",
        }
    }

    fn severity(self) -> Severity {
        match self {
            Self::AxisMissing | Self::DuplicateElement | Self::EmptyInertial | Self::LimitUnusable => {
                Severity::Warning
            }
            _ => Severity::Note,
        }
    }

    fn text(self) -> &'static str {
        match self {
            Self::AxisMissing => "an <axis> without `xyz` was taken as x",
            Self::AxisNormalized => "axes were brought to length 1",
            Self::ContinuousLimits => {
                "continuous joints turn without end; their position limits were not taken"
            }
            Self::DuplicateElement => "of several elements of one kind the first was taken",
            Self::EmptyInertial => "links whose <inertial> says nothing have no mass",
            Self::LimitMissing => {
                "joints without a <limit> have none here; ROS refuses such revolute and prismatic joints"
            }
            Self::LimitUnset => "limits that are 0, equal or infinite were taken as not given",
            Self::LimitUnusable => "limits that are reversed or negative were taken as not given",
            Self::PlanarLimits => {
                "limits of joints with several degrees of freedom say not of which motion and were not taken; a TOML file gives them \
                 to the parts"
            }
            Self::ReductionIgnored => "mechanical reductions were ignored, drives are ideal",
            Self::SphericalWithoutDrive => {
                "spherical joints of a URDF have no drive, and so no input; a TOML file gives them some (`drive = \"ideal\"`)"
            }
        }
    }
}
