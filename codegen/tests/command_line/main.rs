//! The program `gelenk` from outside: help, messages, exit codes.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

mod files;
mod identify;
mod new_crate;
mod schema;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn gelenk(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gelenk")).args(arguments).current_dir(folder).output().unwrap()
}

fn shown(output: &Output) -> String {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    format!(
        "exit {}\n--- stdout\n{}--- stderr\n{}",
        output.status.code().unwrap(),
        text(&output.stdout),
        text(&output.stderr)
    )
}

/// Exit code and standard error of a command that is refused.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = gelenk(folder, arguments);
    assert_eq!(output.status.code(), Some(1), "{}", shown(&output));
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn help_of_all_commands() {
    let folder = tempfile::tempdir().unwrap();
    for (name, arguments) in [
        ("help", vec!["--help"]),
        ("help_generate", vec!["generate", "--help"]),
        ("help_check", vec!["check", "--help"]),
        ("help_inspect", vec!["inspect", "--help"]),
        ("help_new", vec!["new", "--help"]),
        ("help_report", vec!["report", "--help"]),
        ("help_identify", vec!["identify", "--help"]),
        ("help_export", vec!["export", "--help"]),
        ("help_schema", vec!["schema", "--help"]),
    ] {
        insta::assert_snapshot!(name, shown(&gelenk(folder.path(), &arguments)));
    }
}

#[test]
fn wrong_command_lines_end_with_2() {
    let folder = tempfile::tempdir().unwrap();
    for (name, arguments) in [
        ("unknown_command", vec!["generat"]),
        ("unknown_option", vec!["generate", "arm.urdf", "--snap-angle", "1"]),
        ("large_angle", vec!["generate", "arm.urdf", "--snap-angles", "1"]),
        ("no_workspace", vec!["generate"]),
        ("output_of_nothing", vec!["generate", "--output", "a.rs"]),
        ("latex_of_counts", vec!["inspect", "counts", "arm.urdf", "--latex"]),
    ] {
        let output = gelenk(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        insta::assert_snapshot!(name, shown(&output));
    }
}

#[test]
fn a_missing_description_ends_with_1_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let output = gelenk(folder.path(), &["generate", "none.toml"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("none.toml"));
    assert!(output.stdout.is_empty());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// A pipe without a writer would never end.
#[cfg(unix)]
#[test]
fn a_pipe_is_no_description() {
    let folder = tempfile::tempdir().unwrap();
    let made = Command::new("mkfifo").arg("arm.toml").current_dir(folder.path()).status().unwrap();
    assert!(made.success());
    let said = refused(folder.path(), &["generate", "arm.toml", "--output", "arm.rs"]);
    assert!(said.contains("it is a pipe or a device, not a file"), "{said}");
}

#[test]
fn robots_with_too_many_velocities_are_refused_and_held_joints_do_not_count() {
    let folder = tempfile::tempdir().unwrap();
    let joint = |k: u32| format!("[[joints]]\nname = \"joint_{k}\"\naxis = [0, 1, 0]\n");
    let body = "[[bodies]]\nlink = \"joint_400\"\nmass = 1\ncenter_of_mass = [0, 0, 1]\ninertia = 1\n";
    let chain: String = (0..=400).map(joint).chain([body.to_owned()]).collect();
    fs::write(folder.path().join("chain.toml"), chain).unwrap();
    let functions = ["generate", "chain.toml", "--functions", "input_matrix", "--output", "chain.rs"];
    let said = refused(folder.path(), &functions);
    assert!(said.contains("401 velocities, but at most 400") && said.contains("--hold"), "{said}");
    let held = gelenk(folder.path(), &[&functions[..], &["--hold", "joint_1*"]].concat());
    assert!(held.status.success(), "{}", shown(&held));
}

#[test]
fn diagnostics_as_json() {
    let folder = tempfile::tempdir().unwrap();
    let output = gelenk(folder.path(), &["generate", "none.toml", "--format", "json"]);
    assert_eq!(output.status.code(), Some(1));
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(value["diagnostics"][0]["severity"], "error");
}

#[test]
fn closed_forms_say_what_they_need() {
    let folder = tempfile::tempdir().unwrap();
    let output = gelenk(folder.path(), &["inspect", "--closed-form", "arm.urdf"]);
    insta::assert_snapshot!(shown(&output));
}

/// The mechanism before derivation, with the numbers of a real arm.
#[test]
fn mechanism_of_the_powercube() {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let output = gelenk(&models, &["inspect", "mechanism", "powercube.toml"]);
    insta::assert_snapshot!(shown(&output));
}

/// A joint with a quaternion is one line, and the joints behind it follow the positions that the module gives them.
#[test]
fn mechanism_of_the_satellite() {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let text = shown(&gelenk(&models, &["inspect", "mechanism", "satellite.toml"]));
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<String>>();
    let lines: Vec<Vec<String>> = text.lines().map(words).collect();
    for expected in [
        "base world floating y1 … y7",
        "wheel_x base revolute y8 90 90 0 0 0 0 0",
        "wheel_y base revolute y9 0 -90 0 0 0 0 0",
        "wheel_z base revolute y10 0 0 0 0 0 0 0",
        "boom base spherical y11 … y14 0 0 0.3",
        "boom 1.2 0 0 0.72 0.0005 0 0 0.0005 0 0.5815",
    ] {
        assert!(lines.contains(&words(expected)), "{expected}\n{text}");
    }
    assert!(!text.contains("base_rx") && !text.contains("free  "), "{text}");
    let json = gelenk(&models, &["inspect", "mechanism", "satellite.toml", "--format", "json"]);
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    let frames = json["frames"].as_array().unwrap();
    assert_eq!((frames.len(), json["moments"].as_array().map(Vec::len)), (5, Some(5)));
    assert_eq!([&frames[0]["follows"], &frames[1]["follows"]], ["y1 … y7", "y8"]);
    assert!(frames[4]["gamma"].is_null() && frames[4]["z"] == 0.3, "{json}");
}

/// Functions without counts are listed with the functions they call.
#[test]
fn counts_of_the_satellite_say_what_is_not_counted() {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let text = shown(&gelenk(&models, &["inspect", "counts", "satellite.toml", "--functions", "all"]));
    let (_, uncounted) = text.split_once("\nNot counted").unwrap_or_else(|| panic!("{text}"));
    for name in ["discretize", "step", "step_derivatives"] {
        assert!(uncounted.contains(&format!("\n  {name}: ")), "{text}");
    }
    let counted = shown(&gelenk(&models, &["inspect", "counts", "powercube.toml"]));
    assert!(!counted.contains("Not counted") && counted.contains("step_derivatives"), "{counted}");
}

/// A description alone is shown as the model that was read.
#[test]
fn inspect_shows_the_model() {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let output = gelenk(&models, &["inspect", "two_arm.toml"]);
    assert!(output.status.success(), "{output:?}");
    assert_eq!(output.stdout, gelenk(&models, &["inspect", "model", "two_arm.toml"]).stdout);
    let nothing = gelenk(&models, &["inspect", "counts"]);
    let said = String::from_utf8_lossy(&nothing.stderr);
    assert_eq!(nothing.status.code(), Some(2));
    assert!(said.contains("`inspect counts` needs a description"), "{said}");
}

/// The vendor's 1.57079632679 is noted with the operations that taking it for π/2 saves, and those are the
/// snapped ones.
#[test]
fn snapping_is_priced() {
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/urdf");
    let count = |options: &[&str]| {
        let arguments =
            [&["inspect", "counts", "ur5.urdf", "--functions", "inverse_dynamics"], options].concat();
        let output = gelenk(&urdf, &arguments);
        let table = String::from_utf8_lossy(&output.stdout).into_owned();
        let row = table.lines().nth(1).unwrap_or_default();
        let cells: Vec<&str> = row.split_whitespace().skip(1).take(2).collect();
        (cells.join("/"), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (described, notes) = count(&[]);
    let (snapped, none) = count(&["--snap-angles", "1e-4"]);
    assert_ne!(described, snapped);
    let price = format!("`inverse_dynamics` {snapped} instead of {described}");
    assert!(notes.contains(&price), "{price} is not in {notes}");
    assert!(!none.contains("instead of"), "{none}");
}

#[test]
fn a_closed_pipe_is_no_panic() {
    use std::io::Read;
    use std::process::Stdio;
    let mut child = Command::new(env!("CARGO_BIN_EXE_gelenk"))
        .args(["generate", "none.toml", "--format", "json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let mut stderr = String::new();
    child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(1));
    assert_eq!(stderr, "");
}
