//! Names of the functions in generated modules. Descriptions, the command line and the table of functions
//! (`functions/catalogue`) use these names.

macro_rules! names {
    ($($constant:ident = $name:literal,)*) => {
        $(#[doc = concat!("`", $name, "`")] pub const $constant: &str = $name;)*

        /// Names of all functions except those of named frames such as `frame_tool_pose`.
        const OF_ROBOTS: &[&str] = &[$($name),*];
    };
}

names! {
    MASS_MATRIX = "mass_matrix",
    CORIOLIS_FORCES = "coriolis_forces",
    GRAVITY_FORCES = "gravity_forces",
    SPRING_FORCES = "spring_forces",
    FRICTION_TORQUES = "friction_torques",
    APPLIED_FORCES = "applied_forces",
    BIAS_FORCES = "bias_forces",
    INPUT_MATRIX = "input_matrix",
    INPUT_FORCES_DERIVATIVES = "input_forces_derivatives",
    EQUATIONS_OF_MOTION = "equations_of_motion",
    INVERSE_DYNAMICS = "inverse_dynamics",
    FORWARD_DYNAMICS = "forward_dynamics",
    MASS_MATRIX_AND_BIAS_FORCES = "mass_matrix_and_bias_forces",
    INVERSE_DYNAMICS_DERIVATIVES = "inverse_dynamics_derivatives",
    INVERSE_DYNAMICS_DERIVATIVES_AND_MASS_MATRIX = "inverse_dynamics_derivatives_and_mass_matrix",
    FORWARD_DYNAMICS_DERIVATIVES = "forward_dynamics_derivatives",
    LINEARIZE = "linearize",
    DISCRETIZE = "discretize",
    STEP = "step",
    STEP_DERIVATIVES = "step_derivatives",
    KINETIC_ENERGY = "kinetic_energy",
    POTENTIAL_ENERGY = "potential_energy",
    INERTIAL_PARAMETERS = "inertial_parameters",
    INERTIAL_REGRESSOR = "inertial_regressor",
    BASE_REGRESSOR = "base_regressor",
    FRICTION_PARAMETERS = "friction_parameters",
    FRICTION_REGRESSOR = "friction_regressor",
    LOAD_FRICTION = "load_friction",
    WRENCH_FORCES = "wrench_forces",
    WRENCH_FORCES_DERIVATIVES = "wrench_forces_derivatives",
    INVERSE_DYNAMICS_WITH_WRENCHES = "inverse_dynamics_with_wrenches",
    FORWARD_DYNAMICS_WITH_WRENCHES = "forward_dynamics_with_wrenches",
    INVERSE_DYNAMICS_DERIVATIVES_WITH_WRENCHES = "inverse_dynamics_derivatives_with_wrenches",
    FORWARD_DYNAMICS_DERIVATIVES_WITH_WRENCHES = "forward_dynamics_derivatives_with_wrenches",
    INVERSE_DYNAMICS_HESSIAN = "inverse_dynamics_hessian",
    JOINT_WRENCHES = "joint_wrenches",
    DRIVING_FORCES = "driving_forces",
    CENTER_OF_MASS = "center_of_mass",
    CENTER_OF_MASS_JACOBIAN = "center_of_mass_jacobian",
    CENTROIDAL_MOMENTUM = "centroidal_momentum",
    CENTROIDAL_MOMENTUM_MATRIX = "centroidal_momentum_matrix",
}

/// Name of the group of all functions of named frames.
pub const FRAMES: &str = "frames";

/// Name of the group of all functions, except the functions that are generated only if they are named.
pub const ALL: &str = "all";

/// Names of the groups of functions.
pub const GROUPS: [&str; 2] = [FRAMES, ALL];

/// Whether a selection is empty or contains [`ALL`].
#[must_use]
pub fn select_all(selection: &[String]) -> bool {
    selection.is_empty() || selection.iter().any(|name| name == ALL)
}

/// A quantity of a named frame. The generated module has one function for each frame and quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrameKind {
    /// Position and orientation of the frame in the base frame.
    Pose,
    /// Jacobian J. `J ẏ` is the velocity of the frame: linear, then angular, in the axes of the base.
    Jacobian,
    /// Product `J̇ ẏ`: the acceleration of the frame at ÿ = 0, linear, then angular, in the axes of the base.
    JacobianRateTimesVelocity,
}

impl FrameKind {
    /// All quantities of a frame: pose, Jacobian, and `J̇ ẏ`.
    pub const ALL: [Self; 3] = [Self::Pose, Self::Jacobian, Self::JacobianRateTimesVelocity];

    /// Name pattern of the frame's function, for example `frame_NAME_pose`.
    #[must_use]
    pub const fn pattern(self) -> &'static str {
        match self {
            Self::Pose => "frame_NAME_pose",
            Self::Jacobian => "frame_NAME_jacobian",
            Self::JacobianRateTimesVelocity => "frame_NAME_jacobian_rate_times_velocity",
        }
    }

    /// Name of the function for the frame `frame`, for example `frame_tool_pose`.
    #[must_use]
    pub fn function(self, frame: &str) -> String {
        self.pattern().replace("NAME", frame)
    }

    /// Whether a name has this quantity's pattern, for example `frame_tool_pose`. Whether the frame exists is
    /// not checked.
    fn is_of(self, name: &str) -> bool {
        let frame = self.pattern().split_once("NAME").and_then(|(start, end)| {
            let rest = name.strip_prefix(start)?;
            rest.strip_suffix(end)
        });
        frame.is_some_and(|frame| !frame.is_empty())
    }
}

/// Returns the names that descriptions and the command line accept: all functions that a robot can have, and
/// [`GROUPS`]. Functions of named frames are not included.
pub fn listed() -> impl Iterator<Item = &'static str> {
    OF_ROBOTS.iter().copied().chain(GROUPS)
}

/// Whether the name is the name of a function, including functions of named frames, or the name of a group in
/// [`GROUPS`]. Whether the frame exists is not checked.
#[must_use]
pub fn is_known(name: &str) -> bool {
    listed().any(|known| known == name) || FrameKind::ALL.iter().any(|kind| kind.is_of(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_of_frames_are_known_by_their_whole_names() {
        for kind in FrameKind::ALL {
            assert!(is_known(&kind.function("tool")), "{kind:?}");
        }
        for name in
            ["frame_tool", "frame__pose", "frame_pose", "frame_tool_poses", "tool_pose", "mass_matrices"]
        {
            assert!(!is_known(name), "{name}");
        }
    }
}
