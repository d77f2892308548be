//! Generates the equations of motion of the arm, and of the robot model for the controller.

fn main() {
    gelenk_codegen::build("arm.toml");
    gelenk_codegen::build("robot.toml");
    // Step 5 adds the identified robot, with tanh(50 v) for sign(v):
    // gelenk_codegen::Builder::new().description("robot_identified.toml").control_model(50.0).generate();
}
