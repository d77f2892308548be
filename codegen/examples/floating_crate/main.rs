//! Adds the feet of a legged robot, or the propellers of a flying one, to a crate with a floating base.
//!
//! ```sh
//! gelenk new my_robot --urdf quadruped.urdf --base floating
//! cargo run -p gelenk-codegen --example floating_crate my_robot [FOOT ...]
//! ```
//!
//! A robot with three or more legs gets frames and forces at its feet in `robot.toml`, and a program that lets it stand. Each
//! FOOT is a link; without them a rule finds legs. For another robot, `robot.toml` gets a commented block for each link that may
//! carry a propeller.

mod parts;

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let result = match arguments.split_first() {
        Some((folder, feet)) => parts::add(Path::new(folder), feet),
        None => Err("name the folder of a crate".to_owned()),
    };
    match result {
        Ok(done) => {
            println!("{done}");
            ExitCode::SUCCESS
        }
        Err(why) => {
            eprintln!("error: {why}");
            ExitCode::FAILURE
        }
    }
}
