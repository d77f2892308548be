//! Simulated logs with encoders of 10 to 24 bits and rates of 50 Hz to 4 kHz, with repeated values, jitter, gaps and
//! delays.

use super::super::super::numeric::random::SplitMix64;
use super::super::super::robot::Robot;
use super::super::super::run::{Effort, PreparedRun, Run};
use super::super::{PreparationReport, PreparationSettings, prepare_all};
use super::arm::Arm;
use super::fit::{fit, r_squared};
use std::f64::consts::PI;

/// Properties of a simulated log.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sampling {
    /// Number of bits of the encoder at the joint, whose resolution is 2π / 2^bits.
    pub bits: u32,
    /// Rows per second.
    pub rate: f64,
    /// Rows for each new value of the driver.
    pub hold: usize,
    /// Standard deviation of a sample's time, as a share of the time step.
    pub jitter: f64,
    /// Whether 0.1 s to 0.4 s are missing in three places, and single rows everywhere.
    pub gaps: bool,
    /// Delay of the efforts in s.
    pub delay: f64,
}

/// A motion as a sum of sines below 1 Hz, with phases from a seed. Its speed often changes sign.
pub(crate) struct Motion {
    waves: Vec<Vec<[f64; 3]>>,
}

impl Motion {
    pub(crate) fn new(joints: usize, seed: u64) -> Self {
        let mut random = SplitMix64::new(seed);
        let wave = |k: usize, random: &mut SplitMix64| {
            let frequency = 0.1 * (k + 1) as f64 * (1.0 + 0.1 * random.uniform());
            [
                0.5 / (k as f64 + 1.0) * (0.7 + 0.6 * random.uniform()),
                2.0 * PI * frequency,
                2.0 * PI * random.uniform(),
            ]
        };
        Self { waves: (0..joints).map(|_| (0..8).map(|k| wave(k, &mut random)).collect()).collect() }
    }

    /// Returns y, ẏ and ÿ at a time.
    pub(crate) fn at(&self, t: f64) -> [Vec<f64>; 3] {
        let sum = |f: &dyn Fn(&[f64; 3]) -> f64| self.waves.iter().map(|w| w.iter().map(f).sum()).collect();
        [
            sum(&|[a, w, p]| a * (w * t + p).sin()),
            sum(&|[a, w, p]| a * w * (w * t + p).cos()),
            sum(&|[a, w, p]| -a * w * w * (w * t + p).sin()),
        ]
    }
}

/// Returns joint torques with Coulomb and viscous friction, with exact steps at reversals.
pub(crate) fn torques(arm: &Arm, [y, v, a]: &[Vec<f64>; 3]) -> Vec<f64> {
    let mut forces = vec![0.0; y.len()];
    arm.rigid_forces(y, v, a, &mut forces);
    for (force, v) in forces.iter_mut().zip(v) {
        *force += 2.0 * v + 1.5 * v.signum();
    }
    forces
}

/// Returns the times of the samples, with jitter and gaps.
fn instants(sampling: &Sampling, duration: f64, random: &mut SplitMix64) -> Vec<f64> {
    let step = 1.0 / sampling.rate;
    let mut times = Vec::new();
    for i in 0..(duration * sampling.rate) as usize {
        let shift = (sampling.jitter * random.normal()).clamp(-0.45, 0.45);
        let t = (i as f64 + shift) * step;
        let lost = [0.2, 0.5, 0.7]
            .iter()
            .enumerate()
            .any(|(k, at)| (at * duration..at * duration + 0.1 * (k as f64 + 2.0)).contains(&t));
        if !(sampling.gaps && (lost || random.uniform() < 0.01)) {
            times.push(t);
        }
    }
    times
}

/// Returns a log, and the same times with the true motion and with equally noisy efforts that have no delay.
pub(crate) fn log(arm: &Arm, sampling: &Sampling, duration: f64, seed: u64) -> (Run, PreparedRun) {
    let n = arm.joints.len();
    let motion = Motion::new(n, seed);
    let mut random = SplitMix64::new(1000 + seed);
    let quantum = 2.0 * PI / f64::from(1_u32 << sampling.bits);
    let times = instants(sampling, duration, &mut random);
    let (mut positions, mut efforts) = (vec![Vec::new(); n], vec![Vec::new(); n]);
    let mut truth = PreparedRun {
        poses: Vec::new(),
        resting: Vec::new(),
        name: "truth".into(),
        times: times.clone(),
        rows: (2..times.len() + 2).collect(),
        positions: vec![Vec::new(); n],
        velocities: vec![Vec::new(); n],
        accelerations: vec![Vec::new(); n],
        efforts: vec![Vec::new(); n],
        effort: Effort::Joint,
    };
    for (i, t) in times.iter().enumerate() {
        let state = motion.at(*t);
        let (now, late) = (torques(arm, &state), torques(arm, &motion.at(t - sampling.delay)));
        for j in 0..n {
            let noise = 0.2 * random.normal();
            let old = i % sampling.hold != 0;
            let repeat = |column: &Vec<f64>, new: f64| if old { *column.last().unwrap() } else { new };
            let (y, u) = ((state[0][j] / quantum).round() * quantum, late[j] + noise);
            let (y, u) = (repeat(&positions[j], y), repeat(&efforts[j], u));
            positions[j].push(y);
            efforts[j].push(u);
            truth.positions[j].push(state[0][j]);
            truth.velocities[j].push(state[1][j]);
            truth.accelerations[j].push(state[2][j]);
            truth.efforts[j].push(now[j] + noise);
        }
    }
    let run = Run {
        poses: Vec::new(),
        name: format!("simulated {seed}"),
        rows: truth.rows.clone(),
        times,
        positions,
        velocities: vec![None; n],
        efforts,
        effort: Effort::Joint,
    };
    (run, truth)
}

/// Results for one kind of sampling.
pub(crate) struct Outcome {
    /// R² on an unseen log, with true derivatives and unfiltered efforts.
    pub truth: Vec<f64>,
    /// R² with prepared logs, for the fit and for the unseen log.
    pub prepared: Vec<f64>,
    /// R² of the parameters from prepared logs on the unseen true motion.
    pub transferred: Vec<f64>,
    pub report: PreparationReport,
}

impl Outcome {
    /// Returns the largest loss of the prepared R² and of the transferred R² compared with the true R².
    pub(crate) fn loss(&self) -> f64 {
        let all = self.prepared.iter().zip(&self.transferred).zip(&self.truth);
        all.map(|((p, t), truth)| truth - p.min(*t)).fold(f64::NEG_INFINITY, f64::max)
    }
}

pub(crate) fn outcome(arm: &Arm, sampling: &Sampling, duration: f64) -> Outcome {
    let (seen, true_seen) = log(arm, sampling, duration, 1);
    let (unseen, true_unseen) = log(arm, sampling, duration, 2);
    let settings = PreparationSettings::default();
    let (prepared, report) = prepare_all(&[seen], Some(arm), &settings).unwrap();
    let (unseen, _) = prepare_all(&[unseen], Some(arm), &settings).unwrap();
    let by_truth = fit(arm, &[true_seen]);
    let by_log = fit(arm, &prepared);
    let truth = [true_unseen];
    Outcome {
        truth: r_squared(arm, &by_truth, &truth),
        prepared: r_squared(arm, &by_log, &unseen),
        transferred: r_squared(arm, &by_log, &truth),
        report,
    }
}

pub(crate) const GOOD: Sampling =
    Sampling { bits: 16, rate: 500.0, hold: 1, jitter: 0.0, gaps: false, delay: 0.0 };

/// Returns all kinds of sampling of the study, one row each.
fn table() -> Vec<Sampling> {
    let mut all = Vec::new();
    for bits in [10, 12, 14, 17, 20, 24] {
        for rate in [50.0, 100.0, 250.0, 500.0, 1000.0, 4000.0] {
            for (hold, jitter, gaps, delay) in [
                (1, 0.0, false, 0.0),
                (1, 0.2, false, 0.02),
                (4, 0.0, false, 0.01),
                (1, 0.0, true, 0.06),
                (2, 0.1, true, 0.03),
            ] {
                all.push(Sampling { bits, rate, hold, jitter, gaps, delay });
            }
        }
    }
    all
}

fn print(sampling: &Sampling, outcome: &Outcome) {
    let delays: Vec<f64> = outcome.report.delays.iter().map(|d| 1e3 * d.removed).collect();
    println!(
        "{:2} bit {:5} Hz hold {} jitter {:.1} gaps {:5} delay {:4.0} ms | {:6.2} Hz {:6.1}/s delays {:6.2?} | true {:.4?} prepared {:.4?} transferred {:.4?} | loss {:+.4}",
        sampling.bits,
        sampling.rate,
        sampling.hold,
        sampling.jitter,
        sampling.gaps,
        1e3 * sampling.delay,
        outcome.report.filter.bandwidth(),
        outcome.report.sample_rate,
        delays,
        outcome.truth,
        outcome.prepared,
        outcome.transferred,
        outcome.loss()
    );
}

/// `cargo test --release -p gelenk-identification --lib preparation::study -- --ignored --nocapture`
#[test]
#[ignore = "the whole table; takes minutes"]
fn defaults_stay_near_the_true_derivatives_everywhere() {
    let arm = Arm::pendulum();
    let mut worst = Vec::new();
    for sampling in table() {
        let outcome = outcome(&arm, &sampling, 20.0);
        print(&sampling, &outcome);
        if outcome.loss() > 0.01 {
            worst.push(sampling);
        }
    }
    assert!(worst.is_empty(), "{} of {}: {worst:#?}", worst.len(), table().len());
}

#[test]
fn defaults_stay_near_the_true_derivatives() {
    let arm = Arm::pendulum();
    let cases = [
        Sampling { bits: 10, rate: 50.0, jitter: 0.2, delay: 0.06, ..GOOD },
        Sampling { bits: 16, rate: 120.0, hold: 2, gaps: true, delay: 0.02, ..GOOD },
    ];
    for sampling in cases {
        let outcome = outcome(&arm, &sampling, 12.0);
        print(&sampling, &outcome);
        assert!(outcome.loss() < 0.01, "{sampling:?}: {}", outcome.loss());
        for delay in &outcome.report.delays {
            // The tolerance is a quarter of the time step of the coarser log.
            assert!((delay.removed - sampling.delay).abs() < 5e-3, "{sampling:?}: {delay:?}");
        }
    }
}
