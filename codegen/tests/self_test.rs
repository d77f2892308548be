//! Modules test themselves: their functions against the values of the interpreter, as their users run them.
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use super::common;
use gelenk_codegen::emit::{EmitOptions, Scalar};
use gelenk_codegen::pipeline::{GenerateOptions, generate};
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Command;

fn module(robot: &str, scalar: Scalar) -> String {
    let path = format!("{}/../models/{robot}.toml", env!("CARGO_MANIFEST_DIR"));
    let options = GenerateOptions {
        self_test: true,
        emit: EmitOptions { scalar, ..EmitOptions::default() },
        ..GenerateOptions::default()
    };
    generate(Path::new(&path), &options).unwrap().source.text
}

/// Compiles the modules as one test program and runs it; its output, and whether all tests passed.
fn run(modules: &[(&str, &str)]) -> (String, bool) {
    let folder = tempfile::tempdir().unwrap();
    let mut outer = String::from("#![deny(warnings)]\n");
    for (name, text) in modules {
        fs::write(folder.path().join(format!("{name}.rs")), text).unwrap();
        writeln!(outer, "#[allow(dead_code)]\nmod {name} {{ include!(\"{name}.rs\"); }}").unwrap();
    }
    common::rustc(folder.path(), "tests", &outer, &["--test"]).unwrap();
    let program = folder.path().join("tests");
    let output = Command::new(program).output().unwrap();
    (String::from_utf8_lossy(&output.stdout).into_owned(), output.status.success())
}

#[test]
fn modules_pass_their_own_tests() {
    let modules = [
        ("powercube", module("powercube", Scalar::F64)),
        ("free_parameters", module("double_pendulum", Scalar::F64)),
        ("single_precision", module("cart_pole", Scalar::F32)),
    ];
    let texts = modules.each_ref().map(|(name, text)| (*name, text.as_str()));
    let (said, passed) = run(&texts);
    assert!(passed, "{said}");
    for (name, _) in texts {
        for function in ["mass_matrix", "inverse_dynamics_derivatives", "kinetic_energy"] {
            let test = format!("test {name}::self_test::{function} ... ok");
            assert!(said.contains(&test), "{test}: {said}");
        }
    }
}

/// A constant that somebody changed by hand is found.
#[test]
fn a_changed_module_fails_its_tests() {
    let text = module("powercube", Scalar::F64);
    let (before, after) = text.split_once("pub fn gravity_forces").unwrap();
    let changed =
        format!("{before}pub fn gravity_forces{}", after.replacen(" * sin_", " * 1.000001 * sin_", 1));
    assert_ne!(changed, text);
    let (said, passed) = run(&[("powercube", &changed)]);
    assert!(!passed && said.contains("self_test::gravity_forces ... FAILED"), "{said}");
}

#[test]
fn without_being_asked_for_there_are_no_tests() {
    let path = format!("{}/../models/cart_pole.toml", env!("CARGO_MANIFEST_DIR"));
    let generated = generate(Path::new(&path), &GenerateOptions::default()).unwrap();
    assert!(!generated.source.text.contains("#[test]"));
}
