//! Stages hand on plain values: the mechanism of a model, and the module before it is printed.
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use std::fs;
use std::path::Path;

use gelenk_codegen::dynamics::search::routes::Formulations;
use gelenk_codegen::emit;
use gelenk_codegen::graph::Graph;
use gelenk_codegen::kinematics::{Mechanism, Number};
use gelenk_codegen::model::Model;
use gelenk_codegen::module::Module;
use gelenk_codegen::pipeline::{GenerateOptions, Generated, generate};
use gelenk_codegen::read::{ReadOptions, read};

fn double_pendulum() -> Generated {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/double_pendulum.toml");
    let options = GenerateOptions {
        functions: ["mass_matrix", "step"].map(str::to_owned).to_vec(),
        lanes: vec!["mass_matrix".to_owned()],
        remarks: vec!["A remark.".to_owned()],
        self_test: true,
        ..GenerateOptions::default()
    };
    generate(Path::new(path), &options).unwrap()
}

/// One whole program; of the others what stands around them.
#[test]
fn double_pendulum_module() {
    let mut module = double_pendulum().module;
    for function in &mut module.functions[1..] {
        function.program.instructions.clear();
        for output in &mut function.program.outputs {
            output.entries.clear();
        }
    }
    insta::assert_debug_snapshot!(module);
}

/// The printer asks nothing but the module: a text follows from the value alone.
#[test]
fn what_is_changed_in_the_value_is_changed_in_the_text() {
    let Generated { module, source, .. } = double_pendulum();
    let print = |module: &Module| emit::module(module, &Default::default()).text;
    assert_eq!(print(&module), source.text);
    let less = Module { lanes: vec![], self_tests: vec![], ..module };
    let text = print(&less);
    assert!(source.text.contains("fn mass_matrix_lanes(") && source.text.contains("mod self_test"));
    assert!(!text.contains("Lanes") && !text.contains("self_test") && text.contains("A remark."));
}

/// A column that turns, a fixed bracket, and an arm whose axis points down, with a rotor on the column. One
/// length and one mass are free.
const ARM: &str = r#"
name = "arm"

[[joints]]
name = "column"
type = "revolute"
axis = [0, 0, 1]

[[joints]]
name = "bracket"
parent = "column"
type = "fixed"
origin = { xyz = [{ free = 0.4, name = "reach", unit = "m" }, 0, 0.1], rpy = [3.141592653589793, 0, 0] }

[[joints]]
name = "elbow"
parent = "bracket"
type = "revolute"
axis = [0, 0, 1]
drive = { gear_ratio = 50, rotor_inertia = 1e-4 }

[[joints]]
name = "hand"
parent = "elbow"
type = "revolute"
origin = { xyz = [0.3, 0, 0] }
axis = [0, 1, 0]

[[bodies]]
link = "bracket"
mass = { free = 2, name = "load", unit = "kg" }
center_of_mass = [0.1, 0, 0]

[[bodies]]
link = "elbow"
mass = 1.5
center_of_mass = [0.15, 0, 0]
inertia = [0.001, 0.02, 0.02]

[[bodies]]
link = "hand"
mass = 0.5
center_of_mass = [0.05, 0, 0.02]
inertia = [0.001, 0.002, 0.002]
"#;

fn arm() -> Model {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arm.toml");
    fs::write(&path, ARM).unwrap();
    read(&path, &ReadOptions::default()).unwrap().model
}

/// Frames, neighbours, transmission and formulas as they stand in the value; then what the search made of it
/// for the inverse dynamics: units of length, regrouped masses, the leaf's alignment.
#[test]
fn mechanism_of_an_arm() {
    let model = arm();
    let mechanism = Mechanism::new(&model);
    insta::assert_debug_snapshot!(mechanism);
    let formulations = Formulations::new(&model, &mechanism);
    let cheapest = formulations.inverse_dynamics();
    let prepared = cheapest.mechanism(&Graph::new(), &mechanism).by_itself();
    insta::assert_debug_snapshot!("formulation_of_an_arm", (cheapest, prepared.bodies));
}

#[test]
fn a_mechanism_is_the_same_value_after_a_graph_took_it_over() {
    let mechanism = Mechanism::new(&arm());
    assert_eq!(mechanism, Mechanism::new(&arm()));
    assert_eq!(mechanism.on(&Graph::new()).by_itself(), mechanism);
    let mut other = mechanism.clone();
    other.bodies[1].lift = Number::Constant(0.25);
    assert_ne!(other.on(&Graph::new()).by_itself(), mechanism);
}
