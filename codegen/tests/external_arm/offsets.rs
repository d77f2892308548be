//! Offsets of efforts: one that repeats over logs becomes a constant of the law, one of a single log does not, and printed
//! numbers are those of the written description.

use super::{Arm, RIGHT, Recorded, number};
use gelenk_codegen::identify::InterpretedRobot;
use gelenk_identification::robot::Robot;
use serde_json::Value;
use std::fs;

/// A log with offsets.
fn record(arm: &Arm, log: &str, seed: u64, offsets: [f64; 3]) {
    arm.record_as("arm.toml", log, Recorded { offsets, seed, ..RIGHT });
}

fn friction(robot: &InterpretedRobot, joint: usize, v: f64) -> f64 {
    robot.friction(joint, v)
}

/// Half the sum of a law forwards and backwards.
fn constant(arm: &Arm, joint: usize) -> f64 {
    let robot = InterpretedRobot::new(&arm.model("found.toml")).unwrap();
    0.5 * (friction(&robot, joint, 0.5) + friction(&robot, joint, -0.5))
}

/// R² of the written description on a log, without any filter.
fn r_squared(arm: &Arm, log: &str) -> [f64; 3] {
    let robot = InterpretedRobot::new(&arm.model("found.toml")).unwrap();
    let text = fs::read_to_string(arm.at(log)).unwrap();
    let rows =
        text.lines().skip(1).map(|row| row.split(',').map(|x| x.parse().unwrap()).collect::<Vec<f64>>());
    let mut errors: [Vec<[f64; 2]>; 3] = Default::default();
    for row in rows {
        let [y, v, a] = super::motion(row[0]);
        let mut forces = [0.0; 3];
        robot.rigid_forces(&y, &v, &a, &mut forces);
        for joint in 0..3 {
            let measured = row[4 + joint];
            errors[joint].push([measured, measured - forces[joint] - friction(&robot, joint, v[joint])]);
        }
    }
    errors.map(|samples| {
        let mean = samples.iter().map(|[measured, _]| measured).sum::<f64>() / samples.len() as f64;
        let squares =
            |of: &dyn Fn(&[f64; 2]) -> f64| samples.iter().map(|sample| of(sample).powi(2)).sum::<f64>();
        1.0 - squares(&|[_, error]| *error) / squares(&|[measured, _]| measured - mean)
    })
}

fn offsets(found: &Value, joint: usize) -> Vec<f64> {
    found["joints"][joint]["offsets"].as_array().unwrap().iter().map(number).collect()
}

#[test]
fn an_offset_that_repeats_is_a_constant_of_the_law() {
    let arm = Arm::new();
    let truth = [3.0, 0.0, -1.5];
    for (log, seed) in [("a.csv", 7), ("b.csv", 8), ("c.csv", 9)] {
        record(&arm, log, seed, truth);
    }
    let found = arm.identify(&["a.csv", "b.csv", "--validate", "c.csv", "--output", "found.toml"]);
    for (joint, truth) in truth.into_iter().enumerate() {
        assert!((constant(&arm, joint) - truth).abs() < 0.25, "{joint}: {}", constant(&arm, joint));
        assert!(
            offsets(&found, joint).iter().all(|offset| offset.abs() < 0.25),
            "{:#}",
            found["joints"][joint]
        );
        assert!(number(&found["validation"][joint]["r_squared"]) > 0.995, "{}", found["validation"]);
    }
    let terms = found["joints"][0]["friction_terms"].as_array().unwrap();
    let term = terms.iter().find(|term| term["term"] == "1").unwrap();
    let [low, high] = [0, 1].map(|end| number(&term["interval"][end]));
    assert!(low < 3.0 && 3.0 < high && high - low < 4.0, "{term}");
}

#[test]
fn offsets_of_single_logs_are_not_written_and_count_in_what_is_printed() {
    let arm = Arm::new();
    record(&arm, "a.csv", 7, [4.0, 0.0, 2.0]);
    record(&arm, "b.csv", 8, [-3.0, 0.0, 5.0]);
    record(&arm, "c.csv", 9, [4.0, 0.0, 2.0]);
    for (logs, warnings) in [(&["a.csv"][..], 2), (&["a.csv", "b.csv"], 2)] {
        let arguments = [logs, &["--validate", "c.csv", "--output", "found.toml"]].concat();
        let found = arm.identify(&arguments);
        let written = r_squared(&arm, "c.csv");
        for (joint, written) in written.into_iter().enumerate() {
            assert!(constant(&arm, joint).abs() < 0.25, "{logs:?} {joint}: {}", constant(&arm, joint));
            let printed = &found["validation"][joint];
            assert!((number(&printed["r_squared"]) - written).abs() < 0.02, "{printed} {written}");
            assert!(number(&printed["r_squared_with_offset"]) > 0.995, "{printed}");
            let offset = number(&printed["offset"]);
            assert!((offset - [4.0, 0.0, 2.0][joint]).abs() < 0.3, "{printed}");
            // A fitted log with the same offset is not predicted better.
            let fitted = number(&found["joints"][joint]["r_squared_held_out"]);
            assert!(logs.len() > 1 || (fitted - written).abs() < 0.02, "{fitted} {written}");
        }
        assert!(written[0] < 0.9 && written[1] > 0.995, "{written:?}");
        let codes = found["findings"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|found| found["code"] == "offset-not-written");
        assert_eq!(codes.count(), warnings, "{logs:?}: {:#}", found["findings"]);
        for (joint, truth) in [4.0, 0.0, 2.0].into_iter().enumerate() {
            assert!(
                (offsets(&found, joint)[0] - truth).abs() < 0.3,
                "{logs:?}: {:#}",
                found["joints"][joint]
            );
        }
    }
}
