//! Options for reading a description.

use gelenk_formula::Hold;

/// Options for reading a description, in addition to the keys of the description with the same names.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadOptions {
    /// Makes mimic joints of a URDF or MJCF independent joints.
    pub ignore_mimic: bool,
    /// Angles within this distance (rad) of a multiple of 90° are rounded to it.
    pub snap_angles: Option<f64>,
    /// Leaves out all friction.
    pub no_friction: bool,
    /// Slope k of `tanh(k v)`, which replaces `sign(v)` in friction and springs. `None` leaves the choice to
    /// the description.
    pub smooth_sign: Option<f64>,
    /// Accepts robots whose mass matrix is not positive definite.
    pub accept_unphysical: bool,
    /// Keeps `sign` even if the description replaces it by `tanh`.
    pub exact_sign: bool,
    /// Makes the base floating.
    pub floating_base: bool,
    /// Makes driven joints independent joints without a drive, for logs that contain the motion of all
    /// joints.
    pub free_driven: bool,
    /// Joints that are held. Later entries replace earlier entries.
    pub hold: Vec<Hold>,
    /// Name of the body of an MJCF whose tree is the robot. The rest of the scene is removed.
    pub body: Option<String>,
}
