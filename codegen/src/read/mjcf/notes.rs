//! Notes about skipped or changed parts of an MJCF, with one note for each kind.

use crate::diagnostic::Severity;
use crate::read::skipped as notes;

/// A kind of remark about a description. A kind gives one note for all its occurrences.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Remark {
    Actuator,
    ActuatorRange,
    EffortRange,
    Elastic,
    Equality,
    Flag,
    GravityCompensation,
    Loop,
    Medium,
    MeshInertia,
    QuaternionForce,
    Range,
    Servo,
    SpringDamper,
    StartPose,
    TendonBranches,
    TendonForce,
}

impl notes::Remark for Remark {
    fn code(self) -> &'static str {
        match self {
            Self::Actuator => "actuator-skipped",
            Self::ActuatorRange => "actuator-range",
            Self::EffortRange => "effort-range",
            Self::Elastic => "elastic-skipped",
            Self::Equality => "equality-skipped",
            Self::Flag => "flag-skipped",
            Self::GravityCompensation => "gravity-compensation",
            Self::Loop => "loop-opened",
            Self::Medium => "medium-skipped",
            Self::MeshInertia => "mesh-inertia",
            Self::QuaternionForce => "quaternion-joint",
            Self::Range => "limit-unusable",
            Self::Servo => "servo-as-torque",
            Self::SpringDamper => "spring-damper",
            Self::StartPose => "start-pose",
            Self::TendonBranches => "tendon-branches",
            Self::TendonForce => "tendon-skipped",
        }
    }

    /// Differences from the dynamics in MuJoCo (M, k, q, and the effect of an input) are warnings.
    fn severity(self) -> Severity {
        match self {
            Self::ActuatorRange | Self::EffortRange | Self::StartPose => Severity::Note,
            _ => Severity::Warning,
        }
    }

    fn text(self) -> &'static str {
        match self {
            Self::Actuator => {
                "actuators were omitted unless they act on a joint, a fixed tendon or a single named site"
            }
            Self::ActuatorRange => "force ranges that are not symmetric about 0 were omitted",
            Self::EffortRange => {
                "force ranges of joints that are not symmetric about 0 were reduced to the smaller side, or \
                 omitted if they exclude 0"
            }
            Self::Elastic => "deformable bodies and forces of plugins were omitted",
            Self::Flag => "flags of <option> that disable parts of the model were ignored",
            Self::Equality => {
                "equality constraints between joints or tendons were omitted if they are not linear, act on \
                 joints with quaternions, or act on a joint that already follows"
            }
            Self::GravityCompensation => "gravity compensation (`gravcomp`) was omitted",
            Self::Loop => {
                "equality constraints that close loops (connect, weld and similar) were omitted: the robot moves without them"
            }
            Self::Medium => "fluid forces were omitted",
            Self::MeshInertia => {
                "meshes without a volume were omitted: bodies without <inertial> have the mass of their other geoms"
            }
            Self::QuaternionForce => {
                "armature, springs, limits and dry friction of ball and free joints were omitted"
            }
            Self::Range => "ranges with equal or reversed ends were omitted",
            Self::Servo => "servos were read as force inputs; their gains were omitted",
            Self::SpringDamper => {
                "springs given by time constants (`springdamper`) and nonlinear springs were omitted"
            }
            Self::StartPose => {
                "initial poses of free bodies were omitted: their positions are relative to the world"
            }
            Self::TendonBranches => {
                "tendons with armature couple joints of different branches in M; MuJoCo omits these entries"
            }
            Self::TendonForce => "springs, limits and spatial paths of tendons were omitted",
        }
    }
}
