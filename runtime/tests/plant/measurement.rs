//! Measurements and options of the plant: rounding, delays, losses, noise, and rejected numbers.

use super::{PowerCube, SLIDER, Slider, close, ideal};
use gelenk_runtime::plant::{Plant, PlantError, PlantOptions};

#[test]
fn encoders_round_and_inputs_are_rounded_and_limited() {
    let options = PlantOptions {
        encoder_resolution: [1e-3],
        input_resolution: [0.25],
        input_limits: [[-1.1, 1.1]],
        ..PlantOptions::default()
    };
    let mut plant = Plant::new(SLIDER, options).unwrap();
    for (u, applied) in [(0.3, 0.25), (-0.4, -0.5), (5.0, 1.1), (-1.2, -1.1)] {
        plant.apply(&[u], 0.1).unwrap();
        assert_eq!(plant.applied(), [applied]);
        let measured = plant.measure().positions[0];
        close(measured, plant.state().0[0], 0.5e-3 + 1e-15);
        close((measured / 1e-3).fract().abs() % 1.0, 0.0, 1e-9);
    }
}

#[test]
fn a_delayed_input_acts_periods_later() {
    let options = PlantOptions { delay: 2, ..PlantOptions::default() };
    let mut plant = Plant::new(SLIDER, options).unwrap();
    plant.preload([0.5]);
    let mut seen = Vec::new();
    for u in [1.0, 2.0, 3.0, 4.0] {
        plant.apply(&[u], 0.01).unwrap();
        seen.push(plant.applied()[0]);
    }
    assert_eq!(seen, [0.5, 0.5, 1.0, 2.0]);
}

#[test]
fn losses_hold_inputs_and_measurements() {
    let options = PlantOptions { input_loss: 0.2, measurement_loss: 0.2, seed: 7, ..PlantOptions::default() };
    let mut plant = Plant::new(SLIDER, options).unwrap();
    let (mut inputs, mut measurements) = (0, 0);
    for k in 1..=5000 {
        let before = (plant.applied(), plant.measure());
        plant.apply(&[f64::from(k)], 1e-3).unwrap();
        if plant.applied() == before.0 {
            inputs += 1;
        }
        if plant.measure() == before.1 {
            measurements += 1;
            assert!(plant.measure().time < plant.time());
        } else {
            assert_eq!(plant.measure().time, plant.time());
        }
    }
    // Five standard deviations of the binomial distribution are 141.
    for lost in [inputs, measurements] {
        assert!((859..=1141).contains(&lost), "{lost} of 5000 lost");
    }
}

#[test]
fn noise_has_its_standard_deviation() {
    let options = PlantOptions { encoder_noise: [2e-3], input_noise: [0.3], ..PlantOptions::default() };
    let mut plant = Plant::new(SLIDER, options).unwrap();
    let (mut position, mut input) = (0.0, 0.0);
    let n = 20_000;
    for _ in 0..n {
        plant.apply(&[0.1], 1e-3).unwrap();
        position += (plant.measure().positions[0] - plant.state().0[0]).powi(2);
        input += (plant.applied()[0] - 0.1).powi(2);
    }
    // The standard deviation of such an estimate is σ/√(2n), half a percent.
    close((position / f64::from(n)).sqrt(), 2e-3, 0.03 * 2e-3);
    close((input / f64::from(n)).sqrt(), 0.3, 0.03 * 0.3);
}

#[test]
fn the_seed_decides_everything() {
    let run = |seed| {
        let options = PlantOptions {
            encoder_noise: [1e-3; 2],
            input_noise: [0.01; 2],
            input_loss: 0.1,
            measurement_loss: 0.1,
            delay: 1,
            seed,
            ..PlantOptions::default()
        };
        let mut plant = Plant::new(PowerCube, options).unwrap();
        let mut all = Vec::new();
        for k in 0..100 {
            plant.apply(&[0.1, 0.001 * f64::from(k)], 0.02).unwrap();
            let (y, v) = plant.state();
            all.push((plant.measure().positions.map(f64::to_bits), y.map(f64::to_bits), v.map(f64::to_bits)));
        }
        all
    };
    assert_eq!(run(3), run(3));
    assert_ne!(run(3), run(4));
}

#[test]
fn errors_name_the_numbers_and_leave_the_plant() {
    let mut plant = ideal(PowerCube);
    plant.reset([0.1, 0.2], [0.3, 0.4]).unwrap();
    let before = (plant.state(), plant.time());
    let error = plant.apply(&[0.0, f64::NAN], 0.02).unwrap_err();
    assert_eq!(error.to_string(), "input gamma is NaN, but inputs must be finite");
    assert_eq!(plant.hold(0.0).unwrap_err(), PlantError::Period(0.0));
    assert!(plant.apply(&[0.0; 2], f64::INFINITY).is_err());
    assert!(plant.reset([f64::NAN, 0.0], [0.0; 2]).is_err());
    assert_eq!((plant.state(), plant.time()), before);

    let options = PlantOptions { input_loss: 1.5, ..PlantOptions::default() };
    let error = Plant::new(PowerCube, options).err().unwrap();
    assert_eq!(error.to_string(), "plant option input_loss is 1.5, but must be a probability, 0 to 1");
    let options = PlantOptions { velocity_noise: Some([0.0, -1.0]), ..PlantOptions::default() };
    let error = Plant::new(PowerCube, options).err().unwrap();
    assert_eq!(
        error.to_string(),
        "plant option velocity_noise[gamma] is -1, but must be finite and not negative"
    );
}

/// Steps and periods at the ends of what is a number.
#[test]
fn extreme_numbers_neither_hang_nor_pass_as_results() {
    let options = PlantOptions {
        encoder_resolution: [5e-324, 1e308],
        input_resolution: [5e-324, 1e-320],
        ..PlantOptions::default()
    };
    let mut plant = Plant::new(PowerCube, options).unwrap();
    plant.reset([0.1, 0.2], [0.0; 2]).unwrap();
    assert_eq!(plant.measure().positions, [0.1, 0.0]);
    plant.apply(&[0.1, 0.1], 0.02).unwrap();
    assert_eq!(plant.applied(), [0.1; 2]);
    for inputs in [[1e308, 0.0], [-1e308, 1e308], [1e100, 1e100]] {
        let mut plant = ideal(PowerCube);
        let before = plant.state();
        match plant.apply(&inputs, 0.02) {
            Ok(()) => assert!(plant.state().0.iter().all(|y| y.is_finite())),
            Err(PlantError::Integration { .. }) => {
                assert_eq!(plant.state(), before);
                // And it can go on.
                plant.apply(&[0.1, 0.1], 0.02).unwrap();
            }
            Err(other) => panic!("{other}"),
        }
    }
    for period in [5e-324, 1e-15, f64::MAX] {
        let mut plant = ideal(PowerCube);
        let _ = plant.apply(&[0.1, 0.1], period);
        assert!(plant.state().0.iter().all(|y| y.is_finite()), "{period}");
    }
}

/// Measurements of drives: true velocities and B u, each with its own noise, and no influence on the motion.
#[test]
fn velocities_and_torques_are_measured_where_the_options_say_so() {
    let run = |velocity_noise, torque_noise| {
        let options = PlantOptions {
            velocity_noise,
            torque_noise,
            encoder_noise: [1e-4; 2],
            ..PlantOptions::default()
        };
        let mut plant = Plant::new(PowerCube, options).unwrap();
        plant.reset([0.3, 0.2], [0.0; 2]).unwrap();
        for _ in 0..20 {
            plant.apply(&[0.2, -0.1], 0.02).unwrap();
        }
        (plant.measure(), plant.state())
    };
    let (plain, state) = run(None, None);
    assert_eq!((plain.velocities, plain.torques), (None, None));
    let (exact, same) = run(Some([0.0; 2]), Some([0.0; 2]));
    assert_eq!((exact.positions, same), (plain.positions, state));
    assert_eq!(exact.velocities, Some(state.1));
    // The gear ratio is 161.
    let torques = exact.torques.unwrap();
    assert!((torques[0] - 32.2).abs() < 1e-12 && (torques[1] + 16.1).abs() < 1e-12);
    let (noisy, same) = run(Some([0.01; 2]), None);
    assert_eq!((noisy.positions, same), (plain.positions, state));
    let error = noisy.velocities.unwrap()[0] - state.1[0];
    assert!(error != 0.0 && error.abs() < 0.05, "{error}");
}

/// A model whose accelerations are not finite must not hang the plant.
#[test]
fn a_model_that_breaks_down_is_reported() {
    let mut plant = ideal(Slider { mass: f64::NAN, ..SLIDER });
    let error = plant.apply(&[1.0], 0.02).unwrap_err();
    assert!(matches!(error, PlantError::Integration { time, .. } if time == 0.0), "{error}");
    assert_eq!(plant.state(), ([0.0], [0.0]));
}
