//! Names of the functions that a description may ask for.

/// Names that `[generate] functions` may list: the functions of every robot, and `frames` for all of those of
/// named frames.
pub const FUNCTIONS: [&str; 41] = [
    "mass_matrix",
    "coriolis_forces",
    "gravity_forces",
    "spring_forces",
    "friction_torques",
    "applied_forces",
    "bias_forces",
    "input_matrix",
    "equations_of_motion",
    "inverse_dynamics",
    "forward_dynamics",
    "mass_matrix_and_bias_forces",
    "inverse_dynamics_derivatives",
    "inverse_dynamics_derivatives_and_mass_matrix",
    "forward_dynamics_derivatives",
    "linearize",
    "discretize",
    "step",
    "step_derivatives",
    "kinetic_energy",
    "potential_energy",
    "inertial_parameters",
    "inertial_regressor",
    "base_regressor",
    "friction_parameters",
    "friction_regressor",
    "load_friction",
    "wrench_forces",
    "wrench_forces_derivatives",
    "inverse_dynamics_with_wrenches",
    "forward_dynamics_with_wrenches",
    "inverse_dynamics_derivatives_with_wrenches",
    "forward_dynamics_derivatives_with_wrenches",
    "inverse_dynamics_hessian",
    "joint_wrenches",
    "driving_forces",
    "center_of_mass",
    "center_of_mass_jacobian",
    "centroidal_momentum",
    "centroidal_momentum_matrix",
    "frames",
];

/// Tells whether a description may ask for this function. Functions of single frames begin with `frame_`.
pub fn is_known_function(name: &str) -> bool {
    FUNCTIONS.contains(&name) || name.starts_with("frame_")
}
