//! A quaternion between other entries: limits, rows, encoders and errors find the right ones.

use super::{Mixed, mixed};
use gelenk_kernels::manifold;
use gelenk_runtime::control_loop::{
    AccelerationGains, ComputedTorque, ControlLoop, End, JointGains, JointLaw, JointPd, LoopSettings,
    VirtualClock,
};
use gelenk_runtime::dynamics::{Differentiable, Discretizable, Dynamics};
use gelenk_runtime::feed_forward::FeedForward;
use gelenk_runtime::mpc::{LtvMpc, MpcNote, MpcOptions, MpcRow, Nmpc};
use gelenk_runtime::plant::{Plant, PlantError, PlantOptions};
use gelenk_runtime::trajectory::{GeodesicMotion, Trajectory};
use gelenk_runtime::transport::InProcess;

type Motion = GeodesicMotion<Mixed, 5, 5, 6>;

const PERIOD: f64 = 0.02;
const START: [f64; 6] = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
const GOAL: [f64; 6] = [0.4, 0.48, 0.0, 0.64, 0.6, 1.0];

fn motion() -> Motion {
    Motion::between(Mixed, START, GOAL, 1.5).unwrap()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Without functions over a sample time of its own the linearization is discretized with D.
#[test]
fn what_the_module_lacks_is_made_of_the_rest() {
    let (y, v, u) = (GOAL, [0.5, 1.0, -2.0, 0.5, 1.0], [1.0, 0.1, 0.2, 0.3, 0.4]);
    let discrete = Mixed.discretize(&y, &v, &u, 1e-3);
    let step = Mixed.step_derivatives(&y, &v, &u, 1e-3);
    let (way, next) = discrete.displaced(&[0.0; 5], &v, &u);
    assert!(distance(&next, &step.velocities) < 1e-7);
    assert!(distance(&Mixed.difference(&step.coordinates, &Mixed.integrate(&y, &way)), &[0.0; 5]) < 1e-9);
    for (found, exact) in discrete.state.as_flattened().iter().zip(step.state.as_flattened()) {
        assert!(distance(found.as_flattened(), exact.as_flattened()) < 1e-4);
    }
    assert_eq!(Mixed.drift(&v)[1], [0.0, 0.0, 0.5, 2.0, 0.0]);
}

#[test]
fn feed_forward_makes_it_follow() {
    let (motion, feed_forward) = (motion(), FeedForward::new(Mixed).unwrap());
    let mut state = (START, [0.0; 5]);
    let h = 1e-3;
    for k in 0..1500 {
        let inputs = feed_forward.at(&motion.sample((f64::from(k) + 0.5) * h)).inputs;
        state = Mixed.step(&state.0, &state.1, &inputs, h);
    }
    let error = Mixed.difference(&state.0, &GOAL);
    assert!(distance(&error, &[0.0; 5]) < 1e-5, "{error:?}");
}

#[test]
fn encoders_round_the_entries_that_they_belong_to() {
    let encoder_resolution = [0.25, 0.0, 0.0, 0.0, 0.5];
    let options = PlantOptions { encoder_resolution, ..PlantOptions::default() };
    let mut plant = Plant::new(Mixed, options).unwrap();
    let start = [0.4, 0.48, 0.0, 0.64, 0.6, 0.9];
    plant.reset(start, [0.0; 5]).unwrap();
    let measured = plant.measure().positions;
    assert_eq!((measured[0], measured[5]), (0.5, 1.0));
    assert!(distance(&measured[1..5], &start[1..5]) < 1e-15);
    let mut bad = start;
    bad[5] = f64::NAN;
    let error = plant.reset(bad, [0.0; 5]).unwrap_err();
    assert!(matches!(error, PlantError::Start { name: "pendulum", coordinate: 4, .. }), "{error}");
}

#[test]
fn limits_and_rows_of_other_joints_hold() {
    // Beyond the slide's limit of 0.5 and the pendulum's row.
    let far = Motion::between(Mixed, START, [0.7, 0.48, 0.0, 0.64, 0.6, 1.0], 1.0).unwrap();
    let row = MpcRow::new("both", [1.0, 0.0, 0.0, 0.0, 1.0], [0.0; 5], [0.0; 5], [-9.0, 1.2]);
    let options = MpcOptions::new(&Mixed, PERIOD, 12).with_rows([row]);
    let mut ltv = LtvMpc::new(Mixed, far.clone(), options.clone()).unwrap();
    let notes = ltv.notes();
    let of_slide = |note: &MpcNote| matches!(note, MpcNote::Position { joint: "slide", .. });
    let of_row = |note: &MpcNote| matches!(note, MpcNote::Row { row: "both", .. });
    assert!(notes.iter().any(of_slide) && notes.iter().any(of_row), "{notes:?}");
    let mut nonlinear = Nmpc::new(Mixed, far, options).unwrap();
    for end in [follow(&mut ltv), follow(&mut nonlinear)] {
        assert!(end[0] < 0.51 && end[0] + end[5] < 1.22, "{end:?}");
        assert!(distance(&Mixed.difference(&end, &GOAL)[1..4], &[0.0; 3]) < 2e-3, "{end:?}");
    }
}

/// The positions after two seconds.
fn follow(controller: &mut impl gelenk_runtime::control_loop::Controller<5, 5, 6>) -> [f64; 6] {
    let mut plant = Plant::new(Mixed, PlantOptions::default()).unwrap();
    plant.reset(START, [0.0; 5]).unwrap();
    controller.reset(&START, &[0.0; 5]);
    let mut last_inputs = [0.0; 5];
    for k in 0..100 {
        let cycle = gelenk_runtime::control_loop::Cycle {
            time: PERIOD * f64::from(k),
            periods: u32::from(k > 0),
            positions: Some(plant.measure().positions),
            last_inputs,
            ..gelenk_runtime::control_loop::Cycle::default()
        };
        last_inputs = controller.step(&cycle).unwrap().inputs;
        plant.apply(&last_inputs, PERIOD).unwrap();
    }
    plant.state().0
}

/// Joint PD in the loop, limits of the other joints included.
#[test]
fn the_loop_follows_by_joint_pd() {
    let clock = VirtualClock::new();
    let law = JointPd::new(Mixed, JointGains::from_bandwidth(&Mixed, &START, 20.0, 1.0)).unwrap();
    let controller =
        gelenk_runtime::control_loop::FeedForwardPd::new(law.clone(), motion(), PERIOD, 0.01).unwrap();
    let settings = LoopSettings { warm_up: 0.0, ..LoopSettings::for_robot(1.0 / PERIOD, &Mixed) };
    let mut plant = Plant::new(Mixed, PlantOptions::default()).unwrap();
    plant.reset(START, [0.0; 5]).unwrap();
    let robot = InProcess::new(plant, clock.clone(), settings.period());
    let mut control = ControlLoop::new(settings, law, motion(), controller, robot, clock).unwrap();
    let report = control.run();
    assert_eq!(report.end, End::Finished, "{report}");
    let (y, _) = control.transport().plant().state();
    assert!(distance(&Mixed.difference(&y, &GOAL), &[0.0; 5]) < 5e-3, "{y:?}");
}

/// Error of `ë + 2 ζ ω ė + ω² e = 0` from e = 1 at rest.
fn decayed(omega: f64, damping: f64, t: f64) -> f64 {
    let damped = omega * (1.0 - damping * damping).sqrt();
    (-damping * omega * t).exp() * ((damped * t).cos() + damping * omega / damped * (damped * t).sin())
}

/// Largest distance between errors under computed torque and their closed form; held inputs are late by half a period.
fn deviation_under_computed_torque(period: f64) -> f64 {
    let (motion, (omega, damping)) = (motion(), (6.0, 0.6));
    let law = ComputedTorque::new(Mixed, AccelerationGains::from_bandwidth(omega, damping)).unwrap();
    let mut plant = Plant::new(Mixed, PlantOptions::default()).unwrap();
    // More than two radians about an oblique axis.
    let beside = [0.1, 1.2, -0.9, 1.5, -0.4];
    plant.reset(Mixed.integrate(&START, &beside.map(|e| -e)), [0.0; 5]).unwrap();
    let mut worst = 0.0_f64;
    for k in 0..(1.2 / period) as u32 {
        let (y, v) = plant.state();
        let inputs = law.inputs(&motion.sample(f64::from(k) * period), &y, &v).unwrap();
        plant.apply(&inputs, period).unwrap();
        let t = f64::from(k + 1) * period;
        let error = Mixed.difference(&plant.state().0, &motion.sample(t).positions);
        worst = worst.max(distance(&error, &beside.map(|e| e * decayed(omega, damping, t))));
    }
    worst
}

#[test]
fn attitudes_decay_under_computed_torque_as_the_gains_say() {
    let (coarse, fine) = (deviation_under_computed_torque(2e-4), deviation_under_computed_torque(1e-4));
    let ratio = coarse / fine;
    assert!(fine < 2e-3 && (1.8..2.2).contains(&ratio), "{coarse} {fine}");
}

/// Its own sign of the bracket is that of the kernels.
#[test]
fn the_drift_by_hand_is_that_of_the_bracket() {
    let v = [0.1, 0.2, -0.3, 0.4, 0.5];
    let (.., drift) = mixed::linearize(&[0.0, 0.0, 0.0, 0.0, 1.0, 0.0], &v, &[0.0; mixed::M]);
    for j in 0..mixed::N {
        let mut unit = [0.0; mixed::N];
        unit[j] = 1.0;
        let column = manifold::bracket(&mixed::JOINT_POSITIONS, &v, &unit);
        assert!((0..mixed::N).all(|i| drift[i][j] == -column[i]));
    }
}
