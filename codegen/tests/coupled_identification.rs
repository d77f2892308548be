//! A robot whose wrist is a differential gear, identified in its motors' torques: B is full there.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use gelenk_codegen::identify::InterpretedRobot;
use gelenk_codegen::model::{self, Model, ReadOptions};
use gelenk_identification::robot::Robot;
use nalgebra::{DMatrix, DVector};

const N: usize = 4;

/// What the arm of `models/` really is.
const TRUTH: &str = r#"
name = "truth"
extends = "arm.toml"

[[joints]]
name = "elbow"
friction = { viscous = 5, coulomb = { value = 3, slope = 50 } }

[[joints]]
name = "wrist_pitch"
friction = { viscous = 0.5, coulomb = { value = 0.4, slope = 50 } }

[[joints]]
name = "wrist_roll"
friction = { viscous = 0.35 }

[[bodies]]
name = "wrist_roll"
mass = 1.4
center_of_mass = [0.02, 0.01, 0.1]
inertia = [0.004, 0.003, 0.002]

[[bodies]]
name = "elbow"
mass = 3
center_of_mass = [0, 0.02, 0.16]
"#;

/// A described robot with its friction.
struct Described(InterpretedRobot, Model);

impl Described {
    fn read(path: PathBuf) -> Self {
        let model = model::read(&path, &ReadOptions::default()).unwrap().model;
        Self(InterpretedRobot::new(&model).unwrap(), model)
    }

    /// Forces at the joints.
    fn forces(&self, [y, v, a]: &[Vec<f64>; 3]) -> Vec<f64> {
        let mut forces = vec![0.0; N];
        self.0.rigid_forces(y, v, a, &mut forces);
        for ((joint, v), force) in self.1.joints().zip(v).zip(&mut forces) {
            let terms = joint.friction.iter();
            *force += terms
                .map(|term| term.coefficient.evaluate(&[], 0.0, 0.0) * term.basis.evaluate(&[], 0.0, *v))
                .sum::<f64>();
        }
        forces
    }

    /// Torques of the motors: `B u` are the forces.
    fn inputs(&self, motion: &[Vec<f64>; 3]) -> Vec<f64> {
        let matrix = DMatrix::from_row_slice(N, N, &self.0.input_matrix());
        let forces = DVector::from_vec(self.forces(motion));
        matrix.lu().solve(&forces).unwrap().as_slice().to_vec()
    }

    /// The friction of a joint at a speed.
    fn friction(&self, name: &str, v: f64) -> f64 {
        let joint = self.1.joints().find(|joint| joint.name == name).unwrap();
        let terms = joint.friction.iter();
        terms.map(|term| term.coefficient.evaluate(&[], 0.0, 0.0) * term.basis.evaluate(&[], 0.0, v)).sum()
    }
}

/// Seeded numbers between -1 and 1.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Positions, velocities and accelerations: two sines for each joint.
fn motion(t: f64) -> [Vec<f64>; 3] {
    let at = |shape: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
        let joints =
            [[0.7, 1.1, 0.25, 3.1], [0.8, 1.7, 0.3, 3.9], [0.9, 2.1, 0.3, 5.3], [1.1, 1.3, 0.4, 4.7]];
        let waves = joints.iter().enumerate();
        waves.map(|(k, &[a, w, b, x])| a * shape(w, w * t + k as f64) + b * shape(x, x * t)).collect()
    };
    [at(&|_, x| x.sin()), at(&|w, x| w * x.cos()), at(&|w, x| -w * w * x.sin())]
}

/// 40 s at 200 Hz: encoders at the joints, torques of the motors with noise.
fn log(truth: &Described) -> String {
    let mut noise = Noise(3);
    let mut log = String::from("t [s]");
    for joint in truth.0.joint_names() {
        write!(log, ",q_{joint} [rad]").unwrap();
    }
    for input in truth.0.input_names() {
        write!(log, ",tau_{input} [N m]").unwrap();
    }
    log.push('\n');
    for step in 0..8000 {
        let t = 0.005 * f64::from(step);
        let moved = motion(t);
        write!(log, "{t:.3}").unwrap();
        for q in &moved[0] {
            write!(log, ",{:.5}", (q / 1e-5).round() * 1e-5).unwrap();
        }
        for u in truth.inputs(&moved) {
            write!(log, ",{:.6}", u + 3e-4 * noise.next()).unwrap();
        }
        log.push('\n');
    }
    log
}

/// Differences of the forces of two robots, rms by joint, in states like those of the motion.
fn differences(one: &Described, other: &Described) -> Vec<f64> {
    let mut noise = Noise(7);
    let mut sums = vec![0.0; N];
    for _ in 0..200 {
        let state = [1.0, 2.0, 6.0].map(|size| (0..N).map(|_| size * noise.next()).collect());
        for ((sum, a), b) in sums.iter_mut().zip(one.forces(&state)).zip(other.forces(&state)) {
            *sum += (a - b).powi(2) / 200.0;
        }
    }
    sums.into_iter().map(f64::sqrt).collect()
}

#[test]
fn a_coupled_wrist_is_identified_in_its_motors_torques() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    fs::copy(models.join("differential_wrist.toml"), at("arm.toml")).unwrap();
    fs::write(at("truth.toml"), TRUTH).unwrap();
    let [arm, truth] = ["arm.toml", "truth.toml"].map(|name| Described::read(at(name)));
    fs::write(at("log.csv"), log(&truth)).unwrap();

    let arguments = ["identify", "arm.toml", "log.csv", "--effort", "input", "--output", "found.toml"];
    let gelenk = Command::new(env!("CARGO_BIN_EXE_gelenk"));
    let output = { gelenk }.args(arguments).current_dir(folder.path()).output().unwrap();
    let text =
        [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
    println!("{text}");
    assert!(output.status.success(), "{text}");

    let found = Described::read(at("found.toml"));
    let [before, after] = [&arm, &found].map(|robot| differences(robot, &truth));
    println!("forces are off by {before:?}, identified by {after:?}");
    for (joint, (before, after)) in before.iter().zip(&after).enumerate() {
        assert!(*after < 0.03 * before, "joint {joint}: {after} of {before}");
    }
    for (joint, speeds) in [("wrist_pitch", [-1.5, 0.8]), ("wrist_roll", [-1.5, 0.8])] {
        for v in speeds {
            let [described, true_, found] = [&arm, &truth, &found].map(|robot| robot.friction(joint, v));
            println!("{joint} at {v}: described {described}, true {true_}, found {found}");
            assert!((found - true_).abs() < 0.05 * true_.abs(), "{joint} at {v}: {found} for {true_}");
        }
    }
}
