//! Torque–speed lines that a description gives to motors: predictive controllers keep them without a word of the user, the loop and
//! plants cut off what is beyond them, checks of trajectories tell of it.

#![allow(clippy::unwrap_used, reason = "test code")]

use gelenk_runtime::control_loop::{
    ControlLoop, Controller, Cycle, JointGains, JointPd, LawController, LoopSettings, VirtualClock,
};
use gelenk_runtime::driven::DrivenRobot;
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::feed_forward::FeedForward;
use gelenk_runtime::limits::{Quantity, Rating, violations};
use gelenk_runtime::mpc::{LtvMpc, MpcError, MpcNote, MpcOptions, MpcRow, Nmpc, RowKind};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{RestToRest, Trajectory};
use gelenk_runtime::transport::InProcess;

gelenk_runtime::dynamics!(struct Wrist = gelenk_generated::differential_wrist);

/// A wrist that has a speed limit of a motor and its torque–speed line, and a joint that follows with its name.
mod crowded_wrist {
    pub use gelenk_generated::differential_wrist::*;
    pub const DEPENDENT_JOINT_NAMES: [&str; 1] = ["left_motor"];
    pub const DEPENDENT_JOINT_RATIOS: [[f64; N]; 1] = [[0.0, 0.0, 1.0, 1.0]];
    pub const DEPENDENT_JOINT_OFFSETS: [f64; 1] = [0.0];
    pub const DEPENDENT_POSITION_LIMITS: [[f64; 2]; 1] = [[f64::NEG_INFINITY, 2.0]];
    pub const DEPENDENT_VELOCITY_LIMITS: [f64; 1] = [6.0];
}
gelenk_runtime::dynamics!(struct CrowdedWrist = crowded_wrist);

/// The arm on rails, whose shoulder has a motor that is weak at speed.
mod weak_rail_arm {
    pub use gelenk_generated::rail_arm::*;
    pub const TORQUE_SPEED_SLOPES: [[f64; N]; M] = [[2.0, 0.0], [0.0, 0.0]];
    pub const TORQUE_SPEED_LIMITS: [f64; M] = [60.0, f64::INFINITY];
}
gelenk_runtime::dynamics!(struct RailArm { driven } = weak_rail_arm);

const PERIOD: f64 = 0.01;
const START: [f64; 4] = [0.2, 0.6, -1.2, -1.2];
const GOAL: [f64; 4] = [0.2, 0.6, 1.2, 1.2];
/// Described motors: torque at rest, and the joints' speed without load, seen through the gear.
const STALL: f64 = 0.24;
const SLOPE: f64 = 80.0 * 0.24 / 600.0;

/// At its fastest 3.9 rad/s of pitch and of roll: 626 rad/s of the left motor, which turns at 600 rad/s without load.
fn motion() -> RestToRest<4> {
    RestToRest::new(START, GOAL, 1.15).unwrap()
}

/// How far the motors are beyond their lines, by the numbers of the description.
fn beyond(v: &[f64; 4], u: &[f64; 4]) -> f64 {
    let [left, right] = [u[2] + SLOPE * (v[2] + v[3]), u[3] + SLOPE * (v[2] - v[3])];
    left.abs().max(right.abs()) - STALL
}

/// The largest excess at the start of a period, by the estimate and in truth, and the final error.
fn run(controller: &mut (impl Controller<4, 4> + ?Sized)) -> [f64; 3] {
    let mut plant = Plant::new(Wrist, PlantOptions::default()).unwrap();
    plant.reset(START, [0.0; 4]).unwrap();
    controller.reset(&START, &[0.0; 4]);
    let (mut last_inputs, mut shown) = ([0.0; 4], [f64::NEG_INFINITY; 2]);
    for k in 0..(2.0 * motion().duration() / PERIOD) as u32 {
        let cycle = Cycle {
            time: PERIOD * f64::from(k),
            periods: u32::from(k > 0),
            positions: Some(plant.measure().positions),
            last_inputs,
            ..Cycle::default()
        };
        let (_, v) = plant.state();
        last_inputs = controller.step(&cycle).unwrap().inputs;
        let estimated = controller.estimate().unwrap().velocities;
        shown = [shown[0].max(beyond(&estimated, &last_inputs)), shown[1].max(beyond(&v, &last_inputs))];
        plant.apply(&last_inputs, PERIOD).unwrap();
    }
    let (y, _) = plant.state();
    let error = (0..4).map(|i| (y[i] - GOAL[i]).abs()).fold(0.0, f64::max);
    [shown[0], shown[1], error]
}

#[test]
fn predictive_controllers_keep_them_without_being_told() {
    let options = || MpcOptions::new(&Wrist, PERIOD, 15);
    let names = options().rows.map(|row| (row.name, row.kind));
    assert_eq!(names, [("left_motor", RowKind::Hard), ("right_motor", RowKind::Hard)]);
    let linear = LtvMpc::new(Wrist, motion(), options()).unwrap();
    assert!(linear.notes().iter().any(|note| matches!(note, MpcNote::Row { row: "left_motor", .. })));
    let nonlinear = Nmpc::new(Wrist, motion(), options()).unwrap();
    let controllers: [Box<dyn Controller<4, 4>>; 2] = [Box::new(linear), Box::new(nonlinear)];
    for mut controller in controllers {
        let [estimated, true_one, error] = run(&mut *controller);
        println!("{estimated:.3e} {true_one:.3e} {error:.3e}");
        assert!(estimated > -1e-6 && estimated < 1e-9, "the line is reached, and kept: {estimated}");
        assert!(true_one < 0.01 * STALL && error < 5e-3, "{true_one} {error}");
    }
    // Without the lines more is asked than the motors give.
    let free = options().rows.map(|row| MpcRow { lower: f64::NEG_INFINITY, upper: f64::INFINITY, ..row });
    let mut without = LtvMpc::new(Wrist, motion(), options().with_rows(free)).unwrap();
    let [_, true_one, _] = run(&mut without);
    assert!(true_one > 0.02 * STALL, "{true_one}");
}

/// Nobody leaves a line out without knowing.
#[test]
fn a_controller_without_the_rows_is_refused() {
    let options = || MpcOptions::new(&Wrist, PERIOD, 15);
    let [left, right] = MpcRow::of_limits(&Wrist);
    let refused = |rows| LtvMpc::new(Wrist, motion(), options().with_rows(rows)).unwrap_err();
    let error = refused([left]);
    assert_eq!(error, MpcError::TorqueSpeed { motor: "right_motor" });
    assert!(error.to_string().contains("`.with_rows(MpcRow::of_limits(&robot))`"), "{error}");
    // Of its name, and of another input.
    assert_eq!(
        refused([MpcRow { name: "right_motor", ..left }]),
        MpcError::TorqueSpeed { motor: "left_motor" }
    );
    let softer = [left.soft(), right, MpcRow { name: "supply", ..right }];
    assert!(Nmpc::new(Wrist, motion(), options().with_rows(softer)).is_ok());
}

/// A joint that follows, and a motor, may have one name: their rows are distinguished by their contents.
#[test]
fn one_name_of_a_joint_and_a_motor_is_no_way_around_a_limit() {
    let options = || MpcOptions::new(&CrowdedWrist, PERIOD, 15);
    let [place, speed, left, right] = MpcRow::of_limits(&CrowdedWrist);
    assert_eq!([place, speed, left].map(|row| row.name), ["left_motor"; 3]);
    let new = |rows| LtvMpc::new(CrowdedWrist, motion(), options().with_rows(rows)).map(|_| ());
    assert_eq!(new([place, speed, left, right]), Ok(()));
    let of_joint = Err(MpcError::Dependent { joint: "left_motor" });
    // The line has speeds in it, and keeps none.
    assert_eq!(new([place, place, left, right]), of_joint);
    assert_eq!(new([speed, speed, left, right]), of_joint);
    assert_eq!(new([place, speed, speed, right]), Err(MpcError::TorqueSpeed { motor: "left_motor" }));
}

#[test]
fn a_robot_with_driven_joints_keeps_those_of_its_own() {
    let rail = RestToRest::new([-0.3], [0.3], 2.0).unwrap();
    let robot = DrivenRobot::new(RailArm::default(), rail);
    let motion = RestToRest::new([0.0, 0.3], [0.4, -0.2], 2.0).unwrap();
    let options = MpcOptions::new(&robot, PERIOD, 5);
    assert_eq!(options.rows.map(|row| (row.velocities, row.upper)), [([2.0, 0.0], 60.0)]);
    assert!(LtvMpc::new(robot, motion, options).is_ok());
}

#[test]
fn checks_of_trajectories_tell_of_them() {
    let all = violations(&motion(), Wrist, Rating::Peak, PERIOD).unwrap();
    let of_lines = all.iter().filter(|found| found.quantity == Quantity::TorqueSpeed);
    let [left] = of_lines.collect::<Vec<_>>()[..] else { panic!("{all:?}") };
    assert_eq!((left.name, left.index, left.limit), ("left_motor", 2, 0.24));
    let sample = motion().sample(left.worst_time);
    let inputs = FeedForward::new(Wrist).unwrap().at(&sample).inputs;
    let excess = beyond(&sample.velocities, &inputs);
    assert!((left.value - STALL - excess).abs() < 1e-12 && excess > 0.0, "{left}");
    assert!(
        left.to_string().starts_with("torque–speed sum of left_motor is outside its limit 0.24"),
        "{left}"
    );
    let slow = RestToRest::new(START, GOAL, 2.0).unwrap();
    assert_eq!(violations(&slow, Wrist, Rating::Peak, PERIOD).unwrap(), []);
}

/// A plant applies the torque of the motors if they have lines, and the requested one otherwise.
#[test]
fn a_plant_gives_what_its_motors_do() {
    let torque_speed = Wrist.limits().torque_speed;
    for (lines, expected) in [(torque_speed, [STALL - 6.0 * SLOPE, 0.2]), (&[][..], [0.2, 0.2])] {
        let options = PlantOptions { torque_speed: lines, ..PlantOptions::default() };
        let mut plant = Plant::new(Wrist, options).unwrap();
        plant.reset(START, [0.0, 0.0, 3.0, 3.0]).unwrap();
        plant.apply(&[0.0, 0.0, 0.2, 0.2], 1e-4).unwrap();
        let [_, _, left, right] = plant.applied();
        assert!((left - expected[0]).abs() < 1e-15 && right == expected[1], "{left} {right}");
        plant.apply(&[0.0, 0.0, -0.2, 0.1], 1e-4).unwrap();
        assert_eq!(plant.applied()[2..], [-0.2, 0.1], "a motor that brakes has enough");
    }
}

/// A law that knows nothing of the lines, with gains that ask for more.
#[test]
fn the_loop_cuts_off_what_is_beyond_them() {
    for (torque_speed, is_cut) in [(Wrist.limits().torque_speed, true), (&[][..], false)] {
        let settings =
            LoopSettings { warm_up: 0.0, torque_speed, ..LoopSettings::for_robot(1.0 / PERIOD, &Wrist) };
        let settings = LoopSettings { speed_limit: [9.0; 4], following_error: [1.0; 4], ..settings };
        let options = PlantOptions { velocity_noise: Some([0.0; 4]), ..PlantOptions::default() };
        let mut plant = Plant::new(Wrist, options).unwrap();
        plant.reset(START, [0.0; 4]).unwrap();
        plant.preload(FeedForward::new(Wrist).unwrap().at(&motion().sample(0.0)).inputs);
        let clock = VirtualClock::new();
        let transport = InProcess::new(plant, clock.clone(), settings.period());
        let law = || JointPd::new(Wrist, JointGains::from_bandwidth(&Wrist, &START, 15.0, 0.8)).unwrap();
        let controller = LawController::new(law(), motion(), PERIOD, 0.01).unwrap();
        let mut control = ControlLoop::new(settings, law(), motion(), controller, transport, clock).unwrap();
        let report = control.run();
        println!("{report}");
        assert_eq!(report.counts.limited_inputs > 0, is_cut, "{report}");
    }
}
