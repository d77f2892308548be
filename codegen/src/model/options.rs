//! Names of the functions that a description may ask for.

/// What `[generate] functions` may list: the functions of every robot, and `frames` for all of those of named frames.
pub const FUNCTIONS: [&str; 14] = [
    "mass_matrix",
    "coriolis_forces",
    "bias_forces",
    "gravity_forces",
    "spring_forces",
    "friction_torques",
    "applied_forces",
    "input_matrix",
    "equations_of_motion",
    "inverse_dynamics",
    "forward_dynamics",
    "kinetic_energy",
    "potential_energy",
    "frames",
];

/// Whether a description may ask for this function; single ones of named frames begin with `frame_`.
pub fn is_known_function(name: &str) -> bool {
    FUNCTIONS.contains(&name) || name.starts_with("frame_")
}
