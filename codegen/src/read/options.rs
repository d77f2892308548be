//! Options for reading a description.

use gelenk_formula::Hold;

/// Options for reading a description. They act in addition to keys with the same names in the description.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadOptions {
    /// Makes mimic joints of a URDF or MJCF independent joints, which do not follow other joints.
    pub ignore_mimic: bool,
    /// Tolerance in rad. Angles within this distance of a multiple of 90° are rounded to this multiple.
    pub snap_angles: Option<f64>,
    /// Leaves out the friction of all joints and drives.
    pub no_friction: bool,
    /// Slope s of `tanh(s v)`, which replaces `sign(v)` in friction and springs. `None` leaves the choice to
    /// the description.
    pub smooth_sign: Option<f64>,
    /// Accepts robots whose mass matrix is not positive definite, instead of reporting an error.
    pub accept_unphysical: bool,
    /// Keeps `sign` even if the description replaces it by `tanh`.
    pub exact_sign: bool,
    /// Makes the base link floating, with a floating joint between world and base.
    pub floating_base: bool,
    /// Makes driven joints (with a prescribed motion) independent joints without a drive, for logs that
    /// contain the motion of all joints.
    pub free_driven: bool,
    /// Patterns of joints that are held at a position. Later entries replace earlier entries.
    pub hold: Vec<Hold>,
    /// Name of a body in the scene of an MJCF. The robot is the kinematic tree that contains this body; the rest
    /// of the scene is removed.
    pub body: Option<String>,
}
