//! A module is a plain value: what stands in it before anything is printed.
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use std::path::Path;

use gelenk_codegen::emit;
use gelenk_codegen::module::Module;
use gelenk_codegen::pipeline::{GenerateOptions, Generated, generate};

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
