//! The emitted code of every robot: it compiles without a warning, and computes what the interpreter
//! computes.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use fastrand::Rng;
use gelenk_codegen::emit::Scalar;
use gelenk_codegen::functions::function::Function;
use gelenk_codegen::layout::Dimension;
use gelenk_codegen::model::Model;
use gelenk_codegen::pipeline::Generated;
use gelenk_codegen::program::interpret::interpret;
use gelenk_tests::compiler::{clippy, rustc};
use gelenk_tests::flat::Call;
use gelenk_tests::generated::ROBOTS;
use gelenk_tests::positions::normalize;
use gelenk_tests::single::{self, Bounded};
use gelenk_tests::{descriptions, generate_whole_model, table};

/// Random states per function.
const SAMPLES: usize = 20;

/// Input arrays of a function: mostly of ordinary size, some exact zeros.
fn random_inputs(rng: &mut Rng, model: &Model, function: &Function) -> Vec<Vec<f64>> {
    let mut entry = || match rng.u8(0..10) {
        0 => 0.0,
        1 => 30.0 * (rng.f64() - 0.5),
        _ => 6.0 * (rng.f64() - 0.5),
    };
    let inputs = function.program.inputs.iter();
    let arrays = inputs.map(|array| {
        let mut entries: Vec<f64> = (0..array.extent.len).map(|_| entry()).collect();
        if array.extent.dimension == Dimension::Positions {
            normalize(model, &mut entries);
        }
        entries
    });
    arrays.collect()
}

/// Near the described values.
fn random_parameters(rng: &mut Rng, model: &Model) -> Vec<f64> {
    let parameters = model.parameters.iter();
    parameters.map(|parameter| parameter.default * (0.5 + rng.f64())).collect()
}

fn slices(arrays: &[Vec<f64>]) -> Vec<&[f64]> {
    arrays.iter().map(Vec::as_slice).collect()
}

/// The compiled robot of this name: names and calls, in the order of the module.
fn compiled(name: &str) -> &'static [(&'static str, Call)] {
    let robot = ROBOTS.iter().find(|(robot, _)| *robot == name);
    robot.unwrap_or_else(|| panic!("generated/ lacks {name}")).1
}

/// Suffix of functions that write their results in place.
const IN_PLACE: &str = "_into";

/// The derived function behind a compiled one.
fn derived_function<'r>(robot: &'r Generated, name: &str) -> &'r Function {
    let name = name.strip_suffix(IN_PLACE).unwrap_or(name);
    let function = robot.module.functions.iter().find(|function| function.name == name);
    function.unwrap_or_else(|| panic!("{}::{name} was not derived", robot.source.name))
}

/// The models of this repository, each generated once.
fn robots(scalar: Scalar) -> &'static [Generated] {
    static ROBOTS: [OnceLock<Vec<Generated>>; 2] = [const { OnceLock::new() }; 2];
    let generated =
        || descriptions().iter().map(|description| generate_whole_model(description, scalar)).collect();
    ROBOTS[usize::from(scalar == Scalar::F32)].get_or_init(generated)
}

#[test]
fn interpreter_and_compiled_code_agree_in_every_bit() {
    assert_eq!(ROBOTS.len(), descriptions().len());
    for robot in robots(Scalar::F64) {
        let calls = compiled(&robot.source.name);
        let names = calls.iter().map(|(name, _)| *name);
        let names: Vec<&str> = names.filter(|name| !name.ends_with(IN_PLACE)).collect();
        let derived: Vec<&str> = robot.module.functions.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(names, derived, "functions of {}", robot.source.name);
        let mut rng = Rng::with_seed(1);
        for (name, call) in calls {
            let function = derived_function(robot, name);
            for _ in 0..SAMPLES {
                let inputs = random_inputs(&mut rng, &robot.model, function);
                let parameters = random_parameters(&mut rng, &robot.model);
                let expected =
                    interpret(&function.program, &slices(&inputs), &parameters).expect("inputs fit").concat();
                let found = call(&inputs, &parameters);
                let what = format!("{}::{name}", robot.source.name);
                assert_same_bits(&what, &found, &expected);
            }
        }
    }
}

/// IEEE 754 leaves sign and payload of a NaN open; all other values must agree in every bit.
fn assert_same_bits(what: &str, found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (index, (a, b)) in found.iter().zip(expected).enumerate() {
        let same = a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
        assert!(same, "{what}[{index}]: compiled {a:?}, interpreted {b:?}");
    }
}

#[test]
fn modules_compile_without_a_warning() {
    let folder = tempfile::tempdir().expect("a folder");
    let check = ["--crate-type", "lib", "--emit", "metadata"];
    let mut outer = String::from(
        "#![deny(warnings, missing_docs, clippy::all, nonstandard_style, future_incompatible)]\n\
         #![no_std]\n//! Robots.\n",
    );
    for scalar in [Scalar::F64, Scalar::F32] {
        for Generated { source, .. } in robots(scalar) {
            let name = format!("{}_{scalar:?}", source.name).to_lowercase();
            // Small processors compute f64 in software, a product in some forty instructions.
            assert!(scalar == Scalar::F64 || !source.text.contains("f64"), "{name} holds f64");
            // All of them through `include!`, and those for f64 by themselves too, which writes them.
            if scalar == Scalar::F64 {
                let alone = [&check[..], &["-D", "warnings"]].concat();
                let result = rustc(folder.path(), &name, &source.text, &alone);
                result.unwrap_or_else(|message| panic!("{name}: {message}"));
            } else {
                std::fs::write(folder.path().join(format!("{name}.rs")), &source.text).expect("a file");
            }
            let _ = writeln!(outer, "/// Robot.\npub mod {name} {{ include!(\"{name}.rs\"); }}");
        }
    }
    let result = clippy(folder.path(), "outer", &outer, &check);
    result.unwrap_or_else(|message| panic!("{message}"));
}

/// The f32 modules, compiled with a loop that calls what standard input asks for.
fn build_f32(folder: &Path, robots: &[Generated]) {
    let flat = include_str!("../src/flat.rs");
    std::fs::write(folder.join("flat.rs"), flat).expect("a file");
    let mut table = String::new();
    let mut modules = String::new();
    for Generated { source, .. } in robots {
        let name = &source.name;
        std::fs::write(folder.join(format!("{name}.rs")), &source.text).expect("a file");
        let _ = writeln!(modules, "pub mod {name} {{ include!(\"{name}.rs\"); }}");
        table.push_str(&table::entry(name, &format!("robots::{name}"), &source.text));
    }
    let main = format!(
        "mod flat;\nmod robots {{\n{modules}}}\nuse flat::*;\nconst ROBOTS: &[Robot] = &[\n{table}];\n{MAIN}"
    );
    let arguments = ["-C", "opt-level=1", "-A", "warnings"];
    rustc(folder, "main", &main, &arguments).unwrap_or_else(|message| panic!("{message}"));
}

/// Each line holds a robot, a function, parameters, and input arrays; numbers as bits of their f64.
const MAIN: &str = r#"
fn numbers(text: &str) -> Vec<f64> {
    let words = text.split(',').filter(|word| !word.is_empty());
    words.map(|bits| f64::from_bits(bits.parse().unwrap())).collect()
}
fn main() {
    for line in std::io::stdin().lines() {
        let line = line.unwrap();
        let mut words = line.split('|');
        let mut index = || words.next().unwrap().parse::<usize>().unwrap();
        let call = ROBOTS[index()].1[index()].1;
        let parameters = numbers(words.next().unwrap());
        let inputs: Vec<Vec<f64>> = words.map(numbers).collect();
        let bits = call(&inputs, &parameters).iter().map(|x| x.to_bits().to_string()).collect::<Vec<_>>();
        println!("{}", bits.join(","));
    }
}
"#;

fn joined(numbers: &[f64]) -> String {
    let bits: Vec<String> = numbers.iter().map(|x| x.to_bits().to_string()).collect();
    bits.join(",")
}

/// Runs the compiled program on all requests; one array per request.
fn run(folder: &Path, requests: String) -> Vec<Vec<f64>> {
    let mut child = Command::new(folder.join("main"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut stdin = child.stdin.take().expect("standard input");
    // In a thread of its own: both pipes may be full.
    let writer = std::thread::spawn(move || stdin.write_all(requests.as_bytes()));
    let output = child.wait_with_output().expect("the program ends");
    writer.join().expect("no panic").expect("all is read");
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).expect("numbers");
    let number = |bits: &str| f64::from_bits(bits.parse().expect("bits"));
    text.lines().map(|line| line.split(',').filter(|word| !word.is_empty()).map(number).collect()).collect()
}

#[test]
fn f32_modules_agree_within_their_rounding() {
    let folder = tempfile::tempdir().expect("a folder");
    let robots = robots(Scalar::F32);
    build_f32(folder.path(), robots);
    let mut rng = Rng::with_seed(2);
    let (mut requests, mut samples) = (String::new(), Vec::new());
    for (index, robot) in robots.iter().enumerate() {
        for (at, name) in table::functions(&robot.source.text).iter().enumerate() {
            let function = derived_function(robot, name);
            // Numbers that f32 holds exactly.
            let short = |x: f64| f64::from(x as f32);
            let inputs: Vec<Vec<f64>> = random_inputs(&mut rng, &robot.model, function)
                .iter()
                .map(|array| array.iter().copied().map(short).collect())
                .collect();
            let parameters = random_parameters(&mut rng, &robot.model);
            let parameters: Vec<f64> = parameters.into_iter().map(short).collect();
            let words: Vec<String> = inputs.iter().map(|array| joined(array)).collect();
            let _ = write!(requests, "{index}|{at}|{}", joined(&parameters));
            words.iter().for_each(|word| requests.push_str(&format!("|{word}")));
            requests.push('\n');
            samples.push((robot, function, inputs, parameters));
        }
    }
    let found = run(folder.path(), requests);
    assert_eq!(found.len(), samples.len());
    for ((robot, function, inputs, parameters), found) in samples.iter().zip(found) {
        let what = format!("{}::{}", robot.source.name, function.name);
        let expected = single::interpret(&function.program, inputs, parameters);
        assert_same_bits(&what, &found, &expected);
        for (x, Bounded { value, error }) in
            found.iter().zip(single::bounds(&function.program, inputs, parameters))
        {
            assert!((x - value).abs() <= error, "{what}: {x} is not {value} ± {error:e}");
        }
    }
}
