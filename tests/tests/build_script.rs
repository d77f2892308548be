//! A package outside the workspace whose build script generates its robots: what its author sees when a description is
//! at fault, and that mending it is enough.

use std::fs;
use std::path::Path;

use gelenk_tests::cargo::{cargo, lock_like_here, success, text};
use gelenk_tests::workspace;

/// Copies the sample package to a folder of its own.
fn copy_sample(to: &Path) {
    let sample = workspace().join("tests/build_script_sample");
    fs::create_dir(to.join("src")).expect("a folder");
    for file in ["build.rs", "crane.toml", "pendulum.urdf", "src/main.rs"] {
        fs::copy(sample.join(file), to.join(file)).expect(file);
    }
    let path = |name: &str| workspace().join(name).display().to_string();
    let manifest = format!(
        "[workspace]\n[package]\nname = \"outside\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\
         [dependencies]\ngelenk-runtime = {{ path = {:?} }}\n\
         [build-dependencies]\ngelenk-codegen = {{ path = {:?}, default-features = false }}\n",
        path("runtime"),
        path("codegen"),
    );
    fs::write(to.join("Cargo.toml"), manifest).expect("the manifest");
    lock_like_here(to);
}

#[test]
fn a_faulty_description_is_a_readable_build_error() {
    let folder = tempfile::tempdir().expect("a folder");
    copy_sample(folder.path());
    let crane = folder.path().join("crane.toml");
    let right = fs::read_to_string(&crane).expect("the description");
    let wrong = right
        .replace("mass = 4\n", "mass = -4\n")
        .replace("gear_ratio", "gear_ration");
    fs::write(&crane, &wrong).expect("the description");
    let output = cargo(folder.path(), &["build"]);
    let message = text(&output.stderr);
    assert!(!output.status.success());
    for expected in [
        "crane.toml:7:11",
        "did you mean `gear_ratio`",
        "crane.toml:22:8",
        "-4",
    ] {
        assert!(message.contains(expected), "no {expected:?} in:\n{message}");
    }
    assert!(!message.contains("panicked"), "{message}");

    // Cargo watches the description: mending it is enough.
    fs::write(&crane, &right).expect("the description");
    let printed = success(&cargo(folder.path(), &["run"]));
    // −9.81 (4 · 0.6 + 2 · 1.2)
    assert!(printed.contains("crane: -47.0880 N·m"), "{printed}");
}
