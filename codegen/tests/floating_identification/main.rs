//! Robots with quaternions are identified from their poses.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

mod logs;
mod moments;
mod payload;
mod planned;
mod quadrotor;
mod quadruped;
mod satellite;

use std::path::{Path, PathBuf};

use gelenk_codegen::identify::InterpretedRobot;
use gelenk_codegen::read::{self, ReadOptions};

/// Numbers that are the same in every run.
struct Noise(u64);

impl Noise {
    fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15))
    }

    /// Between −1 and 1.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Approximately normal random number.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() / 2.0
    }

    fn vector(&mut self, deviation: f64) -> [f64; 3] {
        std::array::from_fn(|_| deviation * self.normal())
    }
}

fn models(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name).canonicalize().unwrap()
}

fn robot(path: &Path) -> InterpretedRobot {
    let loaded = read::read(path, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    InterpretedRobot::new(&loaded.model).unwrap_or_else(|e| panic!("{e}"))
}
