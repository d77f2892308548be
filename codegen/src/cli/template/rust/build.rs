//! Generates the robot's equations of motion from its description.

fn main() {
    gelenk_codegen::build("robot.toml");

    // With dry friction (`coulomb`), controllers need a smooth model, `robot_control`, beside the exact one for plants. This line
    // instead writes both:
    // gelenk_codegen::Builder::new().description("robot.toml").control_model(50.0).generate();
}
