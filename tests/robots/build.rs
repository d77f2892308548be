//! Generates all functions of the robots whose descriptions choose some.

#![allow(clippy::expect_used, reason = "a build script of tests: what is missing ends it")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

use gelenk_codegen::Builder;
use gelenk_codegen::read::{ReadOptions, read};

/// The module with all functions of a Go2 has 134 000 lines.
const TOO_LARGE: &str = "go2";
/// Robots that a bench controls with a module that has lanes, and functions that only these robots have.
const OVER_LANES: [(&str, &[&str]); 3] =
    [("panda", &[]), ("quadrotor", &["input_forces_derivatives"]), ("ur5", &[])];
/// Functions of these modules, which `Dynamics` requires and predictive control calls.
const OF_CONTROL: [&str; 13] = [
    "mass_matrix",
    "coriolis_forces",
    "gravity_forces",
    "spring_forces",
    "friction_torques",
    "inverse_dynamics",
    "inverse_dynamics_derivatives",
    "inverse_dynamics_derivatives_and_mass_matrix",
    "input_matrix",
    "forward_dynamics",
    "linearize",
    "step",
    "step_derivatives",
];

fn main() {
    let folder = PathBuf::from(env::var_os("OUT_DIR").expect("Cargo sets OUT_DIR"));
    // It has a line for each description, so that a new one changes it.
    println!("cargo::rerun-if-changed=../../generated/src/lib.rs");
    println!("cargo::metadata=folder={}", folder.display());
    let mut whole = Builder::new().functions(["all"]).hide_notes();
    let over_lanes = folder.join("over_lanes");
    fs::create_dir_all(&over_lanes).expect("a folder");
    let mut root = String::new();
    for (name, path) in descriptions(Path::new("../../models")) {
        println!("cargo::rerun-if-changed={}", path.display());
        if let Some((_, own)) = OVER_LANES.iter().find(|(robot, _)| *robot == name) {
            let functions = OF_CONTROL.iter().chain(*own).copied();
            let lanes = Builder::new().functions(functions).lanes(["linearize"]).hide_notes();
            lanes.output_folder(&over_lanes).description(&path).generate();
            let _ =
                writeln!(root, "{}", module(&format!("{name}_over_lanes"), &format!("over_lanes/{name}")));
        }
        if chooses_functions(&path) && name != TOO_LARGE {
            whole = whole.description(path);
            let _ = writeln!(root, "{}", module(&name, &name));
        } else {
            let _ = writeln!(root, "pub use gelenk_generated::{name};");
        }
    }
    whole.generate();
    fs::write(folder.join("robots.rs"), root).expect("robots.rs");
}

/// A module with a generated file.
fn module(name: &str, file: &str) -> String {
    format!(
        "/// Functions of the robot of this name.\n#[allow(clippy::all)]\npub mod {name} {{\n    include!(concat!(env!(\"OUT_DIR\"), \"/{file}.rs\"));\n}}"
    )
}

fn descriptions(folder: &Path) -> Vec<(String, PathBuf)> {
    let paths = fs::read_dir(folder).expect("models/").map(|entry| entry.expect("an entry").path());
    let paths = paths.filter(|path| path.extension().is_some_and(|extension| extension == "toml"));
    let name = |path: &PathBuf| path.file_stem().and_then(|name| name.to_str()).expect("a name").to_owned();
    let mut named: Vec<_> = paths.map(|path| (name(&path), path)).collect();
    named.sort();
    named
}

fn chooses_functions(description: &Path) -> bool {
    let loaded = read(description, &ReadOptions::default()).unwrap_or_else(|problems| panic!("{problems}"));
    let functions = loaded.model.options.functions;
    !functions.is_empty() && functions != ["all"]
}
