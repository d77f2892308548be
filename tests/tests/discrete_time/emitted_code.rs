//! Generated code of robots of a size at which rows are calls: in f32, and as machine code.

use std::path::Path;
use std::process::Command;

use gelenk_codegen::emit::{EmitOptions, Scalar};
use gelenk_codegen::pipeline::{GenerateOptions, generate};
use gelenk_tests::compiler::rustc;
use gelenk_tests::workspace;

fn module(robot: &str, scalar: Scalar, functions: &[&str]) -> String {
    let options = GenerateOptions {
        functions: functions.iter().map(|name| (*name).to_owned()).collect(),
        emit: EmitOptions { scalar, ..EmitOptions::default() },
        ..GenerateOptions::default()
    };
    let description = workspace().join(format!("models/{robot}.toml"));
    let generated = generate(&description, &options);
    generated.unwrap_or_else(|problems| panic!("{problems}")).source.text
}

fn compile(folder: &Path, name: &str, text: &str, arguments: &[&str]) {
    rustc(folder, name, text, arguments).unwrap_or_else(|message| panic!("{message}"));
}

/// Compares both precisions: the largest differences, relative to the largest entry of each result.
const MAIN: &str = r#"
fn state<T: Copy>(from: fn(f64) -> T, seed: usize) -> T { from(((seed * 37) % 19) as f64 / 19.0 - 0.5) }
macro_rules! states { ($robot:ident, $from:expr, $s:expr) => { (
    core::array::from_fn::<_, { $robot::N }, _>(|i| state($from, $s + i)),
    core::array::from_fn::<_, { $robot::N }, _>(|i| state($from, $s + i + 50)),
    core::array::from_fn::<_, { $robot::M }, _>(|i| state($from, $s + i + 90)),
) } }
fn compare(what: &str, a: impl Iterator<Item = f64>, b: impl Iterator<Item = f32>) {
    let pairs: Vec<(f64, f64)> = a.zip(b.map(f64::from)).collect();
    let scale = pairs.iter().fold(0.0_f64, |scale, (a, _)| scale.max(a.abs()));
    let worst = pairs.iter().fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs() / scale));
    println!("{what} {worst:e}");
}
fn main() {
    for s in 0..10 {
        let (y, v, u) = states!(double, |x| x, s);
        let (y32, v32, u32) = states!(single, |x| x as f32, s);
        let (a, b) = (double::discretize(&y, &v, &u, 0.02), single::discretize(&y32, &v32, &u32, 0.02));
        compare("A_d", a.0.into_iter().flatten().flatten().flatten(), b.0.into_iter().flatten().flatten().flatten());
        compare("B_d", a.1.into_iter().flatten().flatten(), b.1.into_iter().flatten().flatten());
        compare("c_d", a.2.into_iter().flatten(), b.2.into_iter().flatten());
        let (a, b) = (double::step(&y, &v, &u, 0.02), single::step(&y32, &v32, &u32, 0.02));
        compare("y", a.0.into_iter(), b.0.into_iter());
        compare("v", a.1.into_iter(), b.1.into_iter());
        let (a, b) = (double::step_derivatives(&y, &v, &u, 0.02), single::step_derivatives(&y32, &v32, &u32, 0.02));
        compare("by state", a.2.into_iter().flatten().flatten().flatten(), b.2.into_iter().flatten().flatten().flatten());
        compare("by inputs", a.3.into_iter().flatten().flatten(), b.3.into_iter().flatten().flatten());
    }
}
"#;

/// A few hundred operations in f32 (unit roundoff 6e-8), six doublings among them.
#[test]
fn single_precision_stays_within_its_rounding() {
    let functions = ["discretize", "step", "step_derivatives"];
    for robot in ["powercube", "ur5"] {
        let folder = tempfile::tempdir().expect("a folder");
        let modules = [("double", Scalar::F64), ("single", Scalar::F32)];
        let modules = modules.map(|(name, scalar)| {
            let text = module(robot, scalar, &functions);
            format!("#[allow(dead_code)]\nmod {name} {{\n{text}}}\n")
        });
        let text = modules.concat() + MAIN;
        compile(folder.path(), "main", &text, &["-C", "opt-level=1"]);
        let output = Command::new(folder.path().join("main")).output().expect("it runs");
        assert!(output.status.success());
        let text = String::from_utf8(output.stdout).expect("UTF-8");
        assert_eq!(text.lines().count(), 70);
        for line in text.lines() {
            let (what, error) = line.rsplit_once(' ').expect("two columns");
            let error: f64 = error.parse().expect("a number");
            assert!(error <= 1e-4, "{robot}: {what} {error:e}");
        }
    }
}

/// Without `panic` in the machine code no check of a bound is left, and nothing else can panic.
#[test]
fn machine_code_cannot_panic() {
    let functions = ["discretize", "step", "step_derivatives"];
    for robot in ["powercube", "ur5", "double_pendulum"] {
        let folder = tempfile::tempdir().expect("a folder");
        let text = module(robot, Scalar::F64, &functions);
        let arguments = ["--crate-type", "lib", "--emit", "asm", "-C", "opt-level=3"];
        compile(folder.path(), robot, &text, &arguments);
        let assembly = std::fs::read_to_string(folder.path().join(format!("{robot}.s")));
        let assembly = assembly.expect("the machine code");
        assert!(functions.iter().all(|name| assembly.contains(name)));
        let panics: Vec<&str> = assembly.lines().filter(|line| line.contains("panic")).collect();
        assert!(panics.is_empty(), "{robot}: {panics:?}");
    }
}

/// Only what is asked for is pasted, and nothing of it is unused.
#[test]
fn each_function_compiles_alone() {
    for function in ["discretize", "step", "step_derivatives"] {
        for scalar in [Scalar::F64, Scalar::F32] {
            let folder = tempfile::tempdir().expect("a folder");
            let text = module("double_pendulum", scalar, &[function]);
            let arguments = ["--crate-type", "lib", "--emit", "metadata", "-D", "warnings"];
            compile(folder.path(), "alone", &text, &arguments);
        }
    }
}
