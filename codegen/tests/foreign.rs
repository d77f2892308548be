//! Descriptions of other tools: what enters the dynamics is read, and what changes them and is not read is a warning.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};

use gelenk_codegen::diagnostic::Diagnostics;
use gelenk_codegen::functions::selection::derive_functions;
use gelenk_codegen::functions::size::MOST_OPERATIONS;
use gelenk_codegen::model::Model;
use gelenk_codegen::program::interpret::interpret;
use gelenk_codegen::read::{ReadOptions, read};

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/foreign").join(name)
}

fn load(name: &str, options: &ReadOptions) -> (Model, Diagnostics) {
    let loaded = read(&file(name), options).unwrap_or_else(|problems| panic!("{problems}"));
    (loaded.model, loaded.notes)
}

fn value(model: &Model, function: &str, inputs: &[&[f64]]) -> Vec<f64> {
    let functions = derive_functions(model, &[function.to_owned()], MOST_OPERATIONS).unwrap();
    interpret(&functions[0].program, inputs, &[]).unwrap().remove(0)
}

const STATE: [f64; 2] = [0.3, -0.5];

/// Pinocchio, whose parser reads the attribute, and the gradient of the potential energy by complex steps.
#[test]
fn quaternions_of_origins_and_limits_of_decelerations_are_read() {
    let (model, notes) = load("quat_joint_origin.urdf", &ReadOptions::default());
    assert!(notes.is_empty(), "{notes}");
    let loads = value(&model, "gravity_forces", &[&STATE]);
    for (load, expected) in loads.iter().zip([3.380_296, 0.307_478]) {
        assert!((load + expected).abs() < 1e-6, "{loads:?}");
    }
    // The attitude of an inertia acts on M alone. NumPy, with the Jacobians of the centres of mass; without the attitude the first
    // entry is 0.194660076.
    let mass = value(&model, "mass_matrix", &[&STATE]);
    for (entry, expected) in mass.iter().zip([0.195_533_193, -0.007_898_243, -0.007_898_243, 0.009]) {
        assert!((entry - expected).abs() < 1e-9, "{mass:?}");
    }
    // The smaller one of acceleration and deceleration.
    let limits = model.joints().next().unwrap().limits;
    assert_eq!([limits.acceleration, limits.jerk], [Some(4.0), Some(50.0)]);
}

/// Drake; Pinocchio's 0.174246 with 80² · 1.2e-4.
#[test]
fn a_rotor_of_drake_is_read() {
    let (model, notes) = load("drake_rotor.urdf", &ReadOptions::default());
    assert!(notes.entries().iter().any(|note| note.code == "rotor-read"), "{notes}");
    let mass = value(&model, "mass_matrix", &[&STATE]);
    assert!((mass[0] - 0.942_246).abs() < 1e-6, "{mass:?}");
    assert_eq!(model.joints().next().unwrap().limits.acceleration, Some(7.0));
}

/// The outcomes of all files in `tests/foreign`.
#[test]
fn what_changes_the_dynamics_elsewhere_is_a_warning() {
    let mut files: Vec<_> = std::fs::read_dir(file("")).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(files.len() >= 8);
    for path in files {
        let name = path.file_name().unwrap().to_str().unwrap();
        let (_, notes) = load(name, &ReadOptions::default());
        let text = notes.to_string().replace(&format!("{}/", file("").display()).replace("//", "/"), "");
        let mut settings = insta::Settings::clone_current();
        settings.set_prepend_module_to_snapshot(false);
        settings.set_omit_expression(true);
        settings.set_snapshot_path("snapshots/foreign");
        settings.bind(|| insta::assert_snapshot!(name, text));
    }
}

/// MuJoCo loads one equality, which constrains j1 and j2.
#[test]
fn a_loop_is_opened_with_a_warning_whatever_the_options() {
    for ignore_mimic in [false, true] {
        let (_, notes) = load("connect.xml", &ReadOptions { ignore_mimic, ..ReadOptions::default() });
        assert_eq!(notes.entries().iter().map(|note| note.code).collect::<Vec<_>>(), ["loop-opened"]);
    }
}
