//! A package outside the workspace whose build script generates its robots: what its author sees when a
//! description is at fault, and that mending it is enough. It depends on the crates as they would be
//! published.

use std::fs;
use std::path::Path;

use gelenk_tests::cargo::{aloud, cargo, lock_like_here, success, target, text};
use gelenk_tests::packages::use_published;
use gelenk_tests::workspace;

/// Copies the sample package to a folder of its own, under a name of its own: tests share one folder of
/// programs.
fn copy_sample(to: &Path, package: &str) {
    let sample = workspace().join("tests/build_script_sample");
    fs::create_dir(to.join("src")).expect("a folder");
    for file in ["build.rs", "crane.toml", "pendulum.urdf", "src/main.rs"] {
        fs::copy(sample.join(file), to.join(file)).expect(file);
    }
    let manifest = format!(
        "[workspace]\n[package]\nname = {package:?}\nversion = \"0.1.0\"\nedition = \"2024\"\n\
         [dependencies]\ngelenk-runtime = {version:?}\n\
         [build-dependencies]\ngelenk-codegen = {{ version = {version:?}, default-features = false }}\n",
        version = env!("CARGO_PKG_VERSION"),
    );
    fs::write(to.join("Cargo.toml"), manifest).expect("the manifest");
    use_published(to);
    lock_like_here(to);
}

#[test]
fn a_faulty_description_is_a_readable_build_error() {
    let folder = tempfile::tempdir().expect("a folder");
    copy_sample(folder.path(), "outside");
    let crane = folder.path().join("crane.toml");
    let right = fs::read_to_string(&crane).expect("the description");
    let wrong = right.replace("mass = 4\n", "mass = -4\n").replace("gear_ratio", "gear_ration");
    fs::write(&crane, &wrong).expect("the description");
    let output = cargo(folder.path(), &["build"]);
    let message = text(&output.stderr);
    assert!(!output.status.success());
    for expected in ["crane.toml:7:11", "did you mean `gear_ratio`", "crane.toml:22:8", "-4"] {
        assert!(message.contains(expected), "no {expected:?} in:\n{message}");
    }
    assert!(!message.contains("panicked"), "{message}");

    // Cargo watches the description: mending it is enough.
    fs::write(&crane, &right).expect("the description");
    let printed = success(&cargo(folder.path(), &["run"]));
    // −9.81 (4 · 0.6 + 2 · 1.2)
    assert!(printed.contains("crane: -47.0880 N·m"), "{printed}");
}

#[test]
fn notes_are_shown_once_and_mistakes_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    copy_sample(folder.path(), "outside_notes");
    // Cargo knows packages by their names: this one was built before.
    success(&cargo(folder.path(), &["clean", "-p", "outside_notes"]));
    let change = |file: &str, from: &str, to: &str| {
        let path = folder.path().join(file);
        let text = fs::read_to_string(&path).expect(file);
        assert!(text.contains(from), "{from} in {file}");
        fs::write(&path, text.replacen(from, to, 1)).expect(file);
    };
    // Cargo repeats what a build script has said; this one runs again and has nothing left to say.
    let warnings = || {
        let output = aloud(folder.path(), &["build"]);
        success(&output);
        let said = text(&output.stderr);
        let lines = said.lines().filter(|line| line.starts_with("warning"));
        lines.collect::<Vec<_>>().join("\n")
    };
    change("pendulum.urdf", "<inertial>", "<visual/><inertial>");
    let first = warnings();
    assert!(first.contains("1 <visual>"), "{first}");
    assert_eq!([warnings(), warnings()], ["", ""]);
    // Other notes are shown.
    change("pendulum.urdf", "<inertial>", "<collision/><inertial>");
    let other = warnings();
    assert!(other.contains("1 <collision>"), "{other}");

    // Free parameters that were forgotten, and a robot that is called otherwise.
    change("src/main.rs", "Crane { parameters } =", "Crane =");
    change("src/main.rs", "mod pendulum\n", "mod pendlum\n");
    let build = || {
        let output = cargo(folder.path(), &["build"]);
        assert!(!output.status.success());
        text(&output.stderr)
    };
    let message = build();
    let missing = "generates no robot `pendlum`, but `crane` from crane.toml, `pendulum` from pendulum.urdf";
    assert!(message.contains(missing), "{message}");
    change("src/main.rs", "mod pendlum\n", "mod pendulum\n");
    let message = build();
    let forgotten = "write `struct Name { parameters } = module`";
    let first = message.split("error").nth(1).unwrap_or_default();
    assert!(first.contains("the module has free parameters"), "{message}");
    assert!(first.contains(forgotten), "{message}");

    // No module of an earlier run is left, however it is included.
    change(
        "src/main.rs",
        "gelenk_runtime::include_model!(\n    /// The pendulum of `pendulum.urdf`.\n    mod pendulum\n);",
        "mod pendulum {\n    include!(concat!(env!(\"OUT_DIR\"), \"/pendulum.rs\"));\n}",
    );
    change("pendulum.urdf", "<robot name=\"pendulum\">", "<robot name=\"rod\">");
    let message = build();
    assert!(message.contains("couldn't read"), "{message}");
}

/// The text of the description stands on the page of the module.
#[test]
fn the_documentation_of_a_module_is_its_description() {
    success(&cargo(&workspace(), &["doc", "-p", "gelenk-build-script-sample", "--no-deps"]));
    let page = target().join("doc/gelenk_build_script_sample/crane/index.html");
    let page = fs::read_to_string(page).expect("the page");
    assert!(page.contains("Slewing crane with a luffing boom and a payload at its end."));
}
