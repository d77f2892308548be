//! Pages and identification of robots of which something else moves a joint.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use gelenk_codegen::identify::InterpretedRobot;
use gelenk_codegen::read::{self, ReadOptions};
use gelenk_identification::robot::Robot;
use serde_json::Value;

/// True parameters of the arm of `models/`: it carries a load, and its shoulder is heavier.
const TRUTH: &str = r#"
[[bodies]]
link = "shoulder"
mass = 9
center_of_mass = [0.03, 0, 0.2]
inertia = [0.18, 0.18, 0.03]

[[bodies]]
link = "elbow"
mass = 5.5
center_of_mass = [0.02, 0.02, 0.19]
inertia = [0.1, 0.1, 0.012]
"#;

fn rail_arm() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/rail_arm.toml").canonicalize().unwrap()
}

fn gelenk(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gelenk")).current_dir(folder).args(arguments).output().unwrap()
}

#[test]
fn the_page_of_an_arm_on_a_rail_has_a_slider_for_the_rail_and_checks_its_functions() {
    let folder = tempfile::tempdir().unwrap();
    let description = rail_arm().display().to_string();
    let output = gelenk(folder.path(), &["report", &description, "--output", "page", "--format", "json"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{said}{}", String::from_utf8_lossy(&output.stdout));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let checks = found["self_check"].as_array().unwrap();
    assert_eq!(checks.len(), 25, "every function is checked: {checks:?}");
    assert!(checks.iter().all(|check| check["verdict"] == "holds"), "{checks:?}");
    let page = fs::read_to_string(folder.path().join("page/index.html")).unwrap();
    for words in ["y1 shoulder", "y2 elbow", "d1 rail", "d₁, slides as given", "is prescribed: its position"]
    {
        assert!(page.contains(words), "{words}");
    }
    let table = fs::read_to_string(folder.path().join("page/coordinates.csv")).unwrap();
    assert!(table.contains("rail") && table.contains("prismatic, motion given"), "{table}");
    let table = fs::read_to_string(folder.path().join("page/geometry.csv")).unwrap();
    assert!(table.contains("rail,base,$d_{1}$,") && table.contains("shoulder,rail,$y_{1}$,"), "{table}");
}

/// The arm with all its joints as coordinates.
fn freed(path: &Path) -> InterpretedRobot {
    let options = ReadOptions { free_driven: true, ..ReadOptions::default() };
    let loaded = read::read(path, &options).unwrap_or_else(|e| panic!("{e}"));
    InterpretedRobot::new(&loaded.model).unwrap_or_else(|e| panic!("{e}"))
}

/// Position, velocity and acceleration of each joint.
fn motion(t: f64, shift: f64) -> [Vec<f64>; 3] {
    let sines = |joint: usize, order: usize| -> f64 {
        let amplitude = [0.3, 0.9, 0.8][joint];
        let sine = |k: usize| {
            let w = TAU * (0.13 + 0.11 * ((joint * 2 + k * 3) % 5) as f64);
            let x = w * t + 1.1 * joint as f64 + 1.9 * k as f64 + shift;
            amplitude / 2.0 * [x.sin(), w * x.cos(), -w * w * x.sin()][order]
        };
        (0..3).map(sine).sum()
    };
    [0, 1, 2].map(|order| (0..3).map(|joint| sines(joint, order)).collect())
}

/// A number between −1 and 1 for each row and column.
fn noise(row: usize, column: usize) -> f64 {
    let mixed = ((row * 31 + column) as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (mixed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// A log with the motion of all joints, and the efforts of shoulder and elbow: at the joints, or of the motors.
fn log(truth: &InterpretedRobot, at_joints: bool) -> String {
    let mut text = String::from("t,rail_position,shoulder_position,elbow_position");
    text += if at_joints { ",shoulder_effort,elbow_effort\n" } else { ",u_shoulder,u_elbow\n" };
    for row in 0..8000 {
        let t = 2.5e-3 * row as f64;
        let [y, v, a] = motion(t, 0.0);
        let mut forces = vec![0.0; 3];
        truth.rigid_forces(&y, &v, &a, &mut forces);
        write!(text, "{t:.4}").unwrap();
        y.iter().enumerate().for_each(|(j, y)| write!(text, ",{:.6}", y + 5e-5 * noise(row, j)).unwrap());
        for (j, [viscous, coulomb, gear]) in [(1, [3.0, 4.0, 80.0]), (2, [0.6, 1.5, 60.0])] {
            let force = forces[j] + viscous * v[j] + coulomb * (60.0 * v[j]).tanh() + 0.2 * noise(row, 7 + j);
            write!(text, ",{:.6}", if at_joints { force } else { force / gear }).unwrap();
        }
        text.push('\n');
    }
    text
}

/// Errors of the forces at shoulder and elbow along another motion, relative to their size.
fn error(found: &InterpretedRobot, truth: &InterpretedRobot) -> f64 {
    let (mut error, mut size) = (0.0, 0.0);
    for i in 0..100 {
        let [y, v, a] = motion(0.31 * f64::from(i), 2.0);
        let forces = [found, truth].map(|robot| {
            let mut forces = vec![0.0; 3];
            robot.rigid_forces(&y, &v, &a, &mut forces);
            forces
        });
        for j in 1..3 {
            error += (forces[0][j] - forces[1][j]).powi(2);
            size += forces[1][j].powi(2);
        }
    }
    f64::sqrt(error / size)
}

#[test]
fn an_arm_on_a_rail_is_identified_from_a_log_with_the_motion_of_the_rail() {
    let folder = tempfile::tempdir().unwrap();
    let description = rail_arm().display().to_string();
    let truth = folder.path().join("truth.toml");
    fs::write(&truth, format!("name = \"truth\"\nextends = {description:?}\n{TRUTH}")).unwrap();
    let (described, truth) = (freed(&rail_arm()), freed(&truth));
    let before = error(&described, &truth);
    for at_joints in [true, false] {
        fs::write(folder.path().join("log.csv"), log(&truth, at_joints)).unwrap();
        let arguments = [
            "identify",
            &description,
            "log.csv",
            "--output",
            "found.toml",
            "--format",
            "json",
            "--report",
            "page",
        ];
        let output = gelenk(folder.path(), &arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let after = error(&freed(&folder.path().join("found.toml")), &truth);
        println!("{before:.4} as described, {after:.4} as estimated");
        assert!(before > 0.2 && after < 0.01, "{before} {after}");
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        let joints = found["joints"].as_array().unwrap();
        assert_eq!(
            (joints[0]["name"].as_str(), joints[0]["measured"].as_bool()),
            (Some("rail"), Some(false))
        );
        assert!(
            joints[1..].iter().all(|joint| joint["r_squared_held_out"].as_f64().unwrap() > 0.99),
            "{joints:?}"
        );
        let written = fs::read_to_string(folder.path().join("found.toml")).unwrap();
        assert!(
            written.contains("name = \"elbow\"") && !written.contains("name = \"rail\"\nfriction"),
            "{written}"
        );
        // What is written is still a robot on a driven rail.
        let output = gelenk(folder.path(), &["inspect", "model", "found.toml"]);
        assert!(
            String::from_utf8_lossy(&output.stdout).contains("driven"),
            "{}",
            String::from_utf8_lossy(&output.stdout)
        );
    }
}

#[test]
fn a_log_without_the_motion_of_the_rail_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let text = log(&freed(&rail_arm()), true).replacen("rail_position", "other", 1);
    fs::write(folder.path().join("log.csv"), text).unwrap();
    let description = rail_arm().display().to_string();
    for (more, words) in [
        (&[][..], "the log has no column for the position of `rail`"),
        (
            &["--reduce", "--output", "log.moments"][..],
            "logs cannot be reduced to a file of moments if the motion of a joint is prescribed",
        ),
    ] {
        let output = gelenk(folder.path(), &[&["identify", &description, "log.csv"], more].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && said.contains(words), "{said}");
    }
}
