//! rustc and clippy on texts, as a user would call them.

use std::fs;
use std::path::Path;
use std::process::Command;

/// Compiles `text` as `name.rs` in a folder with rustc; the message of a failure is the error.
///
/// # Errors
/// What rustc said.
pub fn rustc(folder: &Path, name: &str, text: &str, arguments: &[&str]) -> Result<(), String> {
    compile("rustc", folder, name, text, arguments)
}

/// As [`rustc`], by clippy; skipped with a note where there is none, outside CI.
///
/// # Errors
/// What clippy said.
pub fn clippy(folder: &Path, name: &str, text: &str, arguments: &[&str]) -> Result<(), String> {
    let version = Command::new("clippy-driver").arg("--version").output();
    if version.is_err() && std::env::var_os("CI").is_none() {
        println!("skipped: no clippy-driver");
        return Ok(());
    }
    compile("clippy-driver", folder, name, text, arguments)
}

fn compile(program: &str, folder: &Path, name: &str, text: &str, arguments: &[&str]) -> Result<(), String> {
    let file = format!("{name}.rs");
    fs::write(folder.join(&file), text).map_err(|error| error.to_string())?;
    let output = Command::new(program)
        // The flags of the calling cargo would be taken for this file's.
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env_remove("RUSTFLAGS")
        .current_dir(folder)
        .args(["--edition", "2024", &file])
        .args(arguments)
        .output()
        .map_err(|error| format!("{program}: {error}"))?;
    if output.status.success() { Ok(()) } else { Err(String::from_utf8_lossy(&output.stderr).into_owned()) }
}
