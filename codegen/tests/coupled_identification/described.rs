//! A robot of `models/` with a coupled wrist, what it really is, and a log of that.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use gelenk_codegen::identify::InterpretedRobot;
use gelenk_codegen::model::Model;
use gelenk_codegen::read::{self, ReadOptions};
use gelenk_identification::robot::Robot;
use nalgebra::{DMatrix, DVector};
use tempfile::TempDir;

/// Number of joints of the differential wrist.
const N: usize = 4;

/// Positions, velocities and accelerations of all joints at a time.
pub(crate) type Motion = fn(f64) -> [Vec<f64>; 3];

/// A described robot with its friction.
pub(crate) struct Described(pub(crate) InterpretedRobot, pub(crate) Model);

impl Described {
    pub(crate) fn read(path: PathBuf) -> Self {
        let model = read::read(&path, &ReadOptions::default()).unwrap().model;
        Self(InterpretedRobot::new(&model).unwrap(), model)
    }

    /// Forces at the joints.
    pub(crate) fn forces(&self, [y, v, a]: &[Vec<f64>; 3]) -> Vec<f64> {
        let mut forces = vec![0.0; v.len()];
        self.0.rigid_forces(y, v, a, &mut forces);
        for ((joint, v), force) in self.1.joints().zip(v).zip(&mut forces) {
            *force += self.joint_friction(&joint.name, *v);
        }
        for shaft in self.0.shafts() {
            let speed: f64 = shaft.ratios.iter().zip(v).map(|(ratio, v)| ratio * v).sum();
            let torque = self.shaft_friction(&shaft.name, speed);
            shaft.ratios.iter().zip(&mut forces).for_each(|(ratio, force)| *force += ratio * torque);
        }
        forces
    }

    /// Torques of the motors: `B u` are the forces.
    pub(crate) fn inputs(&self, motion: &[Vec<f64>; 3]) -> Vec<f64> {
        let n = motion[1].len();
        let matrix = DMatrix::from_row_slice(n, n, &self.0.input_matrix());
        let forces = DVector::from_vec(self.forces(motion));
        matrix.lu().solve(&forces).unwrap().as_slice().to_vec()
    }

    /// The friction of a joint at a speed.
    pub(crate) fn joint_friction(&self, name: &str, v: f64) -> f64 {
        let joint = self.1.joints().find(|joint| joint.name == name).unwrap();
        let terms = joint.friction.iter();
        terms.map(|term| term.coefficient.evaluate(&[], 0.0, 0.0) * term.basis.evaluate(&[], 0.0, v)).sum()
    }

    /// The friction of a drive's shaft at a speed of the motor.
    pub(crate) fn shaft_friction(&self, name: &str, v: f64) -> f64 {
        let drive = self.1.drives.iter().find(|drive| drive.name == name).unwrap();
        let terms = drive.friction.iter();
        terms.map(|term| term.coefficient.evaluate(&[], 0.0, 0.0) * term.basis.evaluate(&[], 0.0, v)).sum()
    }
}

/// Seeded numbers between -1 and 1.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Two sines for each joint.
pub(crate) fn motion(t: f64) -> [Vec<f64>; 3] {
    sines([[0.7, 1.1, 0.25, 3.1], [0.8, 1.7, 0.3, 3.9], [0.9, 2.1, 0.3, 5.3], [1.1, 1.3, 0.4, 4.7]], t)
}

/// `a sin(w t + k) + b sin(x t)` of the k-th joint.
pub(crate) fn sines<const JOINTS: usize>(joints: [[f64; 4]; JOINTS], t: f64) -> [Vec<f64>; 3] {
    let at = |shape: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
        let waves = joints.iter().enumerate();
        waves.map(|(k, &[a, w, b, x])| a * shape(w, w * t + k as f64) + b * shape(x, x * t)).collect()
    };
    [at(&|_, x| x.sin()), at(&|w, x| w * x.cos()), at(&|w, x| -w * w * x.sin())]
}

/// A folder with an arm of `models/`, what it really is, and a log.
pub(crate) struct Wrist(TempDir);

impl Wrist {
    pub(crate) fn new(truth: &str) -> Self {
        Self::moved("differential_wrist", truth, motion)
    }

    /// - `model`: a robot of `models/`
    pub(crate) fn moved(model: &str, truth: &str, motion: Motion) -> Self {
        let wrist = Self(tempfile::tempdir().unwrap());
        let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
        fs::copy(models.join(format!("{model}.toml")), wrist.at("arm.toml")).unwrap();
        fs::write(wrist.at("truth.toml"), truth).unwrap();
        fs::write(wrist.at("log.csv"), log(&wrist.robot("truth.toml"), motion)).unwrap();
        wrist
    }

    /// Writes the log anew.
    pub(crate) fn record(&self) {
        fs::write(self.at("log.csv"), log(&self.robot("truth.toml"), motion)).unwrap();
    }

    pub(crate) fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn robot(&self, name: &str) -> Described {
        Described::read(self.at(name))
    }

    /// Output of `gelenk identify` for the log.
    pub(crate) fn identify(&self, output: &str, options: &[&str]) -> String {
        let command = ["arm.toml", "log.csv", "--effort", "input", "--output", output];
        self.gelenk(&[&command[..], options].concat())
    }

    /// Output of `gelenk identify`.
    pub(crate) fn gelenk(&self, arguments: &[&str]) -> String {
        let (succeeds, text) = self.run(arguments);
        assert!(succeeds, "{text}");
        text
    }

    /// Why `gelenk identify` fails.
    pub(crate) fn refused(&self, arguments: &[&str]) -> String {
        let (succeeds, text) = self.run(arguments);
        assert!(!succeeds, "{text}");
        text
    }

    fn run(&self, arguments: &[&str]) -> (bool, String) {
        let mut gelenk = Command::new(env!("CARGO_BIN_EXE_gelenk"));
        let output = gelenk.arg("identify").args(arguments).current_dir(self.0.path()).output().unwrap();
        let text = [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
        (output.status.success(), text.concat())
    }
}

/// 40 s at 200 Hz: encoders at the joints, torques of the motors with noise.
fn log(truth: &Described, motion: Motion) -> String {
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
pub(crate) fn differences(one: &Described, other: &Described) -> Vec<f64> {
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
