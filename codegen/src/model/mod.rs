//! The robot as data: the [`Model`].
//!
//! Every `Model` is valid:
//!
//! - names and their Rust identifiers are distinct
//! - the links form one tree in which parents precede children
//! - axes have unit length
//! - limits are ordered
//! - numbers are finite
//!
//! Therefore code that uses a model needs no checks.

mod definiteness;
mod dependent;
mod drive;
mod frame_force;
pub(crate) mod inertia;
mod joint;
pub(crate) mod name;
pub(crate) mod pose;
pub(crate) mod quaternion_joint;
pub(crate) mod regularity;
mod robot;
mod torque_speed;

pub use definiteness::Definiteness;
pub use dependent::Dependent;
pub use drive::{Drive, Input, MotorTorque, RotorCoupling, TorqueSpeedLine};
pub use frame_force::{Attachment, ForceEffect, ForceInput, PointForce, Wrench, WrenchAxes};
pub use gelenk_formula::FrictionTerm;
pub(crate) use inertia::principal_axes;
pub use joint::{FollowedCoordinate, Follower, Joint, JointKind, Limits, Motion, MovingJoint};
pub(crate) use name::identifier;
pub use pose::Pose;
pub use quaternion_joint::{CarryingJoint, JointPosition, QuaternionJoint, QuaternionKind};
pub use robot::{Actuator, Body, Frame, Link, Model, Options, Parameter};
pub use torque_speed::LimitedInput;
