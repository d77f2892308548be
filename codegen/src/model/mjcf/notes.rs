//! What was skipped or changed in an MJCF: one note for each kind.

use super::super::notes;
use crate::diagnostic::Severity;

/// Something about a description that is worth a note, once for all places.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Remark {
    Actuator,
    ActuatorRange,
    EffortRange,
    Equality,
    Flag,
    GravityCompensation,
    Loop,
    Medium,
    MeshInertia,
    QuaternionForce,
    Servo,
    SpringDamper,
    TendonForce,
}

impl notes::Remark for Remark {
    fn code(self) -> &'static str {
        match self {
            Self::Actuator => "actuator-skipped",
            Self::ActuatorRange => "actuator-range",
            Self::EffortRange => "effort-range",
            Self::Equality => "equality-skipped",
            Self::Flag => "flag-skipped",
            Self::GravityCompensation => "gravity-compensation",
            Self::Loop => "loop-opened",
            Self::Medium => "medium-skipped",
            Self::MeshInertia => "mesh-inertia",
            Self::QuaternionForce => "quaternion-joint",
            Self::Servo => "servo-as-torque",
            Self::SpringDamper => "spring-damper",
            Self::TendonForce => "tendon-skipped",
        }
    }

    /// What changes M or k is a warning.
    fn severity(self) -> Severity {
        match self {
            Self::Loop | Self::MeshInertia | Self::QuaternionForce | Self::Equality => Severity::Warning,
            _ => Severity::Note,
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
            Self::Flag => "flags of <option> that disable what is read here were left out",
            Self::Equality => {
                "equalities of joints that are not linear, or of joints with quaternions, were left out"
            }
            Self::GravityCompensation => "compensation of gravity (`gravcomp`) was left out",
            Self::Loop => {
                "equalities that close loops (connect, weld and the like) were left out: the robot moves without them"
            }
            Self::Medium => "forces of a medium were left out",
            Self::MeshInertia => {
                "meshes are not read: these bodies have no <inertial>, and the mass of their geoms without meshes alone"
            }
            Self::QuaternionForce => {
                "armature, springs, limits and dry friction of ball and free joints were left out"
            }
            Self::Servo => "servos were read as forces: their gains were left out",
            Self::SpringDamper => {
                "springs given by time constants (`springdamper`), and others that are not linear, were left out"
            }
            Self::TendonForce => "springs, limits and spatial paths of tendons were left out",
        }
    }
}
