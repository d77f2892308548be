//! Robots with driven joints in motion, against the whole robot: with the rail as a coordinate of its own, on which at
//! every time the force acts that accelerates it as prescribed.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::path::Path;

use gelenk_codegen::model;
use gelenk_codegen::read::{self, ReadOptions};
use gelenk_runtime::driven::DrivenRobot;
use gelenk_runtime::dynamics::{Differentiable, Discretizable, Dynamics};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{RestToRest, Trajectory};
use gelenk_tests::{Robot, relative_error, workspace};

gelenk_runtime::dynamics!(struct RailArm { driven } = gelenk_generated::rail_arm);

/// Positions and velocities of rail, shoulder and elbow.
type State = [f64; 6];

const START: [f64; 2] = [0.4, -0.3];
const INPUTS: [f64; 2] = [0.15, -0.1];
const SECONDS: f64 = 1.5;

fn rail() -> RestToRest<1> {
    RestToRest::new([-0.5], [0.5], 1.2).expect("a motion")
}

/// The same robot whose rail is a coordinate with a drive.
fn whole_robot() -> Robot {
    let file = workspace().join("models/rail_arm.toml");
    let text = std::fs::read_to_string(&file).expect("the description");
    let free = text.replace("motion = \"driven\"", "drive = \"ideal\"");
    assert_ne!(text, free, "the rail is driven");
    let folder = tempfile::tempdir().expect("a folder");
    let whole = folder.path().join("rail_arm.toml");
    std::fs::write(&whole, free).expect("written");
    Robot::of_model(read(&whole), &["forward_dynamics"])
}

fn read(file: &Path) -> model::Model {
    read::read(file, &ReadOptions::default()).unwrap_or_else(|problems| panic!("{problems}")).model
}

/// ẋ with the rail's acceleration as prescribed. Accelerations are affine in the rail's force, so that two of them give
/// the force that the rail needs.
fn rates(robot: &Robot, time: f64, x: &State) -> State {
    let [prescribed] = rail().sample(time).accelerations;
    let accelerations =
        |force: f64| robot.first("forward_dynamics", &[&x[..3], &x[3..], &[force, INPUTS[0], INPUTS[1]]]);
    let (idle, pushed) = (accelerations(0.0), accelerations(1e3));
    let force = 1e3 * (prescribed - idle[0]) / (pushed[0] - idle[0]);
    let moved = accelerations(force);
    [x[3], x[4], x[5], moved[0], moved[1], moved[2]]
}

fn advanced(x: &State, factor: f64, rate: &State) -> State {
    std::array::from_fn(|i| x[i] + factor * rate[i])
}

/// The whole robot after `seconds`, by the classical Runge–Kutta method; friction that changes within milliseconds as a
/// joint turns round needs short steps.
fn forced(robot: &Robot, seconds: f64, steps: usize) -> State {
    let h = seconds / steps as f64;
    let mut x = [-0.5, START[0], START[1], 0.0, 0.0, 0.0];
    for k in 0..steps {
        let t = k as f64 * h;
        let a = rates(robot, t, &x);
        let b = rates(robot, t + h / 2.0, &advanced(&x, h / 2.0, &a));
        let c = rates(robot, t + h / 2.0, &advanced(&x, h / 2.0, &b));
        let d = rates(robot, t + h, &advanced(&x, h, &c));
        for (rate, share) in [(a, 6.0), (b, 3.0), (c, 3.0), (d, 6.0)] {
            x = advanced(&x, h / share, &rate);
        }
    }
    x
}

#[test]
fn the_plant_moves_as_the_whole_robot_whose_rail_is_forced() {
    let robot = whole_robot();
    let expected = forced(&robot, SECONDS, 12_000);
    let [position] = rail().sample(SECONDS).positions;
    assert!((expected[0] - position).abs() < 1e-9, "the rail of the whole robot moves as prescribed");
    let options =
        PlantOptions { relative_tolerance: 1e-11, absolute_tolerance: 1e-11, ..PlantOptions::default() };
    let mut plant =
        Plant::new(DrivenRobot::new(RailArm::default(), rail()), options.clone()).expect("a plant");
    plant.reset(START, [0.0; 2]).expect("a state");
    for _ in 0..75 {
        plant.apply(&INPUTS, SECONDS / 75.0).expect("it moves");
    }
    let (y, v) = plant.state();
    let error =
        relative_error(&[y[0], y[1], v[0], v[1]], &[expected[1], expected[2], expected[4], expected[5]]);
    println!("error after {SECONDS} s: {error:.1e}");
    assert!(error < 1e-8, "{error:e}");
    // The rail's motion matters: at rest the arm ends elsewhere.
    let mut resting = Plant::new(RailArm { driven: [[-0.5, 0.0, 0.0]] }, options).expect("a plant");
    resting.reset(START, [0.0; 2]).expect("a state");
    resting.apply(&INPUTS, SECONDS).expect("it moves");
    assert!((resting.state().0[0] - y[0]).abs() > 0.1);
}

/// From 0.2 s on, for 0.3 s in which no joint turns round.
fn stepped(steps: u32) -> [f64; 4] {
    let robot = DrivenRobot::new(RailArm::default(), rail());
    let (mut y, mut v, h) = (START, [1.5, -4.0], 0.3 / f64::from(steps));
    for k in 0..steps {
        (y, v) = robot.at_time(0.2 + f64::from(k) * h, |robot| robot.step(&y, &v, &INPUTS, h));
        assert!(v[0] > 0.3 && v[1] < -0.3, "{v:?}");
    }
    [y[0], y[1], v[0], v[1]]
}

/// Stages at wrong times would leave order 1.
#[test]
fn steps_have_order_four_in_the_prescribed_motion_too() {
    let exact = stepped(2048);
    let errors = [8, 16, 32].map(|steps| relative_error(&stepped(steps), &exact));
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((3.6..4.6).contains(&order), "order {order} of {errors:?}");
    }
}

#[test]
fn sensitivities_are_those_of_the_steps() {
    let robot = DrivenRobot::new(RailArm::default(), rail()).at(0.3);
    let (y, v, period) = ([0.3, -0.6], [0.8, -1.1], 0.02);
    let step = robot.step_derivatives(&y, &v, &INPUTS, period);
    let (positions, velocities) = robot.step(&y, &v, &INPUTS, period);
    let both = |y: &[f64; 2], v: &[f64; 2]| [y[0], y[1], v[0], v[1]];
    assert!(
        relative_error(&both(&step.coordinates, &step.velocities), &both(&positions, &velocities)) < 1e-13
    );
    for j in 0..4 {
        let h = 1e-5;
        let [less, more] = [-h, h].map(|h| {
            let (mut y, mut v) = (y, v);
            if j < 2 {
                y[j] += h
            } else {
                v[j - 2] += h
            }
            let (y, v) = robot.step(&y, &v, &INPUTS, period);
            both(&y, &v)
        });
        let quotient: [f64; 4] = std::array::from_fn(|i| (more[i] - less[i]) / (2.0 * h));
        let column: [f64; 4] = std::array::from_fn(|i| step.state[i / 2][j / 2][i % 2][j % 2]);
        assert!(relative_error(&column, &quotient) < 1e-8, "{j}: {column:?} {quotient:?}");
    }
    let linear = robot.linearize(&y, &v, &INPUTS);
    let direct = RailArm { driven: robot.driven_at(0.3) }.forward_dynamics(&y, &v, &INPUTS);
    assert!(relative_error(&linear.accelerations(&y, &v, &INPUTS), &direct) < 1e-11);
}
