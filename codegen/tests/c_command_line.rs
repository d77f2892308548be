//! `gelenk generate --language c` and `gelenk check --language c` from outside: where files go, what they replace, and
//! what is refused.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use std::fs;
use std::path::Path;
use std::process::Command;

use gelenk_codegen::Builder;
use gelenk_codegen::emit::Language;

/// A folder with a description.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in ["cart_pole.toml", "powercube.toml"] {
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
        fs::copy(from.join(name), folder.path().join(name)).unwrap();
    }
    folder
}

/// Exit code and all that was printed.
fn gelenk(folder: &Path, line: &str) -> (i32, String) {
    let words = line.split(' ');
    let output = Command::new(env!("CARGO_BIN_EXE_gelenk")).args(words).current_dir(folder).output().unwrap();
    let text = [output.stdout, output.stderr].concat();
    (output.status.code().unwrap(), String::from_utf8(text).unwrap())
}

fn written(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
    let mut names: Vec<String> = entries.map(|name| name.into_string().unwrap()).collect();
    names.retain(|name| Path::new(name).extension().is_none_or(|extension| extension != "toml"));
    names.sort();
    names
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn a_module_goes_to_two_files_of_one_name() {
    let folder = folder();
    let folder = folder.path();
    for (line, place, names) in [
        ("", "", ["cart_pole.c", "cart_pole.h"]),
        (" --output firmware", "firmware", ["cart_pole.c", "cart_pole.h"]),
        (" --output firmware/", "firmware", ["cart_pole.c", "cart_pole.h"]),
        (" --output src/pole.c", "src", ["pole.c", "pole.h"]),
        (" --output include/pole.h", "include", ["pole.c", "pole.h"]),
    ] {
        let (code, text) = gelenk(folder, &format!("generate cart_pole.toml --language c{line}"));
        assert_eq!(code, 0, "{text}");
        let mut found = written(&folder.join(place));
        found.retain(|name| name.contains('.'));
        assert_eq!(found, names, "{line}");
    }
    assert!(read(folder, "src/pole.h").contains("\nvoid pole_mass_matrix("), "the files name the functions");
    assert!(read(folder, "src/pole.c").contains("#include \"pole.h\"\n"));
    assert!(
        read(folder, "src/pole.c")
            .contains("gelenk generate cart_pole.toml --output src/pole.c --language c")
    );
    let (_, again) = gelenk(folder, "generate cart_pole.toml --language c --output src/pole.c");
    assert!(again.starts_with("unchanged src/pole.h, src/pole.c: 2 coordinates, 1 input"), "{again}");
}

#[test]
fn a_plant_and_a_controller_can_be_linked_together() {
    let folder = folder();
    let folder = folder.path();
    let (code, text) =
        gelenk(folder, "generate powercube.toml --language c --control-model 50 --functions step");
    assert_eq!(code, 0, "{text}");
    assert_eq!(written(folder), ["powercube.c", "powercube.h", "powercube_control.c", "powercube_control.h"]);
    assert!(read(folder, "powercube_control.h").contains("void powercube_control_step("));
    assert!(read(folder, "powercube_control.c").contains("#include \"powercube_control.h\"\n"));
}

#[test]
fn tools_get_files_of_their_own() {
    let folder = folder();
    let folder = folder.path();
    let line = "powercube.toml --language c --for python --output src/arm.c --functions mass_matrix";
    assert_eq!(gelenk(folder, &format!("generate {line}")).0, 0);
    assert_eq!(written(&folder.join("src")), ["arm.c", "arm.h", "arm_python.c"]);
    let text = read(folder, "src/arm_python.c");
    assert!(text.contains("--functions mass_matrix --language c --for python\n"), "{text}");
    assert!(text.contains("\nvoid arm_python_mass_matrix(char **args"), "{text}");
    assert_eq!(gelenk(folder, &format!("check {line}")), (0, "fresh\n".to_owned()));
    fs::write(folder.join("src/arm_python.c"), "\n").unwrap();
    let (code, said) = gelenk(folder, &format!("check {line}"));
    assert!(code == 1 && said.starts_with("stale: src/arm_python.c\n"), "{said}");
    for (words, reason) in [
        ("--for casadi --scalar f32", "C modules have no functions for CasADi in single precision"),
        ("--for matlab", "invalid value 'matlab' for '--for <TOOLS>'"),
    ] {
        let (code, said) = gelenk(folder, &format!("generate powercube.toml --language c {words}"));
        assert!(code != 0 && said.contains(reason), "{said}");
    }
    // Nobody calls Rust that way.
    let (code, said) = gelenk(folder, "generate powercube.toml --for python");
    assert!(code == 1 && said.contains("written in C, but the language is Rust"), "{said}");
}

/// Joints with quaternions of every kind, an ordinary one, and a free parameter.
const FLOATING: &str = r#"
name = "floating"
base = { link = "hull", type = "floating" }
bodies = [
    { name = "hull", link = "hull", mass = 4, inertia = [0.2, 0.3, 0.4] },
    { name = "wheel", link = "wheel", mass = 1, inertia = [0.01, 0.02, 0.02] },
    { name = "boom", link = "boom", mass = "load", center_of_mass = [0, 0, 0.5], inertia = [0.1, 0.1, 0.01] },
]
joints = [
    { name = "wheel", parent = "hull", type = "continuous", axis = [1, 0, 0], drive = "ideal" },
    { name = "boom", parent = "hull", type = "spherical" },
]
frames = [{ name = "tip", link = "boom" }]
parameters = { load = 1.5 }
"#;

/// Free parameters, frames, several steps in a period, a robot without inputs, one whose functions are loops, one with
/// quaternions, all of its functions or few.
#[test]
fn files_for_tools_compile_without_a_word() {
    let folder = folder();
    let folder = folder.path();
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    for name in ["powercube_parameters.toml", "gripper.toml"] {
        fs::copy(models.join(name), folder.join(name)).unwrap();
    }
    let pendulum = "name = \"pendulum\"\njoints = [{ name = \"swing\", axis = [0, 1, 0] }]\n\
        bodies = [{ link = \"swing\", mass = \"m\", center_of_mass = [0, 0, -1], inertia = 0.1 }]\n\
        frames = [{ name = \"tip\", link = \"swing\" }]\ngenerate = { substeps = 3 }\nparameters = { m = 1 }\n";
    fs::write(folder.join("pendulum.toml"), pendulum).unwrap();
    fs::write(folder.join("floating.toml"), FLOATING).unwrap();
    let few = ["forward_dynamics", "forward_dynamics,step", "frames"];
    let few = few.map(|functions| ("floating", format!(" --functions {functions}")));
    let whole = ["powercube_parameters", "gripper", "pendulum", "cart_pole", "floating"];
    for (robot, words) in whole.map(|robot| (robot, " --functions all".to_owned())).into_iter().chain(few) {
        let line = format!("generate {robot}.toml --language c --output c --for casadi,python{words}");
        let (code, text) = gelenk(folder, &line);
        assert_eq!(code, 0, "{text}");
        for compiler in [&["cc", "-std=c99"][..], &["c++", "-x", "c++"]] {
            for tool in ["casadi", "python"] {
                let output = Command::new(compiler[0])
                    .args(&compiler[1..])
                    .args(["-Wall", "-Wextra", "-Werror", "-pedantic", "-c"])
                    .arg(format!("{robot}_{tool}.c"))
                    .current_dir(folder.join("c"))
                    .output();
                let Ok(output) = output else {
                    println!("skipped: no {}", compiler[0]);
                    continue;
                };
                let said = String::from_utf8(output.stderr).unwrap();
                assert!(output.status.success() && said.is_empty(), "{robot} {tool}: {said}");
            }
        }
    }
    let names = |text: &str| -> Vec<String> {
        let lines = text.lines().filter_map(|line| line.strip_prefix("PENDULUM_SYMBOL int "));
        lines
            .filter(|line| !line.contains("_work("))
            .map(|line| line[..line.find('(').unwrap()].to_owned())
            .collect()
    };
    let functions = ["dynamics", "inverse_dynamics", "step", "frame_tip"];
    let expected: Vec<String> = functions
        .iter()
        .flat_map(|name| ["", "jac_", "jac_jac_"].map(|of| format!("{of}pendulum_casadi_{name}")))
        .collect();
    assert_eq!(names(&read(&folder.join("c"), "pendulum_casadi.c")), expected);
    assert!(read(&folder.join("c"), "pendulum.h").contains(" pendulum_forward_dynamics_by_parameters("));
}

#[test]
fn functions_for_casadi_of_a_cart_pole() {
    let folder = folder();
    let line = "generate cart_pole.toml --language c --for casadi --functions forward_dynamics,linearize";
    let (code, text) = gelenk(folder.path(), line);
    assert_eq!(code, 0, "{text}");
    assert!(
        text.contains(
            "because the module lacks the functions in parentheses: `inverse_dynamics` (`inverse_dynamics`), `step` (`step`)"
        ),
        "{text}"
    );
    insta::assert_snapshot!(read(folder.path(), "cart_pole_casadi.c"));
}

/// The whole source, and of the file in Python what differs between robots.
#[test]
fn files_for_acados_of_a_cart_pole() {
    let folder = folder();
    let folder = folder.path();
    let line = "cart_pole.toml --language c --for acados --functions step,step_derivatives,input_matrix";
    let (code, text) = gelenk(folder, &format!("generate {line}"));
    assert_eq!(code, 0, "{text}");
    assert_eq!(written(folder), ["cart_pole.c", "cart_pole.h", "cart_pole_acados.c", "cart_pole_acados.py"]);
    let setup = read(folder, "cart_pole_acados.py");
    let (constants, _) = setup.split_once("\ndef parameters(").unwrap();
    insta::assert_snapshot!(format!("{}\n{constants}", read(folder, "cart_pole_acados.c")));
    assert_eq!(gelenk(folder, &format!("check {line}")), (0, "fresh\n".to_owned()));
    // A generated file is written over, another one is not.
    fs::write(folder.join("cart_pole_acados.py"), setup.replace("N = 2", "N = 3")).unwrap();
    assert_eq!(gelenk(folder, &format!("generate {line}")).0, 0);
    assert_eq!(read(folder, "cart_pole_acados.py"), setup);
    fs::write(folder.join("cart_pole_acados.py"), "print()\n").unwrap();
    let (code, text) = gelenk(folder, &format!("generate {line}"));
    assert!(code == 1 && text.contains("it was not generated by gelenk"), "{text}");
}

/// Robots and modules that acados cannot be given.
#[test]
fn what_acados_cannot_call_is_refused() {
    let folder = folder();
    let folder = folder.path();
    let swinging = "name = \"pendulum\"\njoints = [{ name = \"swing\", axis = [0, 1, 0] }]\n\
        bodies = [{ link = \"swing\", mass = 1, center_of_mass = [0, 0, -1], inertia = 0.1 }]\n";
    fs::write(folder.join("pendulum.toml"), swinging).unwrap();
    let driven = "name = \"rail\"\njoints = [{ name = \"rail\", axis = [1, 0, 0], motion = \"driven\" }, \
        { name = \"arm\", axis = [0, 1, 0], drive = \"ideal\" }]\n\
        bodies = [{ link = \"arm\", mass = 1, center_of_mass = [0, 0, 1], inertia = 0.1 }]\n";
    fs::write(folder.join("rail.toml"), driven).unwrap();
    for (words, reason) in [
        ("pendulum.toml", "functions for acados are not available, because the robot has no inputs"),
        ("rail.toml", "functions for acados are not available"),
        ("powercube.toml --scalar f32", "C modules have no functions for acados in single precision"),
        ("powercube.toml --functions step", "acados needs the function `step_derivatives`"),
        ("powercube.toml --functions step_derivatives,step", "acados needs the function `input_matrix`"),
    ] {
        let (code, said) = gelenk(folder, &format!("generate {words} --language c --for acados"));
        assert!(code == 1 && said.contains(reason), "{words}: {said}");
    }
    assert!(written(folder).is_empty());
}

/// JSON for tools that write bindings.
#[test]
fn json_says_how_functions_are_called() {
    let folder = folder();
    let folder = folder.path();
    fs::create_dir(folder.join("c")).unwrap();
    let line = "generate cart_pole.toml --language c --output c --functions linearize,step --format json";
    let (code, text) = gelenk(folder, line);
    assert_eq!(code, 0, "{text}");
    let printed: serde_json::Value = serde_json::from_str(&text).unwrap();
    let [module] = printed.as_array().unwrap().as_slice() else { panic!("{text}") };
    assert_eq!(module["read"], serde_json::json!(["cart_pole.toml"]));
    let interface = &module["interface"];
    assert_eq!(interface["prefix"], "cart_pole");
    let names = interface["functions"].as_array().unwrap().iter().map(|each| &each["name"]);
    assert_eq!(names.collect::<Vec<_>>(), ["forward_dynamics", "linearize", "step"]);
    let [linearize, step] = [1, 2].map(|index| &interface["functions"][index]);
    let b = &linearize["results"][2];
    assert_eq!([&b["name"], &b["symbol"]], ["b_x", "B_x"]);
    assert_eq!([&b["shape"], &b["dimensions"]], [&serde_json::json!([2, 1]), &serde_json::json!(["N", "M"])]);
    assert_eq!(linearize["arguments"][1]["entries"][1], serde_json::json!({"name": "pole", "unit": "rad/s"}));
    assert_eq!(step["arguments"][3]["shape"], serde_json::json!([]), "a number by value");
    let constants = interface["constants"].as_array().unwrap();
    let limits = constants.iter().find(|each| each["name"] == "VELOCITY_LIMITS").unwrap();
    assert_eq!(limits["value"][1], "inf", "JSON has no infinity");
}

#[test]
fn what_gelenk_has_not_generated_is_kept() {
    let folder = folder();
    let folder = folder.path();
    for foreign in ["cart_pole.h", "cart_pole.c"] {
        fs::write(folder.join(foreign), "int main(void) { return 0; }\n").unwrap();
        let (code, text) = gelenk(folder, "generate cart_pole.toml --language c");
        assert!(code == 1 && text.contains("it was not generated by gelenk"), "{text}");
        assert_eq!(written(folder), [foreign], "none of both is written");
        fs::remove_file(folder.join(foreign)).unwrap();
    }
    // A file that was read, under the name of a file to be written.
    fs::rename(folder.join("cart_pole.toml"), folder.join("pole.toml.h")).unwrap();
    let before = read(folder, "pole.toml.h");
    let (code, _) = gelenk(folder, "generate pole.toml.h --language c --output pole.toml.h");
    assert_ne!(code, 0);
    assert_eq!(read(folder, "pole.toml.h"), before);
}

#[test]
fn both_files_are_checked() {
    let folder = folder();
    let folder = folder.path();
    let line = "cart_pole.toml --language c --output src --functions mass_matrix";
    assert_eq!(gelenk(folder, &format!("generate {line}")).0, 0);
    assert_eq!(gelenk(folder, &format!("check {line}")), (0, "fresh\n".to_owned()));
    for name in ["src/cart_pole.h", "src/cart_pole.c"] {
        let text = read(folder, name);
        fs::write(folder.join(name), text.clone() + "\n").unwrap();
        let (code, said) = gelenk(folder, &format!("check {line}"));
        assert_eq!(code, 1);
        assert!(said.starts_with(&format!("stale: {name}\nrun: gelenk generate cart_pole.toml")), "{said}");
        fs::write(folder.join(name), text).unwrap();
    }
}

#[test]
fn what_c_does_not_have_is_refused() {
    let folder = folder();
    let folder = folder.path();
    for (line, expected, reason) in [
        ("--self-test", 1, "C modules have no tests at their end"),
        ("--output -", 2, "a C module consists of two files"),
        ("--output pole.rs", 2, "neither a folder nor a file name that ends with .c"),
        ("--output a\"b.c", 2, "is not usable in C"),
    ] {
        let (code, text) = gelenk(folder, &format!("generate cart_pole.toml --language c {line}"));
        assert_eq!(code, expected, "{text}");
        assert!(text.contains(reason), "{text}");
    }
    for file in ["pole.c", "pole.h"] {
        let (code, text) = gelenk(folder, &format!("generate cart_pole.toml --output {file}"));
        assert_eq!(code, 2, "a module in Rust is not called like one in C: {text}");
        assert!(text.contains("add `--language c`"), "{text}");
    }
    assert!(written(folder).is_empty());
    fs::create_dir_all(folder.join("models")).unwrap();
    fs::create_dir_all(folder.join("generated/src")).unwrap();
    for command in ["generate", "check"] {
        let (code, text) = gelenk(folder, &format!("{command} --language c"));
        assert_eq!(code, 2);
        assert!(text.contains("only the Rust crate of models/ can be generated"), "{text}");
    }
}

/// A description or the command line asks for lanes; a module for Python has all that are straight-line code.
#[test]
fn lanes_are_written_in_c_too() {
    let folder = folder();
    let folder = folder.path();
    for (line, functions) in [
        ("powercube.toml", &["linearize"][..]),
        ("cart_pole.toml --lanes mass_matrix,kinetic_energy", &["mass_matrix", "kinetic_energy"]),
        ("cart_pole.toml --functions inverse_dynamics,input_matrix --for python", &["inverse_dynamics"]),
        ("cart_pole.toml", &[]),
    ] {
        let (code, text) = gelenk(folder, &format!("generate {line} --language c --output robot.c"));
        assert_eq!(code, 0, "{text}");
        let header = read(folder, "robot.h");
        let lanes = header.lines().filter_map(|line| line.strip_prefix("void robot_"));
        let lanes = lanes.filter_map(|line| line.split('(').next()?.strip_suffix("_lanes"));
        assert_eq!(lanes.collect::<Vec<_>>(), functions, "{line}");
        assert_eq!(header.contains("#define ROBOT_LANES 8"), !functions.is_empty());
    }
    let (_, text) = gelenk(folder, "generate cart_pole.toml --language c --lanes step --output robot.c");
    assert!(text.contains("`step` cannot be generated for eight states at once (lanes)"), "{text}");
}

#[test]
fn build_scripts_write_c_as_well() {
    let folder = folder();
    let folder = folder.path();
    let paths = Builder::new()
        .description(folder.join("cart_pole.toml"))
        .language(Language::C)
        .output_folder(folder)
        .try_generate()
        .unwrap();
    assert_eq!(paths, [folder.join("cart_pole.h"), folder.join("cart_pole.c")]);
    assert_eq!(written(folder), ["cart_pole.c", "cart_pole.h"]);
}
