//! Robots with driven joints (joints with a prescribed motion) at one time.

/// A robot with `K` driven joints (joints with a prescribed motion) at one time.
/// [`dynamics!`](crate::dynamics!) implements this trait for modules with driven joints.
///
/// The type only contains the motion of the driven joints at one time, so it does not know their motion at other times. At other
/// times ([`Dynamics::at_time`](super::Dynamics::at_time)) results are NaN unless the driven joints are at rest. `DrivenRobot` of
/// `gelenk-runtime` adds the motion over time.
pub trait DrivenJoints<const K: usize>: Copy {
    /// Names of the driven joints, which are `DRIVEN_NAMES` of the module.
    fn driven_names(&self) -> [&'static str; K];

    /// Returns the robot with other positions, velocities and accelerations of the driven joints.
    ///
    /// - `driven`: position [rad or m], velocity and acceleration of each driven joint
    #[must_use]
    fn with_driven(&self, driven: &[[f64; 3]; K]) -> Self;
}

/// Unknown position, velocity and acceleration.
const UNKNOWN: [f64; 3] = [f64::NAN; 3];

/// Returns NaN for the motion of all driven joints, which means that their motion is unknown.
#[must_use]
pub const fn unknown<const K: usize>() -> [[f64; 3]; K] {
    [UNKNOWN; K]
}

/// Returns the motion of the driven joints at another time. Joints that are at rest in `driven` remain at rest. The motion of other
/// joints is unknown (NaN).
#[must_use]
pub fn at_rest_or_unknown<const K: usize>(driven: &[[f64; 3]; K]) -> [[f64; 3]; K] {
    driven.map(|joint| if joint[1] == 0.0 && joint[2] == 0.0 { joint } else { UNKNOWN })
}

/// Trait of the type that replaces `Driven` in a module without driven joints.
#[diagnostic::on_unimplemented(
    message = "the module has driven joints, so the type needs a field for their motion",
    label = "write `struct Name {{ driven }} = module`, or with free parameters `struct Name {{ driven, \
             parameters }} = module`"
)]
pub trait NoDrivenJoints {}

impl NoDrivenJoints for () {}

/// Compiles only for a module without driven joints. The macro [`dynamics!`](crate::dynamics!) calls this function, so that a
/// module with driven joints needs a field for their motion.
pub const fn without_driven_joints<D: NoDrivenJoints>() {}
