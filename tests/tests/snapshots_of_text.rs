//! The small robots at each stage: when the text changes, the first stage that changed names the cause.
//!
//! The whole modules, derivatives included, stand in generated/; here is what a reviewer reads.

use gelenk_codegen::emit;
use gelenk_codegen::functions::selection;
use gelenk_codegen::functions::size::MOST_OPERATIONS;
use gelenk_codegen::model::Model;
use gelenk_codegen::module::Module;
use gelenk_codegen::program::display::{self, Notation};
use gelenk_codegen::read::{ReadOptions, read};
use gelenk_tests::workspace;

/// Functions that show every idiom of the emitted text.
const SHOWN: [&str; 6] = [
    "mass_matrix",
    "coriolis_forces",
    "applied_forces",
    "input_matrix",
    "inverse_dynamics",
    "forward_dynamics",
];

fn model(name: &str) -> Model {
    let path = workspace().join(format!("models/{name}.toml"));
    let loaded = read(&path, &ReadOptions::default());
    loaded.unwrap_or_else(|problems| panic!("{problems}")).model
}

#[test]
fn model_of_the_cart_pole() {
    insta::assert_debug_snapshot!("cart_pole_1_model", model("cart_pole"));
}

fn snapshots(name: &str) {
    let model = model(name);
    let selection = SHOWN.map(str::to_owned);
    let functions = selection::derive_functions(&model, &selection, MOST_OPERATIONS);
    let functions = functions.unwrap_or_else(|problems| panic!("{problems}"));
    let parameters = model.parameters.iter();
    let notation = Notation { parameters: parameters.map(|parameter| parameter.name.clone()).collect() };
    let programs = functions.iter().map(|function| {
        let text = display::text(&function.program, &notation);
        format!("# {}\n{text}\n", function.name)
    });
    insta::assert_snapshot!(format!("{name}_2_programs"), programs.collect::<String>());
    let text = emit::module(&Module::new(&model, functions, &[]), &Default::default()).text;
    insta::assert_snapshot!(format!("{name}_3_module"), text);
}

#[test]
fn powercube() {
    snapshots("powercube");
}

#[test]
fn powercube_alpha() {
    snapshots("powercube_alpha");
}

#[test]
fn cart_pole() {
    snapshots("cart_pole");
}

#[test]
fn double_pendulum() {
    snapshots("double_pendulum");
}
