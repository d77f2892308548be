//! Large robots: what is ordinary work, and what is refused.

use gelenk_codegen::dynamics::catalogue;
use gelenk_codegen::dynamics::size::MOST_OPERATIONS;
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
        let functions = catalogue::derive(&model, &names, MOST_OPERATIONS);
        let functions = functions.unwrap_or_else(|problems| panic!("{problems}"));
        let cost = count(&functions[0].program);
        cost.multiplications + cost.additions
    };
    let (fifty, many) = (operations(50), operations(500));
    assert!(many <= 11 * fifty, "{fifty} for 50 joints, {many} for 500");
}

#[test]
fn large_functions_are_refused_with_their_count_and_the_option() {
    let model = chain(&right_angles(500), DOWN);
    let problems = catalogue::derive(&model, &[], MOST_OPERATIONS).expect_err("too large");
    let refused: Vec<&str> = problems
        .entries()
        .iter()
        .map(|problem| problem.code)
        .collect();
    assert_eq!(refused, vec!["too-large"; 10]);
    let model = chain(&right_angles(12), DOWN);
    let names = selection(&["mass_matrix", "bias_forces"]);
    let problems = catalogue::derive(&model, &names, 700).expect_err("too large");
    insta::assert_snapshot!(problems.to_string());
    assert!(catalogue::derive(&model, &names, 2000).is_ok());
}

/// With debug information rustc ends where a function has some 3 000 statements.
#[test]
fn modules_of_30_joints_compile_with_debug_information() {
    let model = chain(&right_angles(30), DOWN);
    let names = selection(&["mass_matrix", "inverse_dynamics"]);
    let functions = catalogue::derive(&model, &names, MOST_OPERATIONS);
    let functions = functions.unwrap_or_else(|problems| panic!("{problems}"));
    let source = gelenk_codegen::emit::module(&model, &functions, &[], &Default::default());
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = ["--crate-type", "lib", "-C", "debuginfo=2"];
    let result = rustc(folder.path(), "robot", &source.text, &arguments);
    result.unwrap_or_else(|message| panic!("{message}"));
}
