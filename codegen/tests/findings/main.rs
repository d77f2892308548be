//! Findings of `gelenk identify` as they are printed, one snapshot for each group of logs: a changed sentence is seen in a diff.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

mod arm;
mod online;
mod shared;

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

/// The commands with what they say: standard error, and standard output up to the table.
fn said(folder: &Path, commands: &[(&str, Vec<&str>)]) -> String {
    let mut text = String::new();
    for (name, arguments) in commands {
        let mut command = Command::new(env!("CARGO_BIN_EXE_gelenk"));
        let output = command.arg("identify").args(arguments).current_dir(folder).output().unwrap();
        let [printed, progress] =
            [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        let notices = printed.split("\n\n").next().unwrap_or_default().lines();
        let progress = progress.lines().filter(|line| !is_progress(line));
        writeln!(text, "== {name}, exit {}", output.status.code().unwrap()).unwrap();
        progress.chain(notices).for_each(|line| writeln!(text, "{line}").unwrap());
    }
    text
}

/// Whether a line says what is being done, with counts of samples alone.
fn is_progress(line: &str) -> bool {
    const STEPS: [&str; 9] = [
        "reading the logs",
        "smoothing",
        "choosing the terms",
        "comparing the logs",
        "The regressor is",
        "Terms",
        "Outliers",
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
