//! Robots with driven joints (joints with a prescribed motion) at one time.

/// A robot with `K` driven joints (joints with a prescribed motion) at one time.
/// [`dynamics!`](crate::dynamics!) implements this trait for modules with driven joints.
///
/// The type is [`Dynamics`](super::Dynamics) only at this time, because one time does not determine the
/// motion. At other times ([`Dynamics::at_time`](super::Dynamics::at_time)) results are NaN unless the driven
/// joints are at rest. `DrivenRobot` of `gelenk-runtime` adds the motion over time.
pub trait DrivenJoints<const K: usize>: Copy {
    /// Names of the driven joints, which are `DRIVEN_NAMES` of the module.
    fn driven_names(&self) -> [&'static str; K];

    /// The robot with other positions, velocities and accelerations of the driven joints.
    ///
    /// - `driven`: position [rad or m], velocity and acceleration of each driven joint
    #[must_use]
    fn with_driven(&self, driven: &[[f64; 3]; K]) -> Self;
}

/// Unknown position, velocity and acceleration.
const UNKNOWN: [f64; 3] = [f64::NAN; 3];

/// Driven joints with unknown motion.
#[must_use]
pub const fn unknown<const K: usize>() -> [[f64; 3]; K] {
    [UNKNOWN; K]
}

/// Driven joints at another time, from their motion at one time. Joints at rest remain at rest. The motion of
/// other joints is unknown.
#[must_use]
pub fn at_rest_or_unknown<const K: usize>(driven: &[[f64; 3]; K]) -> [[f64; 3]; K] {
    driven.map(|joint| if joint[1] == 0.0 && joint[2] == 0.0 { joint } else { UNKNOWN })
}

/// Trait of the type that replaces `Driven` in a module without driven joints.
#[diagnostic::on_unimplemented(
    message = "the module has driven joints, so the type must hold their motion",
    label = "write `struct Name {{ driven }} = module`, or with free parameters `struct Name {{ driven, \
             parameters }} = module`"
)]
pub trait NoDrivenJoints {}

impl NoDrivenJoints for () {}

/// Compiles only for modules without driven joints.
pub const fn without_driven_joints<D: NoDrivenJoints>() {}
