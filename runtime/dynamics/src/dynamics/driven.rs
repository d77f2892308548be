//! Robots with driven joints at one instant of their motion.

/// A robot with `K` driven joints at one instant of their motion. [`dynamics!`](crate::dynamics!) implements it for modules
/// with driven joints.
///
/// Such a robot is [`Dynamics`](super::Dynamics) only at this instant. At other times
/// ([`Dynamics::at_time`](super::Dynamics::at_time)) results are NaN unless the driven joints are at rest,
/// because one instant does not determine the motion. `DrivenRobot` of `gelenk-runtime` knows the motion over
/// time.
pub trait DrivenJoints<const K: usize>: Copy {
    /// Names of the driven joints: the module's `DRIVEN_NAMES`.
    fn driven_names(&self) -> [&'static str; K];

    /// The robot at another instant.
    ///
    /// - `driven`: position [rad or m], velocity and acceleration of each driven joint
    #[must_use]
    fn with_driven(&self, driven: &[[f64; 3]; K]) -> Self;
}

/// Position, velocity and acceleration that nobody has said.
const UNKNOWN: [f64; 3] = [f64::NAN; 3];

/// Driven joints with unknown motion.
#[must_use]
pub const fn unknown<const K: usize>() -> [[f64; 3]; K] {
    [UNKNOWN; K]
}

/// Driven joints at other times, known from one instant: joints at rest stay at rest, the motion of others is
/// unknown.
#[must_use]
pub fn at_rest_or_unknown<const K: usize>(driven: &[[f64; 3]; K]) -> [[f64; 3]; K] {
    driven.map(|joint| if joint[1] == 0.0 && joint[2] == 0.0 { joint } else { UNKNOWN })
}

/// The trait of the type that stands in for `Driven` in a module without driven joints.
#[diagnostic::on_unimplemented(
    message = "the module has driven joints, so the type must hold their motion",
    label = "write `struct Name {{ driven }} = module`, or with free parameters `struct Name {{ driven, \
             parameters }} = module`"
)]
pub trait NoDrivenJoints {}

impl NoDrivenJoints for () {}

/// Compiles only for modules without driven joints.
pub const fn without_driven_joints<D: NoDrivenJoints>() {}
