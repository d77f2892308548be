//! Logs of `tests/cases/`, and published ones.

use std::fs;
use std::path::Path;

use super::super::common::{cases, shared};
use super::{assert_said, said};

fn copied(from: &Path, files: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for file in files {
        fs::copy(from.join(file), folder.path().join(file)).unwrap();
    }
    folder
}

#[test]
fn cases_are_named() {
    let files = ["robot.toml", "arm7.urdf", "one_way.csv", "way_back.csv", "arm4.urdf", "dropouts.csv"];
    let folder = copied(&cases(), &[&files[..], &["joint.toml", "joint_log.csv"]].concat());
    let output = ["--output", "found.toml"];
    let commands = [
        ("one_way", vec!["robot.toml", "one_way.csv"]),
        ("both", vec!["robot.toml", "one_way.csv", "way_back.csv"]),
        ("shared_dropouts", vec!["arm4.urdf", "dropouts.csv"]),
        ("stribeck", vec!["joint.toml", "joint_log.csv", "--friction", "stribeck"]),
    ];
    let commands = commands.map(|(name, arguments)| (name, [&arguments[..], &output].concat()));
    assert_said("cases", &said(folder.path(), &commands));
}

/// A drive that bears a joint's name: the log is that of `shaft_named_like_joint_log.py` with other noise.
#[test]
fn a_shaft_named_like_a_joint_is_told_from_it() {
    let folder = copied(&cases(), &["shaft_named_like_joint.toml"]);
    let mut text = String::from("t,pitch_pos,roll_pos,pitch_tau,roll_tau\n");
    for i in 0..3000 {
        let t = 0.005 * f64::from(i);
        let wave = |terms: [[f64; 3]; 2], k: i32| -> f64 {
            let term = |[a, w, p]: [f64; 3]| {
                let x = w * t + p;
                a * w.powi(k) * if k == 1 { x.cos() } else { x.sin() * f64::from(1 - k) }
            };
            terms.into_iter().map(term).sum()
        };
        let [pitch, roll] = [[[0.8, 2.0, 0.0], [0.3, 5.1, 0.0]], [[0.6, 2.7, 1.0], [0.3, 4.3, 0.0]]];
        let force = |of: [[f64; 3]; 2], inertia: f64| (inertia + 0.05) * wave(of, 2) + 0.5 * wave(of, 1);
        let efforts = [force(pitch, 0.03), force(roll, 0.01)];
        text += &format!("{t},{},{},{},{}\n", wave(pitch, 0), wave(roll, 0), efforts[0], efforts[1]);
    }
    fs::write(folder.path().join("log.csv"), text).unwrap();
    let arguments = vec!["shaft_named_like_joint.toml", "log.csv", "--effort", "joint", "--accept-poor"];
    assert_said("shaft", &said(folder.path(), &[("shaft", arguments)]));
}

/// The first halves of the measured runs, with the model of the repository.
#[test]
fn the_runs_of_a_schunk_are_named() {
    let Some(data) = shared("data/schunk_lwa4p") else { return };
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let folder = copied(&models, &["schunk_lwa4p.toml"]);
    let runs = fs::read_to_string(data.join("runs.csv")).unwrap();
    let is_kept = |line: &&str| ["run", "1", "21", "41", "61"].contains(&line.split(',').next().unwrap());
    let half: Vec<&str> = runs.lines().filter(is_kept).collect();
    fs::write(folder.path().join("runs.csv"), half.join("\n")).unwrap();
    let arguments = vec!["schunk_lwa4p.toml", "runs.csv", "--gravity-compensated", "--effort", "joint"];
    assert_said("schunk", &said(folder.path(), &[("halves", arguments)]));
}
