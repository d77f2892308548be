//! Wrenches of a description, and joints that a replay does not learn.

use std::fmt::Write as _;
use std::fs;
use std::process::{Command, Output};

/// Two axes across each other, through one point.
const WRIST: &str = r#"
name = "wrist"
gravity = [0, 0, 0]

[[joints]]
name = "pitch"
axis = [0, 1, 0]
limits = { velocity = 4, effort = 9 }
friction = { viscous = 0.5 }
drive = "ideal"

[[joints]]
name = "roll"
axis = [1, 0, 0]
limits = { velocity = 4, effort = 9 }
friction = { viscous = 0.4 }
drive = "ideal"

[[bodies]]
link = "pitch"
mass = 1
inertia = 0.05

[[bodies]]
link = "roll"
mass = 1
inertia = [0.05, 0.04, 0.04]

[[frames]]
name = "tool"
link = "roll"
"#;

const WRENCH: &str = "[[wrenches]]\nname = \"contact\"\nframe = \"tool\"\n";

/// `gelenk identify` on a description, and a log of the wrist.
fn identify(description: &str, arguments: &[&str]) -> Output {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("wrist.toml"), description).unwrap();
    let mut log = String::from("time,pitch_pos,roll_pos,pitch_tau,roll_tau\n");
    for k in 0..2000 {
        let t = 0.01 * f64::from(k);
        let [y, v, a] = [(2.1 * t).sin(), 2.1 * (2.1 * t).cos(), -4.41 * (2.1 * t).sin()];
        let [z, w, b] = [(1.7 * t).sin(), 1.7 * (1.7 * t).cos(), -2.89 * (1.7 * t).sin()];
        writeln!(log, "{t},{y},{z},{},{}", 0.1 * a + 0.4 * v, 0.05 * b + 0.3 * w).unwrap();
    }
    fs::write(folder.path().join("log.csv"), log).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_gelenk"));
    command
        .args(["identify", "wrist.toml", "log.csv"])
        .args(arguments)
        .current_dir(folder.path())
        .output()
        .unwrap()
}

#[test]
fn wrenches_without_a_log_are_named() {
    let output = identify(&[WRIST, WRENCH].concat(), &["--effort", "joint", "--accept-poor"]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("note[wrenches-zero]: the wrenches `contact` are assumed to be zero"), "{said}");
}

#[test]
fn joints_that_a_replay_does_not_learn_are_named() {
    let output = identify(WRIST, &["--online", "--effort", "joint"]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("roll") && !said.contains("not learned"), "{said}");
    let of_pitch = WRIST.replace("viscous = 0.4 }\ndrive = \"ideal\"", "viscous = 0.4 }\ndrive = \"none\"");
    let output = identify(&of_pitch, &["--online", "--effort", "joint"]);
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(
        said.contains("not learned, because the input or some efforts are missing: `roll`"),
        "{said}{output:?}"
    );
}

/// One motor for both joints: the loop refuses it too.
#[test]
fn drives_that_load_joints_together_are_refused_online() {
    let motor = "[[drives]]\nname = \"both\"\non = { pitch = 1, roll = 1 }\ngear_ratio = 1\n";
    let output = identify(
        &[&WRIST.replace("drive = \"ideal\"\n", ""), motor].concat(),
        &["--online", "--effort", "joint"],
    );
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        said.contains("error[not-replayed]")
            && said.contains("if the drives can exert a force on each joint alone"),
        "{said}"
    );
}
