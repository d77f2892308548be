//! Everything that uses Symbolica, in one process and on one thread: its closed forms agree with the
//! recursive derivation.
//!
//! There is no libtest here, which would use several threads. Child processes come first: as soon as this
//! process has used Symbolica, it is the machine's one instance until it ends.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use common::Random;
use gelenk_codegen::closed_form::{self, ClosedForms, Instance, Values, display};
use gelenk_codegen::functions::selection;
use gelenk_codegen::functions::size::MOST_OPERATIONS;
use gelenk_codegen::model::Model;
use gelenk_codegen::program::interpret::interpret;
use gelenk_codegen::read::{ReadOptions, from_toml, read};

fn main() {
    // What derives in this process stands last: it keeps the one instance that the program would wait for.
    let tests: &[(&str, fn())] = &[
        ("the_program_prints_results_alone", the_program_prints_results_alone),
        ("the_program_writes_files", the_program_writes_files),
        ("more_than_three_joints_are_refused", more_than_three_joints_are_refused),
        ("slanted_robots_are_refused", slanted_robots_are_refused),
        ("pages_hold_closed_forms", pages_hold_closed_forms),
        ("pages_say_why_they_hold_none", pages_say_why_they_hold_none),
        ("powercube_reads_as_published", powercube_reads_as_published),
        ("powercube_has_the_published_numbers", powercube_has_the_published_numbers),
        ("models_agree_with_the_recursive_derivation", models_agree_with_the_recursive_derivation),
        (
            "spatial_arms_agree_with_the_recursive_derivation",
            spatial_arms_agree_with_the_recursive_derivation,
        ),
        ("the_comparison_sees_a_wrong_parameter", the_comparison_sees_a_wrong_parameter),
        ("small_robots_read_well", small_robots_read_well),
        ("helical_joints_are_refused_unless_they_are_held", helical_joints_are_refused_unless_they_are_held),
    ];
    for (name, test) in tests {
        test();
        println!("test {name} ... ok");
    }
}

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models")
}

fn model(name: &str) -> Model {
    read(&models().join(name), &ReadOptions::default()).unwrap().model
}

fn described(text: &str) -> Model {
    let none = &mut |name: &str| panic!("{name} is not asked for");
    from_toml(text, "arm.toml", &ReadOptions::default(), none).unwrap().0
}

fn forms(model: &Model) -> ClosedForms {
    let instance = Instance::acquire(&mut |_| eprintln!("waiting for another Symbolica")).unwrap();
    closed_form::derive(model, &instance).unwrap()
}

fn defaults(model: &Model) -> Vec<f64> {
    model.parameters.iter().map(|parameter| parameter.default).collect()
}

fn gelenk(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gelenk"));
    command.arg("inspect").arg("--closed-form").args(arguments);
    command.current_dir(models()).output().unwrap()
}

fn the_program_prints_results_alone() {
    let text = gelenk(&["powercube.toml"]);
    let (out, err) =
        (String::from_utf8(text.stdout).unwrap(), String::from_utf8_lossy(&text.stderr).into_owned());
    assert!(text.status.success(), "{err}");
    assert!(out.starts_with("powercube: M(y) ÿ"), "{out}");
    let json = gelenk(&["powercube.toml", "--format", "json"]);
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!(json["text"], out);
    let latex = gelenk(&["powercube.toml", "--latex"]);
    assert_eq!(json["latex"], String::from_utf8(latex.stdout).unwrap());
}

fn the_program_writes_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("forms.tex");
    let output = gelenk(&["cart_pole.toml", "--latex", "--output", path.to_str().unwrap()]);
    assert!(output.status.success());
    assert!(std::fs::read_to_string(path).unwrap().starts_with("\\begin{align*}"));
}

fn more_than_three_joints_are_refused() {
    let output = gelenk(&["puma560.toml"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(output.stdout.is_empty());
    insta::assert_snapshot!("too_many_joints", String::from_utf8(output.stderr).unwrap());
}

/// Three joints in general position: hours of work, and formulas that nobody reads.
fn slanted_robots_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("slanted.toml");
    std::fs::write(&path, general_arm()).unwrap();
    let output = gelenk(&[path.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    assert!(output.stdout.is_empty());
    let message = String::from_utf8(output.stderr).unwrap();
    insta::assert_snapshot!("too_many_angles", message);
}

const SCREW: &str = r#"
[[joints]]
name = "hinge"
axis = [0, 1, 0]
drive = "ideal"
[[joints]]
name = "screw"
type = "helical"
pitch = 0.2
origin = { xyz = [0.1, 0, 0.3] }
HELD
[[joints]]
name = "tip"
axis = [1, 0, 0]
origin = { xyz = [0, 0.2, 0.1] }
[[bodies]]
link = "hinge"
mass = 2
center_of_mass = [0.1, 0, 0.2]
inertia = 0.1
[[bodies]]
link = "tip"
mass = 1
center_of_mass = [0.1, 0.1, 0]
inertia = 0.05
"#;

fn helical_joints_are_refused_unless_they_are_held() {
    let problems = closed_form::check_size(&described(&SCREW.replace("HELD", ""))).unwrap_err().to_string();
    assert!(problems.starts_with("error[helical-joint]: closed forms are not available"), "{problems}");
    assert!(problems.contains("because joint `screw` is helical"), "{problems}");
    let worst = disagreement(&described(&SCREW.replace("HELD", "held = \"pi/2\"")), 5, 1.0);
    assert!(worst < 1e-10, "{worst:e}");
}

fn general_arm() -> String {
    let joint = |i: usize| {
        format!(
            "[[joints]]\nname = \"j{i}\"\naxis = [0.6, 0, 0.8]\ndrive = {{ rotor_inertia = 1e-5 }}\n\
             origin = {{ xyz = [0.1, 0.2, 0.3], rpy = [0.3, 0.4, 0.{i}] }}\n\
             [[bodies]]\nlink = \"j{i}\"\nmass = 1\ncenter_of_mass = [0.1, 0.2, 0.3]\ninertia = [0.3, 0.31, 0.32]\n"
        )
    };
    (5..8).map(joint).collect()
}

/// A written page and the output of the command.
struct Page {
    html: String,
    /// The text of `report.json`.
    data: String,
    said: String,
}

fn page(description: &str, options: &[&str]) -> Page {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_gelenk"))
        .args(["report", description, "--output"])
        .arg(folder.path())
        .args(options)
        .current_dir(models())
        .output()
        .unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    Page { html: read("index.html"), data: read("report.json"), said }
}

fn pages_hold_closed_forms() {
    let Page { html, data, said } = page("powercube.toml", &[]);
    assert!(html.contains("In closed form"));
    // The banner of the computer algebra goes to standard error.
    assert!(said.starts_with("wrote "), "{said}");
    let json = |latex: &str| latex.replace('\\', "\\\\");
    for expected in [
        r"M_{12} = p_{3} + i_{2} \, J_{2} + p_{2} \, \cos\left(y_{2}\right)",
        r"B_{22} = i_{2}",
        r"d_{\mathrm{2e}} \, \operatorname{sign}",
        "gear ratio of beta",
    ] {
        assert!(data.contains(&json(expected)), "no {expected} in {data}");
    }
    // Choices that change the equations reach the closed form, too.
    let Page { data, .. } = page("powercube.toml", &["--no-friction"]);
    assert!(!data.contains(&json(r"d_{\mathrm{1a}}")));
    let Page { data, .. } = page("powercube.toml", &["--smooth-sign", "150"]);
    assert!(!data.contains("operatorname{sign}"));
    assert!(data.contains(&json(r"d_{\mathrm{2e}} \, \tanh\left(150")), "{data}");
    for name in ["double_pendulum.toml", "cart_pole.toml"] {
        let Page { data, .. } = page(name, &["--format", "json"]);
        assert!(data.contains("closed-form-symbols"), "{name}");
    }
}

fn pages_say_why_they_hold_none() {
    let Page { html, data, said } = page("ur5.toml", &["--format", "json"]);
    assert!(html.contains("up to 3 coordinates, but <code>ur5</code> has 6"));
    assert!(!data.contains("closed-form-symbols"));
    let said: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(said["robot"], "ur5");
}

fn powercube_reads_as_published() {
    let model = model("powercube.toml");
    let forms = forms(&model);
    insta::assert_snapshot!("powercube_text", display::text(&forms, &defaults(&model)));
    insta::assert_snapshot!("powercube_latex", display::latex(&forms, &defaults(&model)));
}

fn small_robots_read_well() {
    for name in ["double_pendulum", "cart_pole", "powercube_alpha"] {
        let model = model(&format!("{name}.toml"));
        let text = display::text(&forms(&model), &defaults(&model));
        insta::assert_snapshot!(format!("{name}_text"), text);
    }
}

/// M, k, q of Nicodemus et al. 2022 as design.md prints them, friction included.
fn powercube_has_the_published_numbers() {
    let forms = forms(&model("powercube.toml"));
    let (i, j, h, g) = (161.0, 5.267e-5, 0.310_754_986_2, 9.806_65);
    let mut random = Random(3);
    for _ in 0..50 {
        let (y, v) = ([random.number(), random.number()], [random.number(), random.number()]);
        let values = forms.evaluate(&[], &y, &v);
        let (s2, c2) = y[1].sin_cos();
        let m12 = j * i + h * c2 + 0.660_889_906_856_5;
        let mass = [
            vec![j * i * i + 2.0 * h * c2 + 0.956_037_516_856_5, m12],
            vec![m12, j * i * i + 0.660_889_906_856_5],
        ];
        let sign = if v[1] > 0.0 { 1.0 } else { -1.0 };
        let q2 = 1.726_416_59 * g * (y[0] + y[1]).sin();
        let applied = [
            1.626_138 * g * y[0].sin() + q2
                - 3.924 * (5.0 * v[0]).tanh()
                - 10.838 * (10.0 * v[0]).tanh()
                - 2.236 * (20.0 * v[0]).tanh()
                - 76.556 * v[0],
            q2 - 0.368 * (5.0 * v[1]).tanh()
                - 0.368 * (10.0 * v[1]).tanh()
                - 8.342 * (100.0 * v[1]).tanh()
                - 0.492 * sign
                - 56.231 * v[1],
        ];
        let coriolis = [-h * s2 * (2.0 * v[0] * v[1] + v[1] * v[1]), h * v[0] * v[0] * s2];
        assert!(deviation(&values.mass_matrix.concat(), &mass.concat()) < 1e-12);
        assert!(deviation(&values.coriolis_forces, &coriolis) < 1e-12);
        assert!(deviation(&values.applied_forces, &applied) < 1e-12);
        assert_eq!(values.input_matrix, [[161.0, 0.0], [0.0, 161.0]]);
    }
}

/// Largest difference relative to the largest entry, or to 1e-6 if that is larger, for arrays that are zero.
fn deviation(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let largest = b.iter().fold(1e-6, |m: f64, x| m.max(x.abs()));
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, |m: f64, d| if d.is_nan() { f64::INFINITY } else { m.max(d) }) / largest
}

/// The recursive derivation's values at one state.
fn recursive(model: &Model, parameters: &[f64], y: &[f64], v: &[f64]) -> Vec<Vec<f64>> {
    let names = ["mass_matrix", "coriolis_forces", "applied_forces", "input_matrix"];
    let functions = selection::derive_functions(model, &names.map(str::to_owned), MOST_OPERATIONS).unwrap();
    let value = |name: &str| {
        let function = functions.iter().find(|function| function.name == name).unwrap();
        let inputs: Vec<&[f64]> =
            function.program.inputs.iter().map(|input| if input.name == "y" { y } else { v }).collect();
        interpret(&function.program, &inputs, parameters).unwrap().concat()
    };
    names.iter().map(|name| value(name)).collect()
}

fn flat(values: &Values) -> Vec<Vec<f64>> {
    vec![
        values.mass_matrix.concat(),
        values.coriolis_forces.clone(),
        values.applied_forces.clone(),
        values.input_matrix.concat(),
    ]
}

/// Largest deviation of M, k, q and B at random states and parameters.
fn disagreement(model: &Model, seed: u64, wrong: f64) -> f64 {
    let forms = forms(model);
    let n = model.coordinates.len();
    let mut random = Random(seed);
    let mut worst: f64 = 0.0;
    for _ in 0..20 {
        let y: Vec<f64> = (0..n).map(|_| 1.5 * random.number()).collect();
        let v: Vec<f64> = (0..n).map(|_| random.number()).collect();
        let vary = |p: f64| p * (1.0 + 0.2 * random.number());
        let parameters: Vec<f64> = defaults(model).into_iter().map(vary).collect();
        let shifted: Vec<f64> = parameters.iter().map(|p| p * wrong).collect();
        let values = flat(&forms.evaluate(&shifted, &y, &v));
        for (closed, expected) in values.iter().zip(recursive(model, &parameters, &y, &v)) {
            worst = worst.max(deviation(closed, &expected));
        }
    }
    worst
}

fn models_agree_with_the_recursive_derivation() {
    for (seed, name) in ["powercube", "double_pendulum", "cart_pole", "powercube_alpha"].iter().enumerate() {
        let worst = disagreement(&model(&format!("{name}.toml")), seed as u64, 1.0);
        println!("{name}: {worst:.1e}");
        assert!(worst < 1e-10, "{name}: {worst:e}");
    }
}

fn spatial_arms_agree_with_the_recursive_derivation() {
    for (name, text) in [("spatial", SPATIAL), ("mixed", MIXED), ("slanted", SLANTED), ("branched", BRANCHED)]
    {
        let worst = disagreement(&described(text), 7, 1.0);
        println!("{name}: {worst:.1e}");
        assert!(worst < 1e-10, "{name}: {worst:e}");
    }
}

fn the_comparison_sees_a_wrong_parameter() {
    assert!(disagreement(&model("double_pendulum.toml"), 5, 1.0 + 1e-8) > 1e-9);
}

/// Three revolute joints with general centres and inertias; each rotor sits on the link before its joint.
const SPATIAL: &str = r#"
[[joints]]
name = "waist"
axis = [0, 0, 1]
drive = { gear_ratio = 100, rotor_inertia = 3e-5 }
[[joints]]
name = "shoulder"
origin = { xyz = [0.1, 0.02, 0.3], rpy = ["-pi/2", 0, 0] }
axis = [0, 0, 1]
drive = { gear_ratio = -80, rotor_inertia = 2e-5, motor_constant = 0.05 }
friction = { viscous = 0.3, coulomb = { value = 0.7, slope = 20 } }
[[joints]]
name = "elbow"
origin = { xyz = [0.4, 0.03, -0.05], rpy = ["pi/2", 0, 0.4] }
axis = [0, 0, 1]
drive = { gear_ratio = 60, rotor_inertia = 4e-5 }
spring = { stiffness = 12, rest = 0.3, damping = 0.2 }
[[bodies]]
link = "waist"
mass = 4
center_of_mass = [0.03, -0.02, 0.1]
inertia = { xx = 0.05, yy = 0.06, zz = 0.04, xy = 0.002, xz = -0.003, yz = 0.004 }
[[bodies]]
link = "shoulder"
mass = 3
center_of_mass = [0.2, 0.01, -0.04]
inertia = { xx = 0.02, yy = 0.09, zz = 0.08, xy = -0.002, xz = 0.005, yz = 0.001 }
[[bodies]]
link = "elbow"
mass = 2
center_of_mass = [0.05, 0.06, 0.15]
inertia = { xx = 0.03, yy = 0.035, zz = 0.01, xy = 0.001, xz = 0.002, yz = -0.003 }
"#;

/// Sliding and turning joints, a free payload, a rotor on another link than its joint's parent.
const MIXED: &str = r#"
gravity = [0.3, "-g0/7", "-g0"]
[parameters]
g0 = 9.81
payload = 1.5
[[joints]]
name = "swing"
axis = [0, 1, 0]
drive = { gear_ratio = 50, rotor_inertia = 1e-4 }
[[joints]]
name = "reach"
type = "prismatic"
axis = [1, 0, 0]
origin = { xyz = [0.1, 0, 0.2] }
spring = "-5*pow(y, 3)"
drive = { gear_ratio = 300, rotor_inertia = 1e-5, axis = [0, 0, 1], carrier = "swing" }
[[joints]]
name = "roll"
axis = [1, 0, 0]
origin = { xyz = [0.3, 0.01, 0] }
drive = { gear_ratio = 90, rotor_inertia = 2e-5, carrier = "swing", axis = [0, 1, 0] }
[[bodies]]
link = "swing"
mass = 5
center_of_mass = [0.02, 0, 0.1]
inertia = [0.03, 0.04, 0.05]
[[bodies]]
link = "reach"
mass = 2
center_of_mass = [0.2, 0.03, 0]
inertia = 0.01
[[bodies]]
link = "roll"
mass = 1
center_of_mass = [0.1, 0.02, 0.03]
inertia = [0.002, 0.003, 0.004]
[[bodies]]
name = "payload"
link = "roll"
mass = "payload"
center_of_mass = [0.2, "0.01*payload", 0]
inertia = "payload*0.01"
"#;

/// Axes whose angles are not multiples of 90°, in the joint and in its origin.
const SLANTED: &str = r#"
[[joints]]
name = "first"
axis = [0, 0.6, 0.8]
[[joints]]
name = "second"
axis = [1, 0, 0]
origin = { xyz = [0, 0, 0.5], rpy = [0, 0.3, 0] }
drive = { gear_ratio = 20, rotor_inertia = 1e-4 }
[[bodies]]
link = "first"
mass = 2
center_of_mass = [0, 0, 0.2]
inertia = [0.02, 0.02, 0.001]
[[bodies]]
link = "second"
mass = 1
center_of_mass = [0, 0.2, 0]
inertia = [0.01, 0.001, 0.01]
"#;

/// Two arms on one torso, with a joint that is held beyond.
const BRANCHED: &str = r#"
[[joints]]
name = "torso"
axis = [0, 0, 1]
[[joints]]
name = "left"
axis = [0, 1, 0]
origin = { xyz = [0.1, 0.2, 0.4] }
drive = { gear_ratio = 20, rotor_inertia = 1e-4, coupling = "diagonal" }
[[joints]]
name = "hand"
axis = [1, 0, 0]
origin = { xyz = [0.3, 0, 0] }
held = 0.7
drive = { gear_ratio = 10, rotor_inertia = 3e-4 }
[[joints]]
name = "right"
parent = "torso"
axis = [0, 1, 0]
origin = { xyz = [0.1, -0.2, 0.4] }
[[bodies]]
link = "torso"
mass = 9
inertia = 0.2
[[bodies]]
link = "left"
mass = 2
center_of_mass = [0.1, 0.01, 0.02]
inertia = [0.001, 0.02, 0.02]
[[bodies]]
link = "hand"
mass = 0.5
center_of_mass = [0.02, 0.03, 0.04]
inertia = [0.001, 0.002, 0.0025]
[[bodies]]
link = "right"
mass = 2
center_of_mass = [0.1, -0.01, 0.02]
inertia = [0.001, 0.02, 0.02]
"#;
