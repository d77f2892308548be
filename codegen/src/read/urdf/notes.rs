//! Notes and warnings about skipped or changed parts of a URDF, with one note for each kind.

use crate::read::skipped::Remark;

/// Elements that do not affect the dynamics, unless `foreign.rs` lists their content. All of them share one
/// note.
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

pub(super) const AXIS_MISSING: Remark =
    Remark::warning("axis-missing", "an <axis> without `xyz` was read as the x axis");
pub(super) const AXIS_NORMALIZED: Remark =
    Remark::note("axis-normalized", "axes and quaternions were normalized");
pub(super) const CONTINUOUS_LIMITS: Remark = Remark::note(
    "continuous-limits",
    "continuous joints have no position limits. The given limits were ignored",
);
pub(super) const DUPLICATE_ELEMENT: Remark =
    Remark::warning("duplicate-element", "only the first of several elements of the same kind was used");
pub(super) const EMPTY_INERTIAL: Remark =
    Remark::warning("empty-inertial", "links with an empty <inertial> have no mass");
pub(super) const LIMIT_MISSING: Remark = Remark::note(
    "limit-missing",
    "ROS rejects revolute and prismatic joints without <limit>. In gelenk, these joints have no limits",
);
pub(super) const LIMIT_UNSET: Remark =
    Remark::note("limit-unset", "limits that are 0 or infinite were ignored");
pub(super) const LIMIT_UNUSABLE: Remark =
    Remark::warning("limit-unusable", "limits that are reversed, equal or negative were ignored");
pub(super) const PLANAR_LIMITS: Remark = Remark::note(
    "planar-limits",
    "limits of joints with several degrees of freedom were ignored, because a URDF does not state which of the motions \
     they limit. A TOML file can give limits for each part",
);
pub(super) const REDUCTION_IGNORED: Remark = Remark::note(
    "transmission-ignored",
    "mechanical reductions were ignored, because inputs act at the joints",
);
pub(super) const ROTOR_READ: Remark = Remark::note(
    "rotor-read",
    "rotors of transmissions were read as inertias i² J at their joints (gear ratio i, rotor inertia J), where the inputs act",
);
pub(super) const SPHERICAL_WITHOUT_DRIVE: Remark = Remark::note(
    "spherical-without-drive",
    "spherical joints of a URDF have no drive and no input. A TOML file can add inputs with `drive = \"ideal\"`",
);
pub(super) const UNKNOWN: Remark = Remark::warning(
    "unknown-tag",
    "unknown elements and attributes inside elements that describe the dynamics were skipped",
);
