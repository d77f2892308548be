//! Names of the functions that can be generated.

/// All functions that `[generate] functions` may list. `frame_poses`, `frame_jacobians` and `frame_jacobian_rates`
/// stand for those of every named frame.
pub const FUNCTIONS: [&str; 21] = [
    "mass_matrix",
    "coriolis_forces",
    "bias_forces",
    "applied_forces",
    "gravity_forces",
    "spring_forces",
    "friction_torques",
    "input_matrix",
    "equations_of_motion",
    "inverse_dynamics",
    "forward_dynamics",
    "kinetic_energy",
    "potential_energy",
    "frame_poses",
    "frame_jacobians",
    "frame_jacobian_rates",
    "inverse_dynamics_derivatives",
    "forward_dynamics_derivatives",
    "linearize",
    "regressor",
    "friction_regressor",
];

/// Whether a description may ask for this function; those of single frames begin with `frame_`.
pub fn is_known_function(name: &str) -> bool {
    FUNCTIONS.contains(&name) || name.starts_with("frame_")
}
