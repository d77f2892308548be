//! Packages outside the workspace, built as their authors would build them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::workspace;

/// The folder that this test was compiled into, so that dependencies are not compiled again.
///
/// # Panics
/// Where this program does not lie in `target/*/deps`.
pub fn target() -> PathBuf {
    let program = std::env::current_exe().expect("this program");
    let folder = program.ancestors().nth(3).expect("target/debug/deps");
    folder.to_owned()
}

/// Runs cargo in a folder, quietly and without a network.
///
/// # Panics
/// Where cargo does not start.
pub fn cargo(folder: &Path, arguments: &[&str]) -> Output {
    aloud(folder, &[&["--quiet"], arguments].concat())
}

/// The workspace's optimization of other people's packages: with another one all of them would be compiled again. Ours are
/// compiled anew in any case, sooner without it.
fn optimization() -> Vec<String> {
    let manifest = include_str!("../../Cargo.toml");
    let table = manifest
        .split("\n[profile.dev.package]\n")
        .nth(1)
        .expect("the workspace's table of optimized packages");
    let lines = table.lines().take_while(|line| !line.starts_with('['));
    let packages = lines.filter_map(|line| line.strip_suffix(" = { opt-level = 1 }"));
    let packages = packages.filter(|name| !name.starts_with("gelenk-"));
    packages
        .flat_map(|name| ["--config".to_owned(), format!("profile.dev.package.{name}.opt-level=1")])
        .collect()
}

/// As [`cargo`], with what Cargo says by itself: warnings of build scripts among it.
///
/// # Panics
/// Where cargo does not start.
pub fn aloud(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO"))
        .arg("--offline")
        .args(optimization())
        .args(arguments)
        .env("CARGO_TARGET_DIR", target())
        .env("CARGO_TERM_COLOR", "never")
        .current_dir(folder)
        .output()
        .expect("cargo starts")
}

/// Gives a package the versions of this workspace: they are at hand without a network.
///
/// # Panics
/// Where the file cannot be copied.
pub fn lock_like_here(folder: &Path) {
    fs::copy(workspace().join("Cargo.lock"), folder.join("Cargo.lock")).expect("the lock file");
}

/// Printed text.
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Standard output of a command that succeeds.
///
/// # Panics
/// With what was printed to standard error, where the command has failed.
pub fn success(output: &Output) -> String {
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout)
}
