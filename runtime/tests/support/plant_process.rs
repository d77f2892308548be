//! Starts the program `plant_process`, and ends it.
#![allow(
    clippy::expect_used,
    reason = "test code: a plant that does not start ends the test"
)]

use std::io::{BufRead, BufReader};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::SystemTime;

/// A running plant process; killed when dropped.
pub struct PlantProcess {
    child: Child,
    pub address: SocketAddr,
}

impl PlantProcess {
    /// Starts the program and waits until it says where it listens.
    pub fn start(program: &Path, arguments: &[&str]) -> Self {
        let mut child = Command::new(program)
            .args(arguments)
            .env_remove("GELENK_EXAMPLE_SHORT")
            .stdout(Stdio::piped())
            .spawn()
            .expect("the plant process starts");
        let output = child.stdout.take().expect("its output is piped");
        let mut line = String::new();
        BufReader::new(output)
            .read_line(&mut line)
            .expect("its output can be read");
        let address = line
            .trim()
            .strip_prefix("listening on ")
            .and_then(|address| address.parse().ok())
            .unwrap_or_else(|| panic!("no address in {line:?}"));
        Self { child, address }
    }

    /// Ends it at once, without a chance to do anything, and waits until its socket is gone.
    pub fn kill(mut self) -> SocketAddr {
        self.end();
        self.address
    }

    fn end(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for PlantProcess {
    fn drop(&mut self) {
        self.end();
    }
}

/// Path of the program, built where it is missing or older than its sources. `cargo test` of the workspace builds the examples
/// before it runs tests; `cargo test --test` of one does not.
pub fn program() -> PathBuf {
    let here = std::env::current_exe().expect("a test knows its path");
    let folder = here.ancestors().nth(2).expect("it lies in target/*/deps");
    let path = folder
        .join("examples")
        .join(format!("plant_process{}", std::env::consts::EXE_SUFFIX));
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let sources = [
        package.join("src"),
        package.join("examples/plant_process.rs"),
    ];
    let newest = sources.iter().filter_map(|p| last_change(p)).max();
    if last_change(&path) < newest {
        build();
    }
    path
}

fn build() {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["build", "--quiet", "--package", "gelenk-runtime"]);
    cargo.args(["--example", "plant_process"]);
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
        return entries
            .flatten()
            .filter_map(|e| last_change(&e.path()))
            .max();
    }
    path.metadata().ok()?.modified().ok()
}
