//! Logs: the measured Schunk runs, and a log of a million rows.

use crate::support::data::shared;
use crate::support::named_robot::NamedRobot;
use gelenk_identification::log::{ColumnOptions, Recording, runs, runs_of};
use gelenk_identification::run::Effort;
use std::fmt::Write;

#[test]
fn a_million_rows_are_ordinary() {
    let mut text = String::from("t,q1,dq1,u1\n");
    for i in 0..1_000_000 {
        let t = 1e-3 * f64::from(i);
        writeln!(text, "{t:.3},{:.6},{:.6},{:.4}", (0.3 * t).sin(), 0.3 * (0.3 * t).cos(), t.cos()).unwrap();
    }
    let robot = NamedRobot { names: vec!["joint_1".into()], ..NamedRobot::default() };
    let recording = runs_of(text.as_bytes(), "million", &robot, &ColumnOptions::default()).unwrap();
    assert_eq!(recording.runs[0].times.len(), 1_000_000);
    assert!(recording.findings.is_empty(), "{:?}", recording.findings);
}

fn sentences(recording: &Recording) -> Vec<String> {
    recording.findings.iter().map(ToString::to_string).collect()
}

/// The Schunk log as runs: its `u` are at the joints, which has to be told where the description has gears.
#[test]
fn the_schunk_runs_are_runs_of_a_robot() {
    let Some(path) = shared("data/schunk_lwa4p/runs.csv") else {
        return;
    };
    let names: Vec<String> = (1..=6).map(|i| format!("joint_{i}")).collect();
    let robot = NamedRobot { names, gear: 160.0, ..NamedRobot::default() };
    let told = ColumnOptions { effort: Some(Effort::Joint), ..ColumnOptions::default() };
    let recording = runs(std::slice::from_ref(&path), &robot, &told).unwrap();
    assert_eq!((recording.runs.len(), recording.effort), (28, Effort::Joint));
    assert_eq!(recording.unused, [""; 0]);
    let samples: usize = recording.runs.iter().map(|run| run.times.len()).sum();
    assert_eq!(samples, 19_598 - 28, "the torques of each run's last row are NaN");
    let (first, second) = (&recording.runs[0], &recording.runs[5]);
    assert_eq!((first.name.as_str(), second.name.as_str()), ("runs.csv, run 1", "runs.csv, run 21"));
    assert_eq!((first.rows[0], first.times[1], first.positions[2][0]), (2, 0.004, -1.368));
    let found = sentences(&recording);
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found[0].contains("rows 938 to 19599: column `u1`, column `u2`"), "{found:?}");
    assert!(found.iter().any(|f| f.ends_with("28 incomplete rows are left out")), "{found:?}");
    let guessed = runs(&[path], &robot, &ColumnOptions::default()).unwrap();
    assert_eq!(guessed.effort, Effort::Input);
}

/// The UR10's JointState, by the names of its URDF.
#[test]
fn the_ur10_log_is_read_by_the_names_of_its_joints() {
    let Some(path) = shared("data/ur10/exciting.csv") else {
        return;
    };
    let names = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"];
    let names = names.map(|name| format!("{name}_joint")).to_vec();
    let robot = NamedRobot { names, speed: 3.2, effort: 330.0, ..NamedRobot::default() };
    let recording = runs(&[path], &robot, &ColumnOptions::default()).unwrap();
    assert_eq!((recording.runs.len(), recording.effort), (1, Effort::Joint));
    let run = &recording.runs[0];
    assert_eq!((run.times.len(), run.rows[3440]), (3441, 3442));
    assert_eq!((run.times[1], run.positions[0][0], run.efforts[5][0]), (0.008, 0.6197783, -0.7875644));
    assert!(run.velocities.iter().all(Option::is_some));
    assert_eq!(sentences(&recording), [""; 0]);
    assert_eq!(recording.columns.len(), 4, "{:?}", recording.columns);
}
