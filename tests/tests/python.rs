//! The Python package over the program: its own tests, compared with values of the Rust modules.
//!
//! They need Python 3 with its module `venv`, packages from its registry, and a C compiler; without them they are skipped
//! and say so.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::path::PathBuf;

use fastrand::Rng;
use gelenk_codegen::emit::{EmitOptions, Language};
use gelenk_codegen::pipeline::{GenerateOptions, generate};
use gelenk_generated::{powercube_parameters, ur5};
use gelenk_tests::flat::{Call, flat};
use gelenk_tests::generated::ROBOTS;
use gelenk_tests::python::{has_c_compiler, pytest, python, test_files};
use gelenk_tests::workspace;
use serde_json::{Value, json};

/// The functions of the UR5 that the tests in Python load.
const UR5: [&str; 8] = [
    "mass_matrix",
    "bias_forces",
    "gravity_forces",
    "inverse_dynamics",
    "forward_dynamics",
    "inverse_dynamics_derivatives",
    "linearize",
    "kinetic_energy",
];

/// Calls with their results in Rust, at seeded states.
fn rust_values() -> Value {
    let mut rng = Rng::with_seed(1604);
    let mut calls = calls("ur5", &UR5, &[], &mut rng);
    let described: Vec<f64> = [9.81; 16].iter().map(|x| x * (0.5 + rng.f64())).collect();
    calls.extend(self::calls("powercube_parameters", &[], &described, &mut rng));
    calls.extend(steps(&mut rng));
    Value::Array(calls)
}

/// Calls of functions with a program; of all where none is named.
fn calls(robot: &str, functions: &[&str], parameters: &[f64], rng: &mut Rng) -> Vec<Value> {
    let options = GenerateOptions {
        functions: functions.iter().map(|name| (*name).to_owned()).collect(),
        emit: EmitOptions { language: Language::C, ..EmitOptions::default() },
        ..GenerateOptions::default()
    };
    let description = workspace().join(format!("models/{robot}.toml"));
    let module = generate(&description, &options).unwrap_or_else(|problems| panic!("{problems}")).module;
    let compiled = ROBOTS.iter().find(|(name, _)| *name == robot).expect("a robot of generated/").1;
    let functions = module.functions.iter().flat_map(|function| {
        let (_, call): &(_, Call) =
            compiled.iter().find(|(name, _)| *name == function.name).expect("a function of the robot");
        let calls = (0..3).map(|_| {
            let inputs = function.program.inputs.iter();
            let arguments: Vec<Vec<f64>> =
                inputs.map(|input| (0..input.extent.len).map(|_| number(rng)).collect()).collect();
            json!({
                "robot": robot,
                "function": function.name,
                "parameters": parameters,
                "arguments": arguments,
                "results": call(&arguments, parameters),
            })
        });
        calls.collect::<Vec<_>>()
    });
    functions.collect()
}

/// Calls of functions over a sample time, which is a number by value.
fn steps(rng: &mut Rng) -> Vec<Value> {
    let mut entries = vec![];
    for period in [0.002, 0.02] {
        let [y, v, u]: [[f64; 6]; 3] = core::array::from_fn(|_| core::array::from_fn(|_| number(rng)));
        let results = flat(&ur5::step_derivatives(&y, &v, &u, period));
        entries.push(json!({
            "robot": "ur5", "function": "step_derivatives", "parameters": [],
            "arguments": [y, v, u, period], "results": results,
        }));
        let [y, v, u]: [[f64; 2]; 3] = core::array::from_fn(|_| core::array::from_fn(|_| number(rng)));
        let p = powercube_parameters::Parameters::DESCRIBED;
        let results = flat(&powercube_parameters::discretize(&y, &v, &u, period, &p));
        entries.push(json!({
            "robot": "powercube_parameters", "function": "discretize", "parameters": [],
            "arguments": [y, v, u, period], "results": results,
        }));
    }
    entries
}

fn number(rng: &mut Rng) -> f64 {
    6.0 * (rng.f64() - 0.5)
}

#[test]
fn the_package_computes_what_rust_computes_and_passes_its_own_tests() {
    run(|name| !is_of_other_tools(name), Some(rust_values()));
}

#[test]
fn functions_for_casadi_pass_their_tests() {
    run(|name| name.starts_with("casadi"), None);
}

/// Names that `acados.rs` runs with packages of its own, since they take as long as all others.
fn is_of_other_tools(name: &str) -> bool {
    ["acados", "casadi"].iter().any(|tool| name.starts_with(tool))
}

fn run(wanted: impl Fn(&str) -> bool, values: Option<Value>) {
    let (Some(python), true) = (python(), has_c_compiler()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("values.json");
    let files: Vec<PathBuf> =
        test_files().into_iter().filter(|(name, _)| wanted(name)).map(|(_, file)| file).collect();
    assert!(files.len() > 1, "{files:?}");
    let mut variables = vec![];
    if let Some(values) = values {
        std::fs::write(&file, values.to_string()).expect("a file");
        variables.push(("GELENK_RUST_VALUES", file.as_path()));
    }
    pytest(&python, &files, folder.path(), &variables);
}
