//! Functions with loops over joints: their text compiles without a warning, for chains and trees, and
//! computes what the interpreter computes, bit for bit but for the sign of zeros.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use fastrand::Rng;
use gelenk_codegen::emit::{self, EmitOptions};
use gelenk_codegen::functions::form::Form;
use gelenk_codegen::functions::function::Function;
use gelenk_codegen::functions::selection::derive_in_form;
use gelenk_codegen::functions::size::MOST_OPERATIONS;
use gelenk_codegen::model::Model;
use gelenk_codegen::module::Module;
use gelenk_codegen::program::interpret::interpret;
use gelenk_codegen::read::{ReadOptions, read};
use gelenk_tests::compiler::{clippy, rustc};
use gelenk_tests::enumerated::{Chain, DIRECTIONS, Role};
use gelenk_tests::literature::{GENERAL, chain, right_angles};
use gelenk_tests::quaternion_model::with_quaternions;
use gelenk_tests::random_model::{
    random_coupled_model, random_helical_model, random_model, random_model_with_near_rotors,
};
use gelenk_tests::{table, workspace};

const NAMES: [&str; 4] = [
    "inverse_dynamics_derivatives",
    "inverse_dynamics_derivatives_and_mass_matrix",
    "forward_dynamics_derivatives",
    "linearize",
];

/// States of each robot.
const SAMPLES: usize = 3;

struct Robot {
    name: String,
    model: Model,
    functions: Vec<Function>,
    text: String,
}

/// Chains of all lengths of padding, and random trees with sliding joints, rotors, parameters and coordinates
/// out of order, some with joints that follow others, with helical joints, and with quaternions; chains in
/// every direction and origin.
fn robots(fused: bool) -> Vec<Robot> {
    let down = [0.0, 0.0, -9.81];
    let chains = [1, 2, 5, 13].map(|count| chain(&right_angles(count), down));
    let trees = (0..6).map(|seed| random_model_with_near_rotors(seed, 9));
    let coupled = (0..2).map(|seed| random_coupled_model(seed, 7));
    let helical = (0..2).map(|seed| random_helical_model(seed, 5));
    let kinds: [fn(u64, usize) -> Model; 3] = [random_model, random_coupled_model, random_helical_model];
    let floating = (0..3).zip(kinds);
    let floating = floating.map(|(seed, kind)| with_quaternions(kind(seed, 5), seed));
    let models = chains.into_iter().chain([chain(&GENERAL, down)]).chain(trees).chain(coupled).chain(helical);
    // Together all directions and origins.
    let placed: [(&[&str], usize); 4] = [
        (&["revolute", "spherical", "revolute"], 0),
        (&["spherical", "revolute"], 2),
        (&["universal", "floating"], 3),
        (&["helical", "planar", "prismatic"], 4),
    ];
    let others = if fused { DIRECTIONS.len() } else { 0 };
    let placed = placed
        .map(|(types, first)| Chain::placed(types, &vec![Role::Free; types.len()], first + others).model(1));
    let models = models.chain(floating).chain(placed);
    let in_loops = models.enumerate();
    let in_loops =
        in_loops.map(|(index, model)| robot(&format!("robot_{index}"), model, fused, Form::Arrays, &NAMES));
    in_loops.chain([quadruped(fused)]).collect()
}

/// A robot whose loops are products with M⁻¹ alone.
fn quadruped(fused: bool) -> Robot {
    let file = workspace().join("models/go2.toml");
    let read = read(&file, &ReadOptions::default()).unwrap_or_else(|problems| panic!("{problems}"));
    let robot = robot("go2", read.model, fused, Form::Cheapest, &NAMES[2..]);
    let mut notes = robot.functions.iter().flat_map(|function| &function.notes);
    assert!(notes.any(|note| note.contains("the products with M⁻¹ are loops")), "its loops are others");
    robot
}

fn robot(name: &str, mut model: Model, fused: bool, form: Form, names: &[&str]) -> Robot {
    model.name = name.to_owned();
    let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    let mut functions = derive_in_form(&model, &names, MOST_OPERATIONS, form, &[])
        .unwrap_or_else(|problems| panic!("{problems}"));
    for function in functions.iter_mut().filter(|_| fused) {
        if let Some(form) = function.arrays.take() {
            let form = form.fused();
            function.program = form.unrolled();
            function.arrays = Some(form);
        }
    }
    let text = emit::module(&Module::new(&model, functions.clone(), &[]), &EmitOptions::default()).text;
    Robot { name: name.to_owned(), model, functions, text }
}

#[test]
fn interpreter_and_compiled_loops_agree() {
    compare(false, &["0", "3"], &[]);
}

#[test]
fn fused_loops_agree_as_well() {
    let has_fma = std::arch::is_x86_feature_detected!("fma");
    if !has_fma {
        println!("skipped: no fused multiply-add here");
        return;
    }
    compare(true, &["3"], &["-C", "target-feature=+fma"]);
}

fn compare(fused: bool, levels: &[&str], flags: &[&str]) {
    let folder = tempfile::tempdir().expect("a folder");
    let robots = robots(fused);
    let trees = robots.iter().filter(|robot| robot.text.contains("RELATIONS"));
    assert!(trees.count() > 2, "too few trees");
    let have_rotors = |robot: &&Robot| robot.text.contains("carried_rotor");
    assert!(robots.iter().filter(have_rotors).count() > 2, "too few rotors");
    let are_coupled = robots.iter().filter(|robot| robot.text.contains("fn project"));
    assert!(are_coupled.count() > 2, "too few couplings");
    let have_quaternions = robots.iter().filter(|robot| robot.text.contains("fn gather_carriers"));
    assert!(have_quaternions.count() > 2, "too few quaternions");
    let mut modules = String::new();
    let mut table = String::new();
    for robot in &robots {
        let name = &robot.name;
        std::fs::write(folder.path().join(format!("{name}.rs")), &robot.text).expect("a file");
        let _ = writeln!(modules, "pub mod {name} {{ include!(\"{name}.rs\"); }}");
        table.push_str(&table::entry(name, &format!("robots::{name}"), &robot.text));
    }
    let calls: String = robots.iter().flat_map(requests).collect();
    std::fs::write(folder.path().join("flat.rs"), include_str!("../src/flat.rs")).expect("a file");
    let main = main_text(&modules, &table);
    std::fs::write(folder.path().join("requests.txt"), calls).expect("a file");
    for level in levels {
        let level = format!("opt-level={level}");
        let arguments = [&["-C", level.as_str(), "-A", "warnings"], flags].concat();
        rustc(folder.path(), "main", &main, &arguments).unwrap_or_else(|message| panic!("{message}"));
        run(&folder.path().join("main"));
    }
}

/// A program that compares each function's results with the requests, bit by bit but for the sign of zeros: loops
/// multiply the zeros of a tree, too.
fn main_text(modules: &str, table: &str) -> String {
    format!(
        "mod flat;\nmod robots {{\n{modules}}}\nuse flat::*;\nconst ROBOTS: &[Robot] = &[\n{table}];\n\
         fn check(robot: &str, function: &str, x: &[Vec<f64>], p: &[f64], expected: &[u64]) {{\n\
         let robot_calls = ROBOTS.iter().find(|(name, _)| *name == robot).unwrap().1;\n\
         let call = robot_calls.iter().find(|(name, _)| *name == function).unwrap().1;\n\
         let found: Vec<u64> = call(x, p).iter().map(|x| x.to_bits()).collect();\n\
         assert_eq!(found.len(), expected.len());\n\
         for (index, (a, b)) in found.iter().zip(expected).enumerate() {{\n\
         let are_zeros = (a | b) << 1 == 0;\n\
         assert!(a == b || are_zeros, \"{{robot}}::{{function}}[{{index}}]: compiled {{:e}}, interpreted {{:e}}\", f64::from_bits(*a), f64::from_bits(*b));\n\
         }}\n}}\nfn main() {{\nfor line in include_str!(\"requests.txt\").lines() {{\n\
         let words: Vec<&str> = line.split('|').collect();\n\
         let bits = |text: &str| -> Vec<u64> {{ text.split(',').filter(|x| !x.is_empty()).map(|x| x.parse().unwrap()).collect() }};\n\
         let numbers = |text: &str| -> Vec<f64> {{ bits(text).into_iter().map(f64::from_bits).collect() }};\n\
         let x: Vec<Vec<f64>> = words[4..].iter().map(|text| numbers(text)).collect();\n\
         check(words[0], words[1], &x, &numbers(words[2]), &bits(words[3]));\n}}\n}}\n"
    )
}

fn run(program: &Path) {
    let output = Command::new(program).output().expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Lines of robot, function, parameters, expected results and inputs; numbers as bits.
fn requests(robot: &Robot) -> Vec<String> {
    let mut rng = Rng::with_seed(7);
    let mut array = |len: usize| -> Vec<f64> { (0..len).map(|_| 6.0 * (rng.f64() - 0.5)).collect() };
    let parameters = robot.model.parameters.iter().map(|parameter| parameter.default).collect::<Vec<_>>();
    let mut lines = Vec::new();
    for function in &robot.functions {
        // Where a gain is a product of parameters `linearize` has to compute it.
        let may_compute = function.name == "linearize" && !robot.model.parameters.is_empty();
        assert!(function.arrays.is_some() || may_compute, "{}::{}", robot.name, function.name);
        for _ in 0..SAMPLES {
            let inputs: Vec<Vec<f64>> =
                function.program.inputs.iter().map(|input| array(input.extent.len)).collect();
            let slices: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
            let expected = interpret(&function.program, &slices, &parameters).expect("inputs fit").concat();
            let numbers = [&parameters, &expected].into_iter().chain(&inputs);
            let words: Vec<String> = numbers.map(|numbers| joined(numbers)).collect();
            lines.push(format!("{}|{}|{}\n", robot.name, function.name, words.join("|")));
        }
    }
    lines
}

fn joined(numbers: &[f64]) -> String {
    let bits: Vec<String> = numbers.iter().map(|x| x.to_bits().to_string()).collect();
    bits.join(",")
}

#[test]
fn loops_compile_without_a_warning() {
    let folder = tempfile::tempdir().expect("a folder");
    let check = ["--crate-type", "lib", "--emit", "metadata"];
    let mut outer = String::from(
        "#![deny(warnings, missing_docs, clippy::all, nonstandard_style, future_incompatible)]\n\
         #![no_std]\n//! Robots.\n",
    );
    for robot in robots(false) {
        let name = &robot.name;
        std::fs::write(folder.path().join(format!("{name}.rs")), &robot.text).expect("a file");
        let _ = writeln!(outer, "/// Robot.\npub mod {name} {{ include!(\"{name}.rs\"); }}");
    }
    clippy(folder.path(), "outer", &outer, &check).unwrap_or_else(|message| panic!("{message}"));
}

/// Two arms on a torso, and a motor whose shaft moves both, with friction on the shaft.
const SHAFT: &str = r#"
name = "shaft"
joints = [
    { name = "torso", axis = [0, 0, 1], drive = "ideal" },
    { name = "left", parent = "torso", axis = [0, 1, 0], origin = { xyz = [0, 0.2, 0.3] } },
    { name = "right", parent = "torso", axis = [0, 1, 0], origin = { xyz = [0, -0.2, 0.3] } },
]
bodies = [
    { link = "torso", mass = 4, inertia = 0.1 },
    { link = "left", mass = 2, center_of_mass = [0, 0, 0.2], inertia = 0.02 },
    { link = "right", mass = 1, center_of_mass = [0.1, 0, 0.2], inertia = 0.01 },
]
drives = [{ name = "motor", on = { left = 1, right = -1 }, gear_ratio = 10, friction = { viscous = 0.03 } }]
"#;

/// The friction of a shaft depends on two branches, which have nothing else in common: products keep what it adds.
#[test]
fn forces_between_branches_stay_in_the_products() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("shaft.toml");
    std::fs::write(&path, SHAFT).expect("a file");
    let model = read(&path, &ReadOptions::default()).unwrap_or_else(|problems| panic!("{problems}")).model;
    let [loops, straight] = [Form::Arrays, Form::Straight]
        .map(|form| robot("shaft", model.clone(), false, form, &["forward_dynamics_derivatives"]));
    assert!(loops.functions[0].arrays.is_some(), "there are no loops");
    let inputs: [&[f64]; 3] = [&[0.3, 0.5, -0.4], &[0.7, -1.2, 0.9], &[1.5, -0.6]];
    let [found, expected] = [loops, straight]
        .map(|robot| interpret(&robot.functions[0].program, &inputs, &[]).expect("inputs fit").concat());
    let largest = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    for (index, (found, expected)) in found.iter().zip(&expected).enumerate() {
        assert!((found - expected).abs() <= 1e-12 * largest, "{index}: {found}, {expected}");
    }
}
