//! Simulated joints with a fault of a sensor or of the connection.
#![allow(clippy::expect_used, reason = "what cannot be set up ends the study")]

use super::warming::{Drift, PERIOD, Simulated};
use gelenk_runtime::adaptation::{AdaptationSettings, Measured, TERMS, terms};

/// Kinds of faults.
pub const FAULTS: [&str; 6] = [
    "stuck torque sensor",
    "stuck encoder",
    "swapped sign of the torque",
    "ten minutes of rest",
    "lost frames",
    "torque sensor that saturates",
];

/// Root-mean-square torque errors of the acting and of the described law over a run, including noise [N m].
#[derive(Debug, Clone, Copy)]
pub struct Outcome {
    pub acting: f64,
    pub described: f64,
}

/// Simulates two minutes of motion with fault number `seed % 6` from a random time on. The friction of every second robot drifts.
pub fn run(seed: u64) -> Outcome {
    let mut joint = Simulated::new(5000 + seed);
    if seed % 12 < 6 {
        joint.drift = Drift::NONE;
    }
    let kind = (seed % 6) as usize;
    let mut adaptation = joint.estimator(AdaptationSettings::new(PERIOD));
    let scale = adaptation.scales()[0].expect("the joint is learned");
    let (begin, end) = {
        let begin = (12_000.0 * joint.random.uniform()) as u32;
        (begin, begin + 500 + (6000.0 * joint.random.uniform()) as u32)
    };
    let (motion, clip) = (joint.motion, 0.5 * scale.torque);
    let (mut stuck, mut sums, mut moved) = ([0.0; 2], [0.0; 2], 0.0);
    let rest = if kind == 3 { 60_000 } else { 0 };
    for k in 0..12_000 + rest {
        let resting = kind == 3 && (begin..begin + rest).contains(&k);
        joint.motion = if resting { [[0.0; 3]; 3] } else { motion };
        let period = joint.period();
        let is_faulty = (begin..end).contains(&k) || kind == 2;
        if k == begin {
            stuck = [period.torque, period.position];
        }
        let (mut torque, mut position) = (period.torque, Some(period.position));
        match kind {
            0 if is_faulty => torque = stuck[0],
            1 if is_faulty => position = Some(stuck[1]),
            2 => torque = -torque,
            4 if is_faulty && joint.random.uniform() < 0.3 => position = None,
            5 if is_faulty => torque = torque.clamp(-clip, clip),
            _ => {}
        }
        let measured =
            Measured { positions: position.map(|y| [y]), torques: [torque], saturated: [false], periods: 1 };
        adaptation.step(&measured, |y, v, a| joint.forces(y[0], v[0], a[0]));
        let v = joint.state[1];
        if v.abs() > adaptation.rest(0) {
            let described = joint.described(v);
            let phi: [f64; TERMS] = terms(described, v, 0.0);
            let more: f64 = phi.iter().zip(&adaptation.acting()[0]).map(|(phi, delta)| phi * delta).sum();
            for (sum, law) in sums.iter_mut().zip([described + more, described]) {
                *sum += (law - joint.true_friction(v)).powi(2) + joint.noise * joint.noise;
            }
            moved += 1.0;
        }
    }
    let [acting, described] = sums.map(|sum: f64| (sum / moved).sqrt());
    Outcome { acting, described }
}
