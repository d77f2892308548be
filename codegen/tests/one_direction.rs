//! Friction of a robot whose log moves each joint in one direction: the data do not tell Coulomb friction from an offset.
//!
//! The logs are those of a simulated robot that is the description, see `README.md` next to them.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;
use std::process::Command;

use gelenk_codegen::identify::InterpretedRobot;
use gelenk_codegen::read::{self, ReadOptions};
use gelenk_identification::robot::Robot;
use serde_json::Value;

use super::common::cases;

/// Viscous and Coulomb friction of the simulated robot.
const FRICTION: [[f64; 2]; 7] =
    [[4.0, 3.0], [4.0, 3.5], [4.0, 3.0], [4.0, 3.0], [1.2, 1.0], [1.2, 1.0], [1.2, 1.0]];

/// Speeds of the logs at which laws are compared [rad/s].
const SPEEDS: [f64; 4] = [-0.6, -0.3, 0.3, 0.6];

/// A folder with the description, its friction times a factor, and the logs.
fn folder(cases: &Path, factor: f64) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in ["arm7.urdf", "one_way.csv", "way_back.csv"] {
        fs::copy(cases.join(name), folder.path().join(name)).unwrap();
    }
    let mut text = fs::read_to_string(cases.join("robot.toml")).unwrap();
    for [viscous, coulomb] in [[4.0, 3.0], [4.0, 3.5], [1.2, 1.0]] {
        let described =
            |factor: f64| format!("viscous = {:?}, coulomb = {:?}", factor * viscous, factor * coulomb);
        assert!(text.contains(&described(1.0)));
        text = text.replace(&described(1.0), &described(factor));
    }
    fs::write(folder.path().join("robot.toml"), text).unwrap();
    fs::write(folder.path().join("both.csv"), both(folder.path())).unwrap();
    folder
}

/// The way back behind the way there, in one file.
fn both(folder: &Path) -> String {
    let read = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
    let there = read("one_way.csv");
    let time = |line: &str| line.split(',').next().unwrap().parse::<f64>().unwrap();
    let last = time(there.lines().last().unwrap());
    let back = read("way_back.csv");
    let later = |line: &str| {
        let (_, rest) = line.split_once(',').unwrap();
        format!("{:.2},{rest}\n", time(line) + last + 0.01)
    };
    let later: String = back.lines().skip(1).map(later).collect();
    format!("{}\n{later}", there.trim_end())
}

/// Result of the command, and the robot that it writes.
fn identify(folder: &Path, logs: &[&str]) -> (Value, InterpretedRobot) {
    let mut gelenk = Command::new(env!("CARGO_BIN_EXE_gelenk"));
    gelenk.current_dir(folder).args(["identify", "robot.toml"]).args(logs);
    let output = gelenk.args(["--format", "json", "--output", "found.toml"]).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stdout));
    let model = read::read(&folder.join("found.toml"), &ReadOptions::default()).unwrap().model;
    (serde_json::from_slice(&output.stdout).unwrap(), InterpretedRobot::new(&model).unwrap())
}

/// Largest relative error of a law.
fn error(robot: &InterpretedRobot, joint: usize) -> f64 {
    let [viscous, coulomb] = FRICTION[joint];
    let relative = |v: f64| robot.friction(joint, v) / (viscous * v + coulomb * v.signum()) - 1.0;
    SPEEDS.map(|v| relative(v).abs()).into_iter().fold(0.0, f64::max)
}

/// Intervals of a law that has a viscous and a Coulomb term, with the true values.
fn intervals(found: &Value, joint: usize) -> Vec<([f64; 2], f64)> {
    let terms = found["joints"][joint]["friction_terms"].as_array().unwrap().iter();
    let chosen: Vec<&Value> = terms.filter(|term| term["coefficient"].is_number()).collect();
    let is_viscous = |term: &Value| term["term"] == "v";
    if chosen.len() != 2 || !is_viscous(chosen[0]) {
        return Vec::new();
    }
    let ends = |term: &Value| [0, 1].map(|end| term["interval"][end].as_f64().unwrap());
    chosen.into_iter().map(ends).zip(FRICTION[joint]).collect()
}

fn holds(([low, high], truth): &([f64; 2], f64)) -> bool {
    (low..=high).contains(&truth)
}

#[test]
fn friction_of_a_motion_in_one_direction_is_no_offset() {
    let cases = cases();
    let folder = folder(&cases, 1.0);
    let (found, robot) = identify(folder.path(), &["one_way.csv"]);
    for joint in 0..FRICTION.len() {
        assert!(error(&robot, joint) < 0.05, "joint {joint}: {}", found["joints"][joint]);
    }
    let intervals: Vec<_> = (0..FRICTION.len()).flat_map(|joint| intervals(&found, joint)).collect();
    assert!(intervals.len() >= 8 && intervals.iter().all(holds), "{intervals:?}");
}

/// A description with half the friction: the interval of Coulomb friction tells how far an offset may be part of it.
#[test]
fn a_worn_robot_is_known_after_a_motion_in_one_direction_as_far_as_offsets_are() {
    let cases = cases();
    let folder = folder(&cases, 0.5);
    let (found, robot) = identify(folder.path(), &["one_way.csv"]);
    for joint in 0..FRICTION.len() {
        assert!(error(&robot, joint) < 0.1, "joint {joint}: {}", found["joints"][joint]);
    }
    let intervals: Vec<_> = (0..FRICTION.len()).flat_map(|joint| intervals(&found, joint)).collect();
    assert!(intervals.len() >= 8 && intervals.iter().all(holds), "{intervals:?}");
}

#[test]
fn there_and_back_tells_friction_from_offsets() {
    let cases = cases();
    for factor in [1.0, 0.5] {
        let folder = folder(&cases, factor);
        for logs in [&["one_way.csv", "way_back.csv"][..], &["both.csv"]] {
            let (found, robot) = identify(folder.path(), logs);
            for joint in 0..FRICTION.len() {
                let error = error(&robot, joint);
                assert!(error < 0.05, "{logs:?} joint {joint}: {error}\n{}", found["joints"][joint]);
            }
            let warnings = found["warnings"].to_string();
            assert!(!warnings.contains("gravity"), "{warnings}");
        }
    }
}
