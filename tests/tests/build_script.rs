//! A package outside the workspace whose build script generates its robots: what its author sees when a
//! description is at fault, and that mending it is enough. It depends on the crates as they would be
//! published.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::fs;
use std::path::Path;
use std::process::Command;

use gelenk_tests::cargo::{aloud, cargo, lock_like_here, success, target, text};
use gelenk_tests::packages::use_published;
use gelenk_tests::workspace;
use serde_json::Value;

/// Copies the sample package to a folder of its own, under a name of its own: tests share one folder of
/// programs.
fn copy_sample(to: &Path, package: &str) {
    let sample = workspace().join("tests/build_script_sample");
    fs::create_dir(to.join("src")).expect("a folder");
    for file in ["build.rs", "crane.toml", "pendulum.urdf", "src/main.rs"] {
        fs::copy(sample.join(file), to.join(file)).expect(file);
    }
    let manifest = fs::read_to_string(sample.join("Cargo.toml")).expect("the manifest");
    // Its own version, and those of the two crates.
    assert_eq!(manifest.matches(&format!("= {:?}", env!("CARGO_PKG_VERSION"))).count(), 3, "{manifest}");
    let manifest = manifest.replace("gelenk-build-script-sample", package);
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
    // Its author's own tests pass, and there is nothing to warn of.
    let tested = aloud(folder.path(), &["test"]);
    assert!(success(&tested).contains("4 passed"), "{}", text(&tested.stdout));
    assert!(!text(&tested.stderr).contains("warning"), "{}", text(&tested.stderr));
    // The text of the description stands on the page of the module.
    let page = documentation(folder.path(), "crane");
    assert!(page.contains("Slewing crane with a luffing boom and a payload at its end."));
}

/// The page of a module of a package that was built, written by rustdoc alone: Cargo would read all that the package depends on
/// once more.
fn documentation(package: &Path, module: &str) -> String {
    let messages = success(&cargo(package, &["build", "--message-format", "json"]));
    let messages: Vec<Value> =
        messages.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let of_package = |message: &&Value| {
        let id = message["package_id"].as_str().unwrap_or_default();
        message["reason"] == "build-script-executed" && id.contains(package.to_str().expect("a path"))
    };
    let script = messages.iter().find(of_package).expect("its build script has run");
    let runtime =
        messages.iter().find(|message| message["target"]["name"] == "gelenk_runtime").expect("the runtime");
    let library = runtime["filenames"][0].as_str().expect("a library");
    let mut rustdoc = Command::new("rustdoc");
    rustdoc
        .current_dir(package)
        .args([
            "--edition",
            "2024",
            "--crate-name",
            "sample",
            "--document-private-items",
            "-o",
            "pages",
            "src/main.rs",
        ])
        .args(["--extern", &format!("gelenk_runtime={library}")])
        .arg("-L")
        .arg(target().join("debug/deps"))
        .env("OUT_DIR", script["out_dir"].as_str().expect("a folder"));
    success(&rustdoc.output().expect("rustdoc starts"));
    fs::read_to_string(package.join(format!("pages/sample/{module}/index.html"))).expect("the page")
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
