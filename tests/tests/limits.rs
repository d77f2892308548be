//! Large robots: what is ordinary work, and what is refused.

use gelenk_codegen::emit;
use gelenk_codegen::functions::form::Form;
use gelenk_codegen::functions::selection;
use gelenk_codegen::functions::selection::{Request, derive};
use gelenk_codegen::functions::size::MOST_OPERATIONS;
use gelenk_codegen::module::Module;
use gelenk_codegen::program::cost::count;
use gelenk_tests::compiler::rustc;
use gelenk_tests::literature::{chain, right_angles};

const DOWN: [f64; 3] = [0.0, 0.0, -9.81];

fn selection(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

/// Growth with the number of joints, not its square.
#[test]
fn inverse_dynamics_of_500_joints() {
    let operations = |joints: usize| {
        let model = chain(&right_angles(joints), DOWN);
        let names = selection(&["inverse_dynamics"]);
        let functions = selection::derive_functions(&model, &names, MOST_OPERATIONS);
        let functions = functions.unwrap_or_else(|problems| panic!("{problems}"));
        let cost = count(&functions[0].program);
        cost.multiplications + cost.additions
    };
    let (fifty, many) = (operations(50), operations(500));
    assert!(many <= 11 * fifty, "{fifty} for 50 joints, {many} for 500");
}

/// Functions that are too large for 500 joints.
const LARGE: [&str; 10] = [
    "mass_matrix",
    "equations_of_motion",
    "mass_matrix_and_bias_forces",
    "forward_dynamics",
    "inverse_dynamics_derivatives",
    "inverse_dynamics_derivatives_and_mass_matrix",
    "forward_dynamics_derivatives",
    "linearize",
    "inertial_regressor",
    "base_regressor",
];

#[test]
fn large_functions_are_refused_with_their_count_and_the_option() {
    let model = chain(&right_angles(500), DOWN);
    let names = selection(&LARGE);
    let problems = selection::derive_functions(&model, &names, MOST_OPERATIONS).expect_err("too large");
    let refused: Vec<&str> = problems.entries().iter().map(|problem| problem.code).collect();
    assert_eq!(refused, vec!["too-large"; LARGE.len()]);
    let model = chain(&right_angles(12), DOWN);
    let names = selection(&["mass_matrix", "bias_forces"]);
    let problems = selection::derive_functions(&model, &names, 700).expect_err("too large");
    insta::assert_snapshot!(problems.to_string());
    assert!(selection::derive_functions(&model, &names, 2000).is_ok());
}

/// Large functions of the default selection are left out with all that call them, and a note says so.
#[test]
fn large_functions_are_left_out() {
    let model = chain(&right_angles(4), DOWN);
    let request = Request { names: &[], most: 700, form: Form::Straight, straight: &[] };
    let selected = derive(&model, &request).unwrap_or_else(|problems| panic!("{problems}"));
    let found = |name: &str| selected.functions.iter().any(|f| f.name == name);
    assert!(found("forward_dynamics") && !found("linearize"));
    let compositions: Vec<&str> = selected.compositions.iter().map(|each| each.name()).collect();
    assert_eq!(compositions, ["step"]);
    let notes: Vec<String> = selected.notes.iter().map(ToString::to_string).collect();
    insta::assert_snapshot!(notes.join("\n"));
    let names = selection(&["discretize"]);
    let request = Request { names: &names, ..request };
    let problems = derive(&model, &request).expect_err("asked for by name");
    assert_eq!(problems.entries()[0].code, "too-large");
    let names = selection(&["bias_forces", "forward_dynamics"]);
    let request = Request { names: &names, ..request };
    assert!(derive(&model, &request).is_ok());
}

/// Loops count once, however many operations they stand for: Talos has 44 joints.
#[test]
fn loops_count_as_their_text() {
    const MOST: usize = 10_000;
    let model = chain(&right_angles(16), DOWN);
    let names = selection(&["linearize"]);
    let functions = selection::derive_functions(&model, &names, MOST);
    let functions = functions.unwrap_or_else(|problems| panic!("{problems}"));
    let names: Vec<&str> = functions.iter().map(|function| function.name.as_str()).collect();
    assert_eq!(names, ["forward_dynamics_derivatives", "linearize"]);
    let cost = count(&functions[0].program);
    assert!(cost.multiplications + cost.additions > 2 * MOST);
    let source = emit::module(&Module::new(&model, functions, &[]), &Default::default());
    let lines = source.text.lines().count();
    assert!(lines < MOST, "{lines}");
}

/// Debug information limits rustc to functions of about 3 000 statements.
#[test]
fn modules_of_30_joints_compile_with_debug_information() {
    let model = chain(&right_angles(30), DOWN);
    let names = selection(&["mass_matrix", "inverse_dynamics"]);
    let functions = selection::derive_functions(&model, &names, MOST_OPERATIONS);
    let functions = functions.unwrap_or_else(|problems| panic!("{problems}"));
    let source = emit::module(&Module::new(&model, functions, &[]), &Default::default());
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = ["--crate-type", "lib", "-C", "debuginfo=2"];
    let result = rustc(folder.path(), "robot", &source.text, &arguments);
    result.unwrap_or_else(|message| panic!("{message}"));
}
