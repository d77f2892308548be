//! Options for reading a description.

use gelenk_formula::Hold;

/// Options for reading a description, in addition to its keys of the same names.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadOptions {
    /// Makes mimic joints of a URDF coordinates of their own.
    pub ignore_mimic: bool,
    /// Angles within this distance (rad) of a multiple of 90° are rounded to it.
    pub snap_angles: Option<f64>,
    /// Leaves out all friction.
    pub no_friction: bool,
    /// Slope k of `tanh(k v)`, which replaces `sign(v)` in friction and springs.
    pub smooth_sign: Option<f64>,
    /// Accepts robots whose mass matrix is not positive definite.
    pub accept_unphysical: bool,
    /// Keeps `sign` even if the description replaces it by `tanh`.
    pub exact_sign: bool,
    /// Makes the base floating.
    pub floating_base: bool,
    /// Makes driven joints coordinates without a drive, for logs that contain the motion of all joints.
    pub free_driven: bool,
    /// Held joints. Later entries replace earlier ones.
    pub hold: Vec<Hold>,
    /// Body of an MJCF whose tree is the robot; the rest of the scene is removed.
    pub body: Option<String>,
}
