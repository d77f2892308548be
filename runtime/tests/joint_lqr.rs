//! LQR as a law of the loop: its equation, its cost on the robot itself, and the axis α in the loop.

#![allow(clippy::unwrap_used, reason = "test code")]

use gelenk_runtime::control_loop::{
    ControlLoop, End, JointGains, JointLaw, JointLqr, JointLqrError, JointPd, LawController, LoopSettings,
    LqrWeights, VirtualClock,
};
use gelenk_runtime::dynamics::{Discretizable, Dynamics};
use gelenk_runtime::feed_forward::FeedForward;
use gelenk_runtime::lqr::LqrError;
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{RestToRest, Sample, Trajectory};
use gelenk_runtime::transport::InProcess;

gelenk_runtime::dynamics!(struct Alpha = gelenk_generated::powercube_alpha);
gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);
gelenk_runtime::dynamics!(struct Quadrotor = gelenk_generated::quadrotor);

const PERIOD: f64 = 0.02;

fn weights<const N: usize>() -> LqrWeights<N, N> {
    LqrWeights::from_deviations([0.02; N], [0.2; N], [0.2; N])
}

#[test]
fn the_law_is_feed_forward_and_the_gain_of_the_deviation() {
    let law = JointLqr::new(PowerCube, &[0.1, -0.2], PERIOD, weights()).unwrap();
    let desired = RestToRest::new([0.0, 0.1], [1.0, 0.5], 2.0).unwrap().sample(0.7);
    let (y, v) = ([0.3, -0.4], [0.5, 0.6]);
    let feed_forward = FeedForward::new(PowerCube).unwrap().at(&desired).inputs;
    let x = [
        y[0] - desired.positions[0],
        y[1] - desired.positions[1],
        v[0] - desired.velocities[0],
        v[1] - desired.velocities[1],
    ];
    let inputs = law.inputs(&desired, &y, &v).unwrap();
    for (i, input) in inputs.into_iter().enumerate() {
        let gain = law.regulator().gain[i];
        let expected = feed_forward[i] + (0..4).map(|j| gain[j] * x[j]).sum::<f64>();
        assert!((input - expected).abs() < 1e-12, "{i}: {input} {expected}");
    }
}

/// The cost of small deviations that the simulated robot adds up is that of the Riccati equation.
#[test]
fn the_robot_costs_what_the_regulator_says() {
    let hover = Quadrotor.neutral();
    let weights = LqrWeights::from_deviations([1.0; 6], [1.0; 6], [3.0; 4]);
    let law = JointLqr::new(Quadrotor, &hover, PERIOD, weights).unwrap();
    let desired = Sample::at_rest(hover);
    let rest = law.inputs(&desired, &hover, &[0.0; 6]).unwrap();
    let start: [f64; 6] = core::array::from_fn(|i| 1e-4 * (i as f64 - 2.5));
    let (mut y, mut v) = (Quadrotor.integrate(&hover, &start), [0.0; 6]);
    let mut cost = 0.0;
    for _ in 0..2000 {
        let inputs = law.inputs(&desired, &y, &v).unwrap();
        let d = Quadrotor.difference(&hover, &y);
        let square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
        let change: [f64; 4] = core::array::from_fn(|i| inputs[i] - rest[i]);
        cost += square(&d) + square(&v) + square(&change) / 9.0;
        (y, v) = Quadrotor.step(&y, &v, &inputs, PERIOD);
    }
    let p = law.regulator().cost_to_go;
    let expected: f64 = (0..6).flat_map(|i| (0..6).map(move |j| start[i] * p[i][j] * start[j])).sum();
    assert!((cost - expected).abs() < 1e-3 * expected, "{cost} {expected}");
}

/// α of the paper's arm at 50 Hz, with measured positions alone: the loop finishes near its end.
#[test]
fn the_axis_alpha_finishes_in_the_loop() {
    let motion = RestToRest::new([0.0], [0.8], 2.0).unwrap();
    let law = JointLqr::new(Alpha, &[0.0], PERIOD, weights()).unwrap();
    let controller = LawController::new(law, motion, PERIOD, 0.01).unwrap();
    let settings = LoopSettings { settling_time: 1.0, ..LoopSettings::for_robot(50.0, &Alpha) };
    let mut plant = Plant::new(Alpha, PlantOptions::default()).unwrap();
    plant.reset([0.01], [0.0]).unwrap();
    let clock = VirtualClock::new();
    let robot = InProcess::new(plant, clock.clone(), settings.period());
    let fallback = JointPd::new(Alpha, JointGains::from_bandwidth(&Alpha, &[0.0], 10.0, 0.7)).unwrap();
    let mut control = ControlLoop::new(settings, fallback, motion, controller, robot, clock).unwrap();
    let report = control.run();
    assert_eq!(report.end, End::Finished, "{report}");
    assert_eq!(report.counts.controller_faults, 0, "{report}");
    let end = control.transport().plant().state().0[0];
    assert!((end - 0.8).abs() < 1e-3, "{end}");
}

#[test]
fn bad_input_is_an_error() {
    let error = |positions, period, weights| {
        JointLqr::new(Alpha, &[positions], period, weights).unwrap_err().to_string()
    };
    let good = weights();
    assert_eq!(error(0.0, 0.0, good), "setting period of the loop is 0, but must be positive and finite");
    let zero = LqrWeights { input: [0.0], ..good };
    assert_eq!(
        error(0.0, PERIOD, zero),
        "setting weights.input[alpha] of the loop is 0, but must be finite and positive"
    );
    let nan = LqrWeights { velocity: [f64::NAN], ..good };
    assert_eq!(
        error(0.0, PERIOD, nan),
        "setting weights.velocity[alpha] of the loop is NaN, but must be finite and not negative"
    );
    assert_eq!(
        error(f64::NAN, PERIOD, good),
        "the robot cannot be linearized at the given positions: the state or the equations of motion are not finite"
    );
    // A pole at 1 without a cost.
    let free = LqrWeights { position: [0.0], velocity: [0.0], ..good };
    let error = JointLqr::new(Alpha, &[0.0], PERIOD, free).unwrap_err();
    assert!(matches!(error, JointLqrError::Regulator(LqrError::NotStabilizable(_))), "{error}");
    let upright = LqrWeights::from_deviations([1.0; 6], [1.0; 6], [1.0; 4]);
    let error = JointLqr::new(Quadrotor, &[0.0; 7], PERIOD, upright).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("the positions for the linearization are not valid: the quaternion of joint"),
        "{error}"
    );
}
