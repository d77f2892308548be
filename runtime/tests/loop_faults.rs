//! Seeded faults of sensors and connection in the loop: the controller that learns keeps the limits, and is not worse than the
//! controller with the described friction.

#![allow(clippy::unwrap_used, reason = "test code")]

use crate::support::learning::described;
use crate::support::robot::{
    DURATION, PowerCube, START, Seen, Watched, motion, plant_at, plant_options, settings,
};
use gelenk_runtime::adaptation::{AdaptationSettings, Adaptive, TorqueSource};
use gelenk_runtime::control_loop::{
    Command, ControlLoop, Controller, ControllerFault, Cycle, End, FeedForwardPd, JointGains, JointPd,
};
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::plant::PlantOptions;
use gelenk_runtime::trajectory::{RestToRest, Sample, Trajectory};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::{Arc, Mutex};

const RATE: f64 = 50.0;
/// Number of motions forth or back.
const PARTS: u32 = 12;
const FAULTS: [&str; 6] = [
    "stuck torque sensor",
    "stuck encoder",
    "swapped sign of the torque",
    "ten minutes of rest",
    "lost frames",
    "torque sensor that saturates",
];

/// The motion forth and back, with a rest after some parts.
#[derive(Clone, Copy)]
struct Repeated {
    motion: RestToRest<2>,
    /// Number of parts before the rest.
    before: u32,
    /// Duration of the rest (s).
    rest: f64,
}

impl Trajectory<2> for Repeated {
    fn duration(&self) -> f64 {
        f64::from(PARTS) * DURATION + self.rest
    }

    fn sample(&self, t: f64) -> Sample<2> {
        let begin = f64::from(self.before) * DURATION;
        let moved = if t > begin { (t - self.rest).max(begin) } else { t };
        let part = (moved / DURATION).floor().min(f64::from(PARTS - 1));
        let (time, is_back) = (moved - part * DURATION, part % 2.0 == 1.0);
        let sample = self.motion.sample(if is_back { DURATION - time } else { time });
        if is_back { Sample { velocities: sample.velocities.map(|v| -v), ..sample } } else { sample }
    }
}

/// Adds up the squares of the true tracking errors.
struct Judged<C> {
    controller: C,
    motion: Repeated,
    /// True positions at the last reading.
    positions: Arc<Mutex<[f64; 2]>>,
    sums: [f64; 3],
}

impl<C: Controller<2, 2>> Controller<2, 2> for Judged<C> {
    fn reset(&mut self, positions: &[f64; 2], inputs: &[f64; 2]) {
        self.controller.reset(positions, inputs);
    }

    fn step(&mut self, cycle: &Cycle<2, 2>) -> Result<Command<2>, ControllerFault> {
        let (desired, positions) =
            (self.motion.sample(cycle.time).positions, *self.positions.lock().unwrap());
        if cycle.time < self.motion.duration() {
            (0..2).for_each(|i| self.sums[i] += (positions[i] - desired[i]).powi(2));
            self.sums[2] += 1.0;
        }
        self.controller.step(cycle)
    }
}

/// Root mean squares of the tracking errors [rad], whether the motion was finished, and extremes of the motion.
fn run<C: Controller<2, 2>>(seed: u64, make: impl FnOnce(Repeated) -> C) -> ([f64; 2], bool, Seen) {
    let kind = seed % FAULTS.len() as u64;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let rest = if kind == 3 { 600.0 } else { 0.0 };
    let motion = Repeated { motion: motion(), before: random.random_range(1..PARTS), rest };
    let begin = random.random_range(0..(RATE * motion.duration()) as u64);
    let end = begin + random.random_range(50..1500);
    let options = PlantOptions { torque_noise: Some([0.3; 2]), seed, ..plant_options() };
    let (positions, most) = (Arc::new(Mutex::new(START)), [40.0, 8.0]);
    let (seen, mut held) = (Arc::clone(&positions), None);
    let mut robot = Watched::new(RATE, plant_at(START, options)).with_fault(move |k, mut reading| {
        *seen.lock().unwrap() = reading.positions;
        let torques = reading.torques.as_mut()?;
        let is_faulty = (begin..end).contains(&k);
        if is_faulty {
            held.get_or_insert((*torques, reading.positions));
        }
        match (kind, held) {
            (0, Some((torque, _))) if is_faulty => *torques = torque,
            (1, Some((_, position))) if is_faulty => reading.positions = position,
            (2, _) => *torques = torques.map(|torque| -torque),
            (4, _) if is_faulty && random.random::<f64>() < 0.3 => return None,
            (5, _) if is_faulty => (0..2).for_each(|i| torques[i] = torques[i].clamp(-most[i], most[i])),
            _ => {}
        }
        Some(reading)
    });
    let gains = JointGains::from_bandwidth(&PowerCube, &START, 10.0, 0.7);
    let law = JointPd::new(PowerCube, gains).unwrap();
    let judged = Judged { controller: make(motion), motion, positions, sums: [0.0; 3] };
    let clock = robot.clock.clone();
    let mut control = ControlLoop::new(settings(RATE), law, motion, judged, &mut robot, clock).unwrap();
    let is_finished = control.run().end == End::Finished;
    let [first, second, count] = control.controller().sums;
    drop(control);
    ([first, second].map(|sum| (sum / count).sqrt()), is_finished, robot.seen)
}

fn pd<D: Dynamics<2, 2>>(model: D, motion: Repeated) -> FeedForwardPd<D, Repeated, 2, 2> {
    let gains = JointGains::from_bandwidth(&PowerCube, &START, 10.0, 0.7);
    FeedForwardPd::new(JointPd::new(model, gains).unwrap(), motion, 1.0 / RATE, 0.01).unwrap()
}

/// `GELENK_LOOP_FAULTS=1000` runs a thousand seeds.
#[test]
fn faults_break_no_limit_and_do_not_make_the_loop_worse() {
    let count = std::env::var("GELENK_LOOP_FAULTS").ok().and_then(|count| count.parse().ok()).unwrap_or(6);
    for (kind, name) in FAULTS.iter().enumerate() {
        let mut ratios = Vec::new();
        for seed in (kind as u64..count).step_by(FAULTS.len()) {
            let (fixed, is_finished, _) = run(seed, |motion| pd(described(), motion));
            let (learning, is_also_finished, seen) = run(seed, |motion| {
                let make = |model| Ok::<_, std::convert::Infallible>(pd(model, motion));
                let made = Adaptive::new(described(), AdaptationSettings::new(1.0 / RATE), make);
                made.unwrap().unwrap().with_torques(TorqueSource::Measured)
            });
            seen.assert_within_limits();
            assert!(is_also_finished || !is_finished, "{name}, seed {seed}");
            ratios.extend((0..2).map(|i| learning[i] / fixed[i]));
        }
        let worst = ratios.iter().fold(0.0_f64, |a, b| a.max(*b));
        let beyond = ratios.iter().filter(|ratio| **ratio > 1.05).count();
        println!(
            "{name}: error at most {worst:.3} of the described law's, above 1.05 in {beyond} of {}",
            ratios.len()
        );
        assert!(worst < 1.05, "{name}: {ratios:?}");
    }
}
