//! Findings of `gelenk identify` as they are printed, one snapshot for each group of logs: a changed sentence is seen in a diff.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

mod arm;
mod lines;
mod online;
mod shared;

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

/// Most lines that a command prints, whatever its logs hold.
const MOST_LINES: usize = 120;

/// Exit code, standard output and standard error of `gelenk identify`, which are short enough to be read.
fn run(folder: &Path, arguments: &[&str]) -> (i32, [String; 2]) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gelenk"));
    let output = command.arg("identify").args(arguments).current_dir(folder).output().unwrap();
    let printed = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    let lines: usize = printed.iter().map(|text| text.lines().count()).sum();
    let [out, err] = &printed;
    assert!(lines <= MOST_LINES, "{lines} lines of identify {arguments:?}:\n{err}{out}");
    (output.status.code().unwrap(), printed)
}

/// The commands with what they say: standard error, and standard output up to the table.
fn said(folder: &Path, commands: &[(&str, Vec<&str>)]) -> String {
    let mut text = String::new();
    for (name, arguments) in commands {
        let (code, [printed, progress]) = run(folder, arguments);
        let notices = printed.split("\n\n").next().unwrap_or_default().lines();
        let progress = progress.lines().filter(|line| !is_progress(line));
        writeln!(text, "== {name}, exit {code}").unwrap();
        progress.chain(notices).for_each(|line| writeln!(text, "{line}").unwrap());
    }
    text
}

/// Whether a line says what is being done, with counts of samples alone.
fn is_progress(line: &str) -> bool {
    const STEPS: [&str; 9] = [
        "reading the logs",
        "smoothing",
        "choosing the friction terms",
        "comparing the logs",
        "The equations of motion are",
        "Friction terms",
        "Pass ",
        "Intervals are",
        "Other explanations",
    ];
    line.strip_prefix("gelenk: ").is_some_and(|said| STEPS.iter().any(|step| said.starts_with(step)))
}

fn assert_said(group: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_snapshot_path("../snapshots/findings");
    settings.bind(|| insta::assert_snapshot!(group, text));
}
