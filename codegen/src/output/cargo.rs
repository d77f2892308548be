//! Messages of a build script to Cargo.

use std::path::Path;

use crate::diagnostic::Diagnostic;

/// Command in the header of generated files: it builds the package of the build script.
pub(super) fn command() -> String {
    match std::env::var("CARGO_PKG_NAME") {
        Ok(package) => format!("cargo build -p {package}"),
        Err(_) => "cargo build".to_owned(),
    }
}

pub(super) fn watch(file: &Path) {
    println!("cargo::rerun-if-changed={}", one_line(&file.display().to_string()));
}

/// Prints a note as a Cargo warning. A warning is one line in Cargo's protocol.
pub(super) fn warn(note: &Diagnostic) {
    let place =
        note.location().map(|at| format!("{}:{}:{}: ", at.file, at.line, at.column)).unwrap_or_default();
    println!("cargo::warning={}", one_line(&format!("{place}{}", note.message)));
}

fn one_line(text: &str) -> String {
    text.replace(['\n', '\r'], " ")
}
