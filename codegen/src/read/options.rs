//! Choices at reading.

use gelenk_formula::Hold;

/// How to read a description; the description's own keys of the same names count too.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadOptions {
    /// Mimic joints of a URDF become independent.
    pub ignore_mimic: bool,
    /// Angles within this of a multiple of 90° become that multiple (rad).
    pub snap_angles: Option<f64>,
    /// All friction is left out.
    pub no_friction: bool,
    /// Slope k of `tanh(k v)`, which replaces `sign(v)` in friction and springs.
    pub smooth_sign: Option<f64>,
    /// Takes a robot whose mass matrix is not positive definite.
    pub accept_unphysical: bool,
    /// `sign` stays, whatever the description says of `tanh` in its place.
    pub exact_sign: bool,
    /// The base moves freely.
    pub floating_base: bool,
    /// Driven joints are coordinates without a drive, as in a log that has the motion of all joints.
    pub free_driven: bool,
    /// Joints that are held. A later entry replaces an earlier one.
    pub hold: Vec<Hold>,
    /// A body of an MJCF: its tree is the robot, and all else in the scene goes.
    pub body: Option<String>,
}
