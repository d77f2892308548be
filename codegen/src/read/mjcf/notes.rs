//! Skipped or changed parts of an MJCF: one note for each kind.

use crate::diagnostic::Severity;
use crate::read::skipped as notes;

/// A peculiarity of a description. It has one note, however often it occurs.
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

    /// Changes of the dynamics in MuJoCo (M, k, q, and the effect of an input) are warnings.
    fn severity(self) -> Severity {
        match self {
            Self::ActuatorRange | Self::EffortRange | Self::StartPose => Severity::Note,
            _ => Severity::Warning,
        }
    }

    fn text(self) -> &'static str {
        match self {
            Self::Actuator => {
                "actuators that act neither on joints, nor on fixed tendons, nor on named sites by themselves were left out"
            }
            Self::ActuatorRange => "ranges of forces that are not alike to both sides of 0 were left out",
            Self::EffortRange => {
                "ranges of forces at joints that are not alike to both sides of 0 became their smaller side; one without 0 inside was left out"
            }
            Self::Elastic => "deformable bodies and forces of plugins were left out",
            Self::Flag => "flags of <option> that disable what is read here were left out",
            Self::Equality => {
                "equalities of joints and tendons that are not linear, or of joints with quaternions or that follow already, were left out"
            }
            Self::GravityCompensation => "compensation of gravity (`gravcomp`) was left out",
            Self::Loop => {
                "equalities that close loops (connect, weld and the like) were left out: the robot moves without them"
            }
            Self::Medium => "forces of a medium were left out",
            Self::MeshInertia => {
                "meshes without a volume were left out: the bodies have no <inertial>, and the mass of their other geoms alone"
            }
            Self::QuaternionForce => {
                "armature, springs, limits and dry friction of ball and free joints were left out"
            }
            Self::Range => "ranges whose ends are equal or reversed were left out",
            Self::Servo => "servos were read as forces: their gains were left out",
            Self::SpringDamper => {
                "springs given by time constants (`springdamper`), and others that are not linear, were left out"
            }
            Self::StartPose => {
                "the place and attitude where free bodies begin were left out: their positions count in the world"
            }
            Self::TendonBranches => {
                "tendons with an armature couple joints of different branches in M; MuJoCo leaves these entries out"
            }
            Self::TendonForce => "springs, limits and spatial paths of tendons were left out",
        }
    }
}
