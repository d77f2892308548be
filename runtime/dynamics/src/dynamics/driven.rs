//! Robots with driven joints, at one instant of the motion of these.

/// A robot with `K` driven joints at one instant of their motion. [`dynamics!`](crate::dynamics!) implements it for modules
/// with driven joints.
///
/// Such a robot is [`Dynamics`](super::Dynamics) at this instant alone. What asks for another time
/// ([`Dynamics::at_time`](super::Dynamics::at_time)) gets NaN, unless the driven joints rest, because one instant does not
/// tell the motion: `DrivenRobot` of `gelenk-runtime` does.
pub trait DrivenJoints<const K: usize>: Copy {
    /// Names of the driven joints: the module's `DRIVEN_NAMES`.
    fn driven_names(&self) -> [&'static str; K];

    /// The same robot at another instant.
    ///
    /// - `driven`: position [rad or m], velocity and acceleration of each driven joint
    #[must_use]
    fn with_driven(&self, driven: &[[f64; 3]; K]) -> Self;
}

/// Position, velocity and acceleration that nobody has said.
const UNKNOWN: [f64; 3] = [f64::NAN; 3];

/// The driven joints of a robot that says nothing of any time.
#[must_use]
pub const fn unknown<const K: usize>() -> [[f64; 3]; K] {
    [UNKNOWN; K]
}

/// The driven joints at other times, if this is all that is known: a joint at rest stays, of the others nothing is
/// known.
#[must_use]
pub fn at_rest_or_unknown<const K: usize>(driven: &[[f64; 3]; K]) -> [[f64; 3]; K] {
    driven.map(|joint| if joint[1] == 0.0 && joint[2] == 0.0 { joint } else { UNKNOWN })
}

/// The trait of the type that stands in for `Driven` in a module without driven joints.
#[diagnostic::on_unimplemented(
    message = "the module has driven joints, whose motion the type has to hold",
    label = "write `struct Name {{ driven }} = module`, with free parameters `struct Name {{ driven, parameters }} = module`"
)]
pub trait NoDrivenJoints {}

impl NoDrivenJoints for () {}

/// Compiles where a module has no driven joints.
pub const fn without_driven_joints<D: NoDrivenJoints>() {}
