//! Generates the robot's equations of motion from its description.

fn main() {
    gelenk_codegen::build("robot.toml");
}
