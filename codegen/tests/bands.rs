//! Logs whose efforts have another band than the positions, and laws that have to pass a filter.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::{PI, SQRT_2};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use gelenk_codegen::identify::InterpretedRobot;
use gelenk_codegen::read::{self, ReadOptions};
use gelenk_identification::robot::Robot;
use serde_json::Value;

use super::common::cases;

fn read(file: &Path) -> InterpretedRobot {
    InterpretedRobot::new(&read::read(file, &ReadOptions::default()).unwrap().model).unwrap()
}

/// Result of the command.
fn identify(folder: &Path, arguments: &[&str]) -> Value {
    let mut gelenk = Command::new(env!("CARGO_BIN_EXE_gelenk"));
    gelenk.current_dir(folder).arg("identify").args(arguments);
    let output = gelenk.args(["--format", "json", "--output", "found.toml"]).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stdout));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The truth made the log. The other values are those of SciPy's `curve_fit`, with positions through a filter of 8 Hz and
/// torques through none.
#[test]
fn a_stribeck_law_passes_the_filter_of_the_torques() {
    const TRUTH: [f64; 5] = [4.0, 3.0, 40.0, 1.5, 12.5];
    const BY_SCIPY: [f64; 5] = [4.004, 2.998, 40.3, 1.473, 12.31];
    let cases = cases();
    let folder = tempfile::tempdir().unwrap();
    for name in ["joint.toml", "joint_log.csv"] {
        fs::copy(cases.join(name), folder.path().join(name)).unwrap();
    }
    let found = identify(folder.path(), &["joint.toml", "joint_log.csv", "--friction", "stribeck"]);
    let terms = found["joints"][0]["friction_terms"].as_array().unwrap();
    for ((term, truth), other) in terms.iter().zip(TRUTH).zip(BY_SCIPY) {
        let [low, high] = [0, 1].map(|end| term["interval"][end].as_f64().unwrap());
        let value = term["coefficient"].as_f64().unwrap();
        assert!((low..=high).contains(&truth), "{term}");
        assert!((value / other - 1.0).abs() < 0.05, "{term}, {other}");
    }
    assert_eq!(terms.len(), TRUTH.len());
}

/// Filters that efforts pass before they are recorded, by recursion.
type Filter = fn(&[f64]) -> Vec<f64>;

const STEP: f64 = 0.005;

/// Viscous and Coulomb friction of the simulated arm.
const FRICTION: [[f64; 2]; 3] = [[9.0, 6.0], [12.0, 8.5], [4.0, 3.1]];

/// One pass of first order at a frequency.
fn first_order(signal: &[f64], frequency: f64) -> Vec<f64> {
    let share = 1.0 - (-2.0 * PI * frequency * STEP).exp();
    let mut state = signal[0];
    let next = |x: &f64| {
        state += share * (x - state);
        state
    };
    signal.iter().map(next).collect()
}

/// One pass of second order by Butterworth's polynomial, with the bilinear transform.
fn butterworth(signal: &[f64], frequency: f64) -> Vec<f64> {
    let k = (PI * frequency * STEP).tan();
    let scale = 1.0 / (1.0 + SQRT_2 * k + k * k);
    let (b, a1, a2) = (k * k * scale, 2.0 * (k * k - 1.0) * scale, (1.0 - SQRT_2 * k + k * k) * scale);
    let (mut x, mut y) = ([signal[0]; 2], [signal[0]; 2]);
    let next = |now: &f64| {
        let new = b * (now + 2.0 * x[0] + x[1]) - a1 * y[0] - a2 * y[1];
        (x, y) = ([*now, x[0]], [new, y[0]]);
        new
    };
    signal.iter().map(next).collect()
}

fn reversed(signal: Vec<f64>) -> Vec<f64> {
    signal.into_iter().rev().collect()
}

fn mean_of_twenty(signal: &[f64]) -> Vec<f64> {
    let mean = |i: usize| {
        let window = &signal[i.saturating_sub(19)..=i];
        window.iter().sum::<f64>() / window.len() as f64
    };
    (0..signal.len()).map(mean).collect()
}

const FILTERS: [(&str, Filter); 4] = [
    ("Butterworth there and back", |u| reversed(butterworth(&reversed(butterworth(u, 3.0)), 3.0))),
    ("first order there and back", |u| reversed(first_order(&reversed(first_order(u, 4.0)), 4.0))),
    ("Butterworth in one pass", |u| butterworth(u, 4.0)),
    ("mean of a tenth of a second", mean_of_twenty),
];

/// A log of `arm3.urdf` with friction, 30 s at 200 Hz.
fn log(robot: &InterpretedRobot, filter: Filter) -> String {
    let mut seed = 7_u64;
    let mut noise = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    let waves = [[0.5, 1.9, 0.3], [0.4, 1.3, 1.1], [0.5, 2.3, 0.6]];
    let (mut positions, mut efforts) = (Vec::new(), vec![Vec::new(); 3]);
    for i in 0..6000 {
        let t = STEP * f64::from(i);
        let wave = |k: i32| {
            waves.map(|[a, w, p]| {
                let part =
                    |a: f64, w: f64, p: f64| a * w.powi(k) * (w * t + p + 0.5 * PI * f64::from(k)).sin();
                part(a, w, p) + part(0.5 * a, 2.17 * w, 2.0 * p) + part(0.2 * a, 3.6 * w, 3.0 * p)
            })
        };
        let (y, v, a) = (wave(0), wave(1), wave(2));
        let mut forces = [0.0; 3];
        robot.rigid_forces(&y, &v, &a, &mut forces);
        for (j, [viscous, coulomb]) in FRICTION.into_iter().enumerate() {
            efforts[j].push(forces[j] + viscous * v[j] + coulomb * (200.0 * v[j]).tanh() + 0.15 * noise());
        }
        positions.push(y.map(|q| (q / 2e-5).round() * 2e-5));
    }
    let efforts: Vec<Vec<f64>> = efforts.iter().map(|u| filter(u)).collect();
    let mut text =
        String::from("time,pan_position,lift_position,elbow_position,pan_effort,lift_effort,elbow_effort\n");
    for (i, [a, b, c]) in positions.iter().enumerate() {
        let [d, e, f] = [0, 1, 2].map(|j| efforts[j][i]);
        writeln!(text, "{:.3},{a:.5},{b:.5},{c:.5},{d:.4},{e:.4},{f:.4}", STEP * i as f64).unwrap();
    }
    text
}

/// Largest relative error of a law at some speeds, in both directions.
fn error(robot: &InterpretedRobot, joint: usize, speeds: &[f64]) -> f64 {
    let [viscous, coulomb] = FRICTION[joint];
    let relative = |v: f64| robot.friction(joint, v) / (viscous * v + coulomb * v.signum()) - 1.0;
    speeds.iter().flat_map(|v| [*v, -v]).map(|v| relative(v).abs()).fold(0.0, f64::max)
}

/// Whether the band of the efforts was noticed; the errors of each joint's law at fast and at slow speeds; the speeds from
/// which laws are resolved.
struct Found {
    is_noticed: bool,
    errors: [[f64; 3]; 2],
    resolved: [f64; 3],
}

fn found_with(filter: Filter, arguments: &[&str]) -> Found {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(cases().join("arm3.urdf"), folder.path().join("arm3.urdf")).unwrap();
    let robot = read(&folder.path().join("arm3.urdf"));
    fs::write(folder.path().join("log.csv"), log(&robot, filter)).unwrap();
    let found = identify(folder.path(), &[&["arm3.urdf", "log.csv"], arguments].concat());
    let robot = read(&folder.path().join("found.toml"));
    let errors = |speeds: &[f64]| [0, 1, 2].map(|joint| error(&robot, joint, speeds));
    Found {
        is_noticed: found["findings"].to_string().contains("efforts-low-passed"),
        errors: [errors(&[0.6, 0.3]), errors(&[0.05, 0.1])],
        resolved: [0, 1, 2].map(|joint| found["joints"][joint]["friction_resolved_from"].as_f64().unwrap()),
    }
}

fn largest(errors: [f64; 3]) -> f64 {
    errors.into_iter().fold(0.0, f64::max)
}

/// The steepest term of the library that the data tell decides the error of a slow law: `tanh(20*v)` is 0.76 at 0.05 rad/s.
#[test]
fn efforts_that_were_low_passed_have_the_same_friction() {
    let Found { is_noticed, errors: [fast, slow], resolved } = found_with(<[f64]>::to_vec, &[]);
    assert!(!is_noticed && largest(fast) < 0.02 && largest(slow) < 0.02, "{fast:.3?} {slow:.3?}");
    assert!(largest(resolved) < 0.2, "{resolved:.3?}");
    for (name, filter) in FILTERS {
        let found = found_with(filter, &[]);
        let [fast, slow] = found.errors;
        println!("{name}: {fast:.3?} {slow:.3?}, resolved from {:.3?}", found.resolved);
        assert!(found.is_noticed, "{name}");
        assert!(largest(fast) < 0.03 && largest(slow) < 0.27, "{name}: {fast:.3?} {slow:.3?}");
        assert!(
            found.resolved.iter().zip(resolved).all(|(now, before)| *now > before),
            "{:.3?}",
            found.resolved
        );
    }
    // The way out of a wrong guess, and the law that it gives here.
    let Found { is_noticed, errors: [_, slow], .. } = found_with(FILTERS[0].1, &["--bandwidth", "20"]);
    assert!(!is_noticed && largest(slow) > 0.4, "{slow:.3?}");
}
