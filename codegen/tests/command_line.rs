//! The program `gelenk` from outside: help, messages, exit codes.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use std::path::Path;
use std::process::{Command, Output};

fn gelenk(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gelenk"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
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
    ] {
        insta::assert_snapshot!(name, shown(&gelenk(folder.path(), &arguments)));
    }
}

#[test]
fn wrong_command_lines_end_with_2() {
    let folder = tempfile::tempdir().unwrap();
    for (name, arguments) in [
        ("unknown_command", vec!["generat"]),
        (
            "unknown_option",
            vec!["generate", "arm.urdf", "--snap-angle", "1"],
        ),
        (
            "large_angle",
            vec!["generate", "arm.urdf", "--snap-angles", "1"],
        ),
        ("no_workspace", vec!["generate"]),
        ("output_of_nothing", vec!["generate", "--output", "a.rs"]),
        (
            "latex_of_counts",
            vec!["inspect", "counts", "arm.urdf", "--latex"],
        ),
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
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn diagnostics_as_json() {
    let folder = tempfile::tempdir().unwrap();
    let output = gelenk(
        folder.path(),
        &["generate", "none.toml", "--format", "json"],
    );
    assert_eq!(output.status.code(), Some(1));
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(value["diagnostics"][0]["severity"], "error");
}

#[test]
fn a_new_crate_is_made_once_and_only_under_a_good_name() {
    let folder = tempfile::tempdir().unwrap();
    let made = gelenk(folder.path(), &["new", "my-arm", "--format", "json"]);
    assert_eq!(made.status.code(), Some(0), "{}", shown(&made));
    let said: serde_json::Value = serde_json::from_slice(&made.stdout).unwrap();
    assert_eq!(said["package"], "my-arm");
    for file in said["files"].as_array().unwrap() {
        assert!(
            folder
                .path()
                .join("my-arm")
                .join(file.as_str().unwrap())
                .is_file(),
            "{file}"
        );
    }
    for (arguments, code, message) in [
        (vec!["new", "my-arm"], 1, "my-arm exists already"),
        (vec!["new", "2nd"], 2, "must begin with a letter"),
        (vec!["new", "a b"], 2, "letters from a to z"),
        (vec!["new", "fn"], 2, "a word of Rust"),
        (vec!["new", ".."], 2, "does not end in a name"),
        (
            vec!["new", "other", "--git", "git@host:a/b"],
            2,
            "ssh://git@host/a/b",
        ),
        (
            vec!["new", "other", "--version", "newest"],
            2,
            "is no version",
        ),
        (
            vec!["new", "my-arm/robot.toml/arm"],
            1,
            "choose a folder in which you may write",
        ),
        (
            vec!["new", "other", "--checkout", "."],
            1,
            "no checkout of gelenk",
        ),
        (
            vec!["new", "other", "--git", "x", "--version", "1"],
            2,
            "cannot be used with",
        ),
    ] {
        let refused = gelenk(folder.path(), &arguments);
        assert_eq!(refused.status.code(), Some(code), "{}", shown(&refused));
        let stderr = String::from_utf8_lossy(&refused.stderr);
        assert!(stderr.contains(message), "{stderr}");
    }
    // Nothing is left behind by what was refused.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    let made = gelenk(
        folder.path(),
        &[
            "new",
            "elsewhere",
            "--git",
            "https://example.org/gelenk.git",
        ],
    );
    assert_eq!(made.status.code(), Some(0));
    let manifest = std::fs::read_to_string(folder.path().join("elsewhere/Cargo.toml")).unwrap();
    assert_eq!(
        manifest
            .matches("git = \"https://example.org/gelenk.git\"")
            .count(),
        2
    );
}

/// A pendulum: small enough that its page is made in no time.
const PENDULUM: &str = "[[joints]]\nname = \"swing\"\naxis = [0, 1, 0]\ndrive = \"ideal\"\nfriction = \"0.1*v + 0.2*sign(v)\"\n\
    [[bodies]]\nlink = \"swing\"\nmass = 1\ncenter_of_mass = [0, 0, -0.5]\n";

#[test]
fn a_page_and_its_numbers_are_written() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("pendulum.toml"), PENDULUM).unwrap();
    let output = gelenk(
        folder.path(),
        &["report", "pendulum.toml", "--format", "json"],
    );
    assert_eq!(output.status.code(), Some(0), "{}", shown(&output));
    let said: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(said["files"][0], "report/pendulum/index.html");
    for check in said["self_check"].as_array().unwrap() {
        assert_eq!(check["verdict"], "holds", "{check}");
    }
    let read = |name: &str| {
        std::fs::read_to_string(folder.path().join("report/pendulum").join(name)).unwrap()
    };
    let data: serde_json::Value = serde_json::from_str(&read("report.json")).unwrap();
    assert_eq!(data["title"], "The robot pendulum");
    assert!(read("index.html").contains("gelenk report pendulum.toml"));
    assert!(
        read("bodies.csv").starts_with("body,link,mass [kg],c_x [m]"),
        "{}",
        read("bodies.csv")
    );
    // Choices that change the equations are those of `generate`, and stand at the foot of the page.
    let smooth = [
        "report",
        "pendulum.toml",
        "--smooth-sign",
        "80",
        "--output",
        "smooth",
    ];
    assert_eq!(gelenk(folder.path(), &smooth).status.code(), Some(0));
    let smooth = std::fs::read_to_string(folder.path().join("smooth/report.json")).unwrap();
    assert!(smooth.contains(r"\\tanh\\left(80"), "{smooth}");
    assert!(smooth.contains("gelenk report pendulum.toml --smooth-sign 80.0"));
    // The same description, the same bytes.
    let first = read("index.html");
    gelenk(
        folder.path(),
        &["report", "pendulum.toml", "--output", "again"],
    );
    assert_eq!(
        first,
        std::fs::read_to_string(folder.path().join("again/index.html")).unwrap()
    );
}

#[test]
fn a_page_that_cannot_be_written_ends_with_1() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("pendulum.toml"), PENDULUM).unwrap();
    std::fs::write(folder.path().join("taken"), "").unwrap();
    let output = gelenk(
        folder.path(),
        &["report", "pendulum.toml", "--output", "taken"],
    );
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        said.contains("cannot write taken") && said.contains("--output FOLDER"),
        "{said}"
    );
    let output = gelenk(folder.path(), &["report", "none.toml"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(!folder.path().join("report").exists());
}

#[cfg(not(feature = "symbolica"))]
#[test]
fn closed_forms_say_what_they_need() {
    let folder = tempfile::tempdir().unwrap();
    let output = gelenk(folder.path(), &["inspect", "--closed-form", "arm.urdf"]);
    insta::assert_snapshot!(shown(&output));
}

/// What stands in front of a derivation, with the numbers of a real arm.
#[test]
fn mechanism_of_the_powercube() {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let output = gelenk(&models, &["inspect", "mechanism", "powercube.toml"]);
    insta::assert_snapshot!(shown(&output));
}

/// The vendor's 1.57079632679 is noted with the operations that taking it for π/2 saves, and those are the snapped ones.
#[test]
fn snapping_is_priced() {
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/urdf");
    let count = |options: &[&str]| {
        let arguments = [
            &[
                "inspect",
                "counts",
                "ur5.urdf",
                "--functions",
                "inverse_dynamics",
            ],
            options,
        ]
        .concat();
        let output = gelenk(&urdf, &arguments);
        let table = String::from_utf8_lossy(&output.stdout).into_owned();
        let row = table.lines().nth(1).unwrap_or_default();
        let cells: Vec<&str> = row.split_whitespace().skip(1).take(2).collect();
        (
            cells.join("/"),
            String::from_utf8_lossy(&output.stderr).into_owned(),
        )
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
    child
        .stderr
        .take()
        .unwrap()
        .read_to_string(&mut stderr)
        .unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(1));
    assert_eq!(stderr, "");
}
