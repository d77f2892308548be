//! The observer of predictive controllers with its defaults: friction that the model does not know, on an arm with seven axes.

#![allow(clippy::unwrap_used, reason = "test code")]

use crate::support::rubbing::{Rubbing, Sign};
use gelenk_runtime::control_loop::{Controller, Cycle};
use gelenk_runtime::mpc::{LtvMpc, MpcOptions};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{RestToRest, Trajectory};

const START: [f64; 7] = [0.0, -0.5, 0.0, -2.0, 0.0, 1.6, 0.4];
const END: [f64; 7] = [0.6, 0.1, -0.4, -1.4, 0.3, 2.0, 0.0];
const MODEL: Rubbing = Rubbing { scale: [1.0; 7], sign: Sign::Smooth };
const PERIOD: f64 = 0.01;

/// Errors of the second joint [mrad]: root of their mean square over a motion of 2 s, and the largest of half a second of rest after
/// a whole one.
fn track(plant: Rubbing, encoders: f64, options: MpcOptions<7, 7>, periods: u32) -> [f64; 2] {
    let motion = RestToRest::new(START, END, 2.0).unwrap();
    let mut controller = LtvMpc::new(MODEL, motion, options).unwrap();
    let options = PlantOptions { encoder_resolution: [encoders; 7], ..PlantOptions::default() };
    let mut plant = Plant::new(plant, options).unwrap();
    plant.reset(START, [0.0; 7]).unwrap();
    let (mut last_inputs, mut squares, mut rest) = ([0.0; 7], 0.0, 0.0_f64);
    controller.reset(&START, &last_inputs);
    for k in 0..periods {
        let time = f64::from(k) * PERIOD;
        let error = plant.state().0[1] - motion.sample(time).positions[1];
        squares += if k < 200 { error * error / 200.0 } else { 0.0 };
        rest = if k < 250 { 0.0 } else { rest.max(error.abs()) };
        let cycle = Cycle {
            time,
            periods: u32::from(k > 0),
            positions: Some(plant.measure().positions),
            last_inputs,
            ..Cycle::default()
        };
        last_inputs = controller.step(&cycle).unwrap().inputs;
        plant.apply(&last_inputs, PERIOD).unwrap();
    }
    [1e3 * squares.sqrt(), 1e3 * rest]
}

/// 50 % more friction in the second joint than the model has.
fn rubbing(sign: Sign) -> Rubbing {
    Rubbing { scale: [1.0, 1.5, 1.0, 1.0, 1.0, 1.0, 1.0], sign }
}

#[test]
fn friction_that_the_model_does_not_know_is_estimated() {
    let options = MpcOptions::new(&MODEL, PERIOD, 5);
    let mut without = options.clone();
    without.observer.disturbance_noise = [0.0; 7];
    let [without, _] = track(rubbing(Sign::Smooth), 0.0, without, 200);
    let [with, _] = track(rubbing(Sign::Smooth), 0.0, options, 200);
    println!("{without:.3} mrad without, {with:.3} with");
    assert!(without > 2.5 && with < 0.3, "{without} mrad without, {with} with");
}

/// Stiction, right models and coarse encoders leave the arm calm.
#[test]
#[ignore = "minutes in a debug build: cargo test --release -p gelenk-runtime --test all mpc_observer:: -- --ignored"]
fn the_estimate_is_calm() {
    for (plant, encoders, [error, rest]) in [
        (rubbing(Sign::Exact), 3.5e-5, [0.4, 0.4]),
        (Rubbing { sign: Sign::Exact, ..MODEL }, 3.5e-5, [0.4, 0.4]),
        (MODEL, 0.0, [0.02, 0.01]),
        (MODEL, 1e-4, [0.1, 0.1]),
        (MODEL, 1e-3, [0.3, 0.5]),
        (rubbing(Sign::Smooth), 1e-3, [3.0, 1.5]),
    ] {
        let options = MpcOptions::new(&MODEL, PERIOD, 20).with_encoders([f64::max(encoders, 3.5e-5); 7]);
        let found = track(plant, encoders, options, 300);
        println!("{plant:?} {encoders}: {found:.3?} mrad");
        assert!(found[0] < error && found[1] < rest, "{plant:?} {encoders}: {found:?} mrad");
    }
}
