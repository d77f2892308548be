//! Examples tell what is at fault in words, and end with exit code 1.

#![allow(clippy::unwrap_used, reason = "test code")]

use crate::support::example;
use std::path::Path;
use std::process::{Command, Output};

fn run(name: &str, arguments: &[&Path]) -> Output {
    let mut command = Command::new(example::program(name));
    command.args(arguments).output().unwrap()
}

fn assert_error(name: &str, arguments: &[&Path], expected: &[&str]) {
    let output = run(name, arguments);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{name}: {said}");
    assert!(said.starts_with("error: "), "{name}: {said}");
    for words in expected {
        assert!(said.contains(words), "{name}: no {words:?} in {said}");
    }
}

#[test]
fn examples_say_what_is_wrong() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("example_errors");
    std::fs::create_dir_all(&folder).unwrap();
    let log = folder.join("log.csv");
    std::fs::write(&log, "t,q1\n").unwrap();
    // A file where a folder is wanted.
    for name in ["track", "feed_forward", "trajectories"] {
        assert_error(name, &[&log.join("folder")], &["log.csv/folder: "]);
    }
    assert_error("remote_loop", &["nowhere".as_ref()], &["nowhere"]);
    let port = ["--port".as_ref(), "seventy".as_ref()];
    assert_error("plant_process", &port, &["--port seventy: ", "--idle SECONDS"]);
}
