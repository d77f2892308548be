//! Finds the program of an example.
#![allow(clippy::expect_used, reason = "test code: an example that does not build ends the test")]

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;

/// Path of an example, built where it is missing or older than its sources. `cargo test` of the workspace
/// builds the examples before it runs tests; `cargo test --test` of one does not.
pub fn program(name: &str) -> PathBuf {
    let here = std::env::current_exe().expect("a test knows its path");
    let folder = here.ancestors().nth(2).expect("it lies in target/*/deps");
    let path = folder.join("examples").join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let sources =
        [package.join("src"), package.join("examples/support"), package.join(format!("examples/{name}.rs"))];
    let newest = sources.iter().filter_map(|p| last_change(p)).max();
    if last_change(&path) < newest {
        build(name);
    }
    path
}

fn build(name: &str) {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["build", "--quiet", "--package", "gelenk-runtime"]);
    cargo.args(["--example", name]);
    if !cfg!(debug_assertions) {
        cargo.arg("--release");
    }
    let status = cargo.current_dir(env!("CARGO_MANIFEST_DIR")).status();
    assert!(status.expect("cargo runs").success());
}

/// None where there is nothing.
fn last_change(path: &Path) -> Option<SystemTime> {
    if path.is_dir() {
        let entries = std::fs::read_dir(path).ok()?;
        return entries.flatten().filter_map(|e| last_change(&e.path())).max();
    }
    path.metadata().ok()?.modified().ok()
}
