//! What identification asks of a robot, whether its functions are compiled or interpreted.

/// A robot whose equations of motion are linear in its inertial parameters, `W(y, ẏ, ÿ) π = M ÿ + k − q_g`.
///
/// N joints, M inputs, P parameters. A generated module has these functions; a description that is interpreted
/// has them too. Slices have the lengths stated here: implementations may rely on it.
pub trait Robot {
    /// Names of the N joints, as described.
    fn joint_names(&self) -> Vec<String>;

    /// Names of the M inputs, as described.
    fn input_names(&self) -> Vec<String>;

    /// Unit of each joint's position: `rad` or `m`.
    fn position_units(&self) -> Vec<&'static str>;

    /// Limits of each joint.
    fn limits(&self) -> Vec<JointLimits>;

    /// Names of the P inertial parameters: ten for each body (m, m c, moments about the frame's origin), then
    /// one for each rotor, as in a generated module's `INERTIAL_PARAMETER_NAMES`.
    fn parameter_names(&self) -> Vec<String>;

    /// The described values of the parameters, in the same order.
    fn parameters(&self) -> Vec<f64>;

    /// Number of bodies: the first `10 · bodies` parameters are theirs.
    fn bodies(&self) -> usize;

    /// B, `N × M`, rows first: joint forces of unit inputs.
    fn input_matrix(&self) -> Vec<f64>;

    /// `W`, `N × P`, rows first, at positions y [rad or m], velocities ẏ and accelerations ÿ.
    fn inertial_regressor(&self, y: &[f64], v: &[f64], a: &[f64], regressor: &mut [f64]);

    /// `M ÿ + k − q` with the described parameters and without friction, one entry for each joint [N·m or N].
    /// Springs and other forces that are no inertia are in here and not in `W π`.
    fn rigid_forces(&self, y: &[f64], v: &[f64], a: &[f64], forces: &mut [f64]);
}

/// Limits of a joint, as described; what is not described is infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLimits {
    /// Lowest and highest position [rad or m].
    pub position: [f64; 2],
    /// Largest speed [rad/s or m/s].
    pub velocity: f64,
    /// Largest force [N·m or N].
    pub effort: f64,
}
