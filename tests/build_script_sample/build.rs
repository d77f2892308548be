//! One line for the common case, a builder for the rest.

fn main() {
    gelenk_codegen::build("crane.toml");

    gelenk_codegen::Builder::new()
        .description("pendulum.urdf")
        .functions([
            "mass_matrix",
            "coriolis_forces",
            "gravity_forces",
            "spring_forces",
            "friction_torques",
            "input_matrix",
            "forward_dynamics",
        ])
        .snap_angles(1e-4)
        .generate();
}
