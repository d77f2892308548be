//! Inputs at frames in the runtime: an excavator is controlled in the forces of its cylinders.

#![allow(clippy::unwrap_used, reason = "test code")]

use gelenk_generated::excavator::{DRIVES, INPUT_RANGES};
use gelenk_runtime::control_loop::{
    AccelerationGains, ComputedTorque, Controller, Cycle, LawController, LoopSettings,
};
use gelenk_runtime::dynamics::{Dynamics, Limits};
use gelenk_runtime::feed_forward::FeedForward;
use gelenk_runtime::mpc::{LtvMpc, MpcOptions, Nmpc};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{RestToRest, Sample, Trajectory};

gelenk_runtime::dynamics!(struct Excavator = gelenk_generated::excavator);
gelenk_runtime::dynamics!(struct BalancedArm = gelenk_generated::balanced_arm);

const PERIOD: f64 = 0.01;
const START: [f64; 4] = [0.0, -0.2, 1.2, 0.6];
const GOAL: [f64; 4] = [0.5, -0.6, 1.8, 1.2];

fn motion() -> RestToRest<4> {
    RestToRest::new(START, GOAL, 3.0).unwrap()
}

/// Runs a controller on the excavator: the largest errors of position [rad] on the way and at the end, and how far
/// inputs left their ranges.
fn follow(controller: &mut impl Controller<4, 4>, motion: &impl Trajectory<4>) -> [f64; 3] {
    let mut plant = Plant::new(Excavator, PlantOptions::default()).unwrap();
    let start = motion.sample(0.0).positions;
    plant.reset(start, [0.0; 4]).unwrap();
    controller.reset(&start, &[0.0; 4]);
    let (mut last_inputs, mut error, mut beyond) = ([0.0; 4], 0.0_f64, f64::NEG_INFINITY);
    for k in 0..((motion.duration() + 1.0) / PERIOD) as u32 {
        let time = PERIOD * f64::from(k);
        let cycle = Cycle {
            time,
            periods: u32::from(k > 0),
            positions: Some(plant.measure().positions),
            last_inputs,
            ..Cycle::default()
        };
        let u = controller.step(&cycle).unwrap().inputs;
        for (u, [low, high]) in u.iter().zip(INPUT_RANGES) {
            beyond = beyond.max(low - u).max(u - high);
        }
        error = error.max(distance(&plant.state().0, &motion.sample(time).positions));
        last_inputs = u;
        plant.apply(&u, PERIOD).unwrap();
    }
    [error, distance(&plant.state().0, &motion.sample(f64::INFINITY).positions), beyond]
}

fn distance(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn an_excavator_is_tracked_by_predictive_control_in_cylinder_forces() {
    let mut linear = LtvMpc::new(Excavator, motion(), MpcOptions::new(&Excavator, PERIOD, 15)).unwrap();
    let mut nonlinear = Nmpc::new(Excavator, motion(), MpcOptions::new(&Excavator, PERIOD, 15)).unwrap();
    for [error, end, beyond] in [follow(&mut linear, &motion()), follow(&mut nonlinear, &motion())] {
        println!("{error} {end} {beyond}");
        assert!(error < 0.02 && end < 2e-3 && beyond <= 1e-9, "{error} {end} {beyond}");
    }
}

/// A cylinder that would have to push with more than it can: the range is kept, and the motion ends late.
#[test]
fn ranges_that_are_not_symmetric_are_kept_by_predictive_control() {
    let options = MpcOptions::new(&Excavator, PERIOD, 15);
    assert_eq!(options.input_limits, INPUT_RANGES);
    let fast = RestToRest::new(START, GOAL, 0.6).unwrap();
    let mut controller = LtvMpc::new(Excavator, fast, options).unwrap();
    let [error, _, beyond] = follow(&mut controller, &fast);
    println!("{error} {beyond}");
    assert!(beyond > -1e-3 && beyond <= 1e-9, "a limit is reached: {beyond}");
}

#[test]
fn computed_torque_inverts_b_at_each_position() {
    let law = ComputedTorque::new(Excavator, AccelerationGains::from_bandwidth(15.0, 1.0)).unwrap();
    let mut controller = LawController::new(law, motion(), PERIOD, PERIOD).unwrap();
    let [error, end, _] = follow(&mut controller, &motion());
    println!("{error} {end}");
    assert!(error < 0.02 && end < 2e-3, "{error} {end}");
}

/// The feed-forward satisfies M ÿ + k − q = B(y) u at every sample.
#[test]
fn the_feed_forward_makes_the_forces_of_the_motion() {
    let feed_forward = FeedForward::new(Excavator).unwrap();
    for k in 0..=30 {
        let sample = motion().sample(0.1 * f64::from(k));
        let Sample { positions: y, velocities: v, accelerations: a, .. } = sample;
        let made = feed_forward.at(&sample);
        let reached = Excavator.forward_dynamics(&y, &v, &made.inputs);
        assert!(distance(&reached, &a) < 1e-9, "{reached:?} {a:?}");
        assert!(made.residual.iter().all(|missed| missed.abs() < 1e-9), "{:?}", made.residual);
    }
}

#[test]
fn limits_of_inputs_at_frames_reach_loop_and_drives_keep_theirs() {
    assert_eq!((DRIVES, Excavator.drives()), (1, 1));
    let settings = LoopSettings::for_robot(100.0, &Excavator);
    assert_eq!(settings.input_limits, INPUT_RANGES);
    assert_eq!(Excavator.input_limits().nominal[0], [-90.0, 90.0]);
    assert_eq!(Excavator.input_limits().peak[1], [-60e3, 35e3]);
    // B of a robot whose inputs all are drives stays a constant.
    assert_eq!((BalancedArm.drives(), BalancedArm.drive_matrix()), (2, [[80.0, 0.0], [0.0, 60.0]]));
    assert_eq!(Excavator.drive_matrix()[1], [0.0; 4]);
}

/// The gas spring carries most of the arm's weight.
#[test]
fn a_gas_spring_unloads_the_shoulder() {
    let load = |springs: bool, y: f64| {
        let (position, still) = ([y, 0.3], [0.0; 2]);
        let gravity = BalancedArm.gravity_forces(&position)[0];
        gravity + if springs { BalancedArm.spring_forces(&position, &still)[0] } else { 0.0 }
    };
    for y in [0.6, 1.0, 1.4] {
        assert!(load(true, y).abs() < 0.6 * load(false, y).abs(), "{} {}", load(true, y), load(false, y));
    }
}

/// A rod that has no direction at y = 0, which its limits exclude.
struct Rod;

impl Dynamics<1, 1> for Rod {
    fn limits(&self) -> Limits<1, 1> {
        Limits {
            position: [[0.5, 1.5]],
            velocity: [1.0],
            effort: [f64::INFINITY],
            peak_effort: [f64::INFINITY],
            input: [[-1.0, 1.0]],
            peak_input: [[-1.0, 1.0]],
            dependent: &[],
            torque_speed: &[],
        }
    }
    fn mass_matrix(&self, _: &[f64; 1]) -> [[f64; 1]; 1] {
        [[1.0]]
    }
    fn coriolis_forces(&self, _: &[f64; 1], _: &[f64; 1]) -> [f64; 1] {
        [0.0]
    }
    fn gravity_forces(&self, _: &[f64; 1]) -> [f64; 1] {
        [0.0]
    }
    fn spring_forces(&self, _: &[f64; 1], _: &[f64; 1]) -> [f64; 1] {
        [0.0]
    }
    fn friction_torques(&self, _: &[f64; 1], _: &[f64; 1]) -> [f64; 1] {
        [0.0]
    }
    fn friction_jumps(&self) -> &'static [[usize; 2]] {
        &[]
    }
    fn input_matrix(&self, y: &[f64; 1]) -> [[f64; 1]; 1] {
        [[1.0 / y[0]]]
    }
    fn drives(&self) -> usize {
        0
    }
}

#[test]
fn inputs_are_judged_within_the_limits() {
    let feed_forward = FeedForward::new(Rod).unwrap();
    assert_eq!(feed_forward.inputs_for(&[0.5], &[3.0]), [1.5]);
    assert!(feed_forward.inputs_for(&[0.0], &[3.0])[0].is_nan());
    assert!(ComputedTorque::new(Rod, AccelerationGains::from_bandwidth(1.0, 1.0)).is_ok());
    assert_eq!(Rod.input_limits().peak, [[-1.0, 1.0]]);
}
