//! The simulated robot on the manifold.

use super::{Quadrotor, quadrotor};
use gelenk_runtime::dynamics::{Discretizable, Dynamics};
use gelenk_runtime::plant::{Plant, PlantOptions};

const START: [f64; 7] = [0.0, 0.5, 1.0, 0.5, -0.5, 0.5, 0.5];
const THROWN: [f64; 6] = [1.0, -0.5, 2.0, 6.0, -9.0, 3.0];

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn plant(options: PlantOptions<6, 4>) -> Plant<Quadrotor, 6, 4, 7> {
    let mut plant = Plant::new(Quadrotor, options).unwrap();
    plant.reset(START, THROWN).unwrap();
    plant
}

/// Angular momentum in the base's axes, and energy.
fn invariants((y, v): &([f64; 7], [f64; 6])) -> [f64; 4] {
    let [x, b, c, d] = [y[3], y[4], y[5], y[6]];
    let axes = [
        [1.0 - 2.0 * (b * b + c * c), 2.0 * (x * b - c * d), 2.0 * (x * c + b * d)],
        [2.0 * (x * b + c * d), 1.0 - 2.0 * (x * x + c * c), 2.0 * (b * c - x * d)],
        [2.0 * (x * c - b * d), 2.0 * (b * c + x * d), 1.0 - 2.0 * (x * x + b * b)],
    ];
    let momentum = axes.map(|row| (0..3).map(|i| row[i] * quadrotor::INERTIA[i] * v[i + 3]).sum::<f64>());
    let energy = Quadrotor.kinetic_energy(y, v) + quadrotor::MASS * 9.81 * y[2];
    [momentum[0], momentum[1], momentum[2], energy]
}

/// Thrown up, it turns freely and falls on a parabola; several turns pass.
#[test]
fn a_thrown_body_keeps_momentum_and_energy() {
    let mut plant = plant(PlantOptions::default());
    let before = invariants(&plant.state());
    let mut length = 0.0_f64;
    for _ in 0..100 {
        plant.apply(&[0.0; 4], 0.02).unwrap();
        let (y, _) = plant.state();
        length = length.max((y[3..].iter().map(|q| q * q).sum::<f64>() - 1.0).abs());
    }
    assert!(length <= 1e-15, "{length:e}");
    let after = invariants(&plant.state());
    assert!(distance(&before, &after) <= 1e-8, "{before:?} became {after:?}");
    // The velocity is given in the body's axes: with this attitude they are the base's, one turned on.
    let rise = Quadrotor.integrate(&START, &[1.0, -0.5, 2.0, 0.0, 0.0, 0.0])[2] - START[2];
    let height = START[2] + 2.0 * rise - 0.5 * 9.81 * 4.0;
    assert!((plant.state().0[2] - height).abs() <= 1e-8, "{}", plant.state().0[2]);
}

/// Against steps of the method on the manifold, which shares nothing with the integrator's quaternions.
#[test]
fn the_plant_moves_as_the_steps_do() {
    let mut plant = plant(PlantOptions::default());
    let inputs = [3.0, 4.0, 3.7, 3.9];
    plant.apply(&inputs, 0.5).unwrap();
    let mut state = (START, THROWN);
    for _ in 0..5000 {
        state = Quadrotor.step(&state.0, &state.1, &inputs, 1e-4);
    }
    let (y, v) = plant.state();
    assert!(distance(&Quadrotor.difference(&state.0, &y), &[0.0; 6]) <= 1e-9);
    assert!(distance(&state.1, &v) <= 1e-8);
}

/// Noise moves what is measured along ⊕: it stays an attitude, as far off as the options say.
#[test]
fn measured_attitudes_are_attitudes() {
    let options = PlantOptions { encoder_noise: [1e-3; 6], seed: 5, ..PlantOptions::default() };
    let mut plant = plant(options);
    let (mut square, count) = ([0.0; 6], 400);
    for _ in 0..count {
        plant.apply(&[0.0; 4], 1e-3).unwrap();
        let measured = plant.measure().positions;
        assert!(Quadrotor.check_attitudes(&measured).is_ok());
        let error = Quadrotor.difference(&plant.state().0, &measured);
        (0..6).for_each(|i| square[i] += error[i] * error[i]);
    }
    for square in square {
        let deviation = (square / f64::from(count)).sqrt();
        assert!((0.9e-3..1.1e-3).contains(&deviation), "{deviation}");
    }
}

#[test]
fn starts_that_are_no_states_are_refused_by_name() {
    let mut plant = plant(PlantOptions::default());
    let mut refused = |y: [f64; 7], v: [f64; 6]| plant.reset(y, v).unwrap_err().to_string();
    let zero = refused([0.0; 7], THROWN);
    assert_eq!(
        zero,
        "the plant cannot start: the quaternion of joint base, x 0 y 0 z 0 w 0, is zero, so it is not an attitude"
    );
    let long = refused([0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0], THROWN);
    assert!(long.contains("joint base") && long.contains("length 2"), "{long}");
    let nan = refused([0.0, 0.0, 0.0, f64::NAN, 0.0, 0.0, 1.0], THROWN);
    assert!(nan.contains("joint base") && nan.contains("not finite"), "{nan}");
    let far = refused([0.0, f64::INFINITY, 0.0, 0.0, 0.0, 0.0, 1.0], THROWN);
    assert_eq!(far, r#"position "base y" cannot start at inf: it must be finite"#);
    assert!(refused(START, [f64::NAN; 6]).contains("base vx"));
    // Nothing of this moved it.
    assert_eq!(plant.state(), (START, THROWN));
}

#[test]
fn encoder_steps_and_brakes_of_attitudes_are_refused() {
    let mut encoder_resolution = [0.0; 6];
    encoder_resolution[4] = 1e-3;
    let options = PlantOptions { encoder_resolution, ..PlantOptions::default() };
    let error = Plant::new(Quadrotor, options).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("encoder_resolution") && error.contains("base wy"), "{error}");
    let options = PlantOptions { brake_torque: Some([1.0; 6]), ..PlantOptions::default() };
    let error = Plant::new(Quadrotor, options).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("brake_torque") && error.contains("quaternion"), "{error}");
}
