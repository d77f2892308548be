//! Generates the robot's equations of motion from its description: `robot` with its dry friction as described, for plants, and
//! `robot_control` with smooth friction, for controllers.

fn main() {
    gelenk_codegen::Builder::new()
        .description("robot.toml")
        .control_model(50.0)
        .generate();
}
