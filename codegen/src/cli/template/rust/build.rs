//! Generates the robot's equations of motion from its description.

fn main() {
    gelenk_codegen::build("robot.toml");

        // If the robot has dry friction (`coulomb`), controllers need a smooth model, `robot_control`, in addition to the exact
        // model for plants. This line, instead of the line above, writes both:
    // gelenk_codegen::Builder::new().description("robot.toml").control_model(50.0).generate();
}
