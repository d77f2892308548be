//! Limits of joints that follow coordinates: whatever keeps those of coordinates keeps them too.

#![allow(clippy::unwrap_used, reason = "test code")]

use gelenk_runtime::control_loop::{
    AccelerationGains, ComputedTorque, ControlLoop, Controller, Cycle, End, JointGains, JointLaw, JointPd,
    LawController, LimitFault, LoopSettings, Refusal, SPEED_MARGIN, StopReason, VirtualClock,
};
use gelenk_runtime::driven::DrivenRobot;
use gelenk_runtime::dynamics::{DependentJoint, Dynamics, Predictable};
use gelenk_runtime::feed_forward::FeedForward;
use gelenk_runtime::limits::{Quantity, Rating, Violation, violations};
use gelenk_runtime::mpc::{LtvMpc, MpcError, MpcNote, MpcOptions, MpcRow, Nmpc};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{
    MotionLimits, OnlineTarget, RestToRest, Trajectory, TrajectoryError, ViaPoints,
};
use gelenk_runtime::transport::InProcess;

const FREE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
const PERIOD: f64 = 0.01;

/// The gripper, whose fingers have limits: the left one goes the other way and stops before the drive does.
mod limited_gripper {
    pub use gelenk_test_robots::gripper::*;
    pub const DEPENDENT_POSITION_LIMITS: [[f64; 2]; 5] =
        [[-0.5, 1.0], super::FREE, super::FREE, super::FREE, super::FREE];
    pub const DEPENDENT_VELOCITY_LIMITS: [f64; 5] = [f64::INFINITY, 1.5, f64::INFINITY, f64::INFINITY, 1.2];
}

/// The palletizer, whose forearm also has a limit of speed.
mod limited_palletizer {
    pub use gelenk_generated::palletizer::*;
    pub const DEPENDENT_VELOCITY_LIMITS: [f64; 3] = [f64::INFINITY, 0.6, f64::INFINITY];
}

/// The arm on rails, with a rod that follows the rail and the shoulder.
mod limited_rail_arm {
    pub use gelenk_generated::rail_arm::*;
    pub const DEPENDENT_JOINT_NAMES: [&str; 1] = ["rod"];
    pub const DEPENDENT_JOINT_RATIOS: [[f64; N]; 1] = [[1.0, 0.0]];
    pub const DEPENDENT_DRIVEN_RATIOS: [[f64; DRIVEN]; 1] = [[2.0]];
    pub const DEPENDENT_JOINT_OFFSETS: [f64; 1] = [0.1];
    pub const DEPENDENT_POSITION_LIMITS: [[f64; 2]; 1] = [[-1.5, 0.8]];
    pub const DEPENDENT_VELOCITY_LIMITS: [f64; 1] = [f64::INFINITY];
}

/// The wrist like a TX40's, the differential wrist and the SCARA, with a highest speed of a motor that moves two joints, and the
/// excavator with a joint that follows boom and stick, as the generator writes their constants.
mod limited_tx40 {
    pub use gelenk_test_robots::tx40_like::*;
    pub const DEPENDENT_JOINT_NAMES: [&str; 1] = ["motor_6"];
    pub const DEPENDENT_JOINT_RATIOS: [[f64; N]; 1] = [[0.0, 0.0, 0.0, 0.0, 32.0, 32.0]];
    pub const DEPENDENT_JOINT_OFFSETS: [f64; 1] = [0.0];
    pub const DEPENDENT_POSITION_LIMITS: [[f64; 2]; 1] = [super::FREE];
    pub const DEPENDENT_VELOCITY_LIMITS: [f64; 1] = [120.0];
}
mod limited_wrist {
    pub use gelenk_generated::differential_wrist::*;
    pub const DEPENDENT_JOINT_NAMES: [&str; 1] = ["left_motor"];
    pub const DEPENDENT_JOINT_RATIOS: [[f64; N]; 1] = [[0.0, 0.0, 80.0, 80.0]];
    pub const DEPENDENT_JOINT_OFFSETS: [f64; 1] = [0.0];
    pub const DEPENDENT_POSITION_LIMITS: [[f64; 2]; 1] = [super::FREE];
    pub const DEPENDENT_VELOCITY_LIMITS: [f64; 1] = [350.0];
}
mod limited_scara {
    pub use gelenk_generated::scara::*;
    pub const DEPENDENT_JOINT_NAMES: [&str; 1] = ["screw_nut"];
    pub const DEPENDENT_JOINT_RATIOS: [[f64; N]; 1] = [[0.0, 0.0, 1.0, -314.1592653589793, 0.0]];
    pub const DEPENDENT_JOINT_OFFSETS: [f64; 1] = [0.0];
    pub const DEPENDENT_POSITION_LIMITS: [[f64; 2]; 1] = [super::FREE];
    pub const DEPENDENT_VELOCITY_LIMITS: [f64; 1] = [60.0];
}
mod limited_excavator {
    pub use gelenk_generated::excavator::*;
    pub const DEPENDENT_JOINT_NAMES: [&str; 1] = ["level"];
    pub const DEPENDENT_JOINT_RATIOS: [[f64; N]; 1] = [[0.0, 1.0, 1.0, 0.0]];
    pub const DEPENDENT_JOINT_OFFSETS: [f64; 1] = [-1.0];
    pub const DEPENDENT_POSITION_LIMITS: [[f64; 2]; 1] = [[-0.5, 0.12]];
    pub const DEPENDENT_VELOCITY_LIMITS: [f64; 1] = [f64::INFINITY];
}

gelenk_runtime::dynamics!(struct Tx40 = limited_tx40);
gelenk_runtime::dynamics!(struct Wrist = limited_wrist);
gelenk_runtime::dynamics!(struct Scara = limited_scara);
gelenk_runtime::dynamics!(struct Excavator = limited_excavator);
gelenk_runtime::dynamics!(struct Gripper = limited_gripper);
gelenk_runtime::dynamics!(struct Palletizer = gelenk_generated::palletizer);
gelenk_runtime::dynamics!(struct SlowPalletizer = limited_palletizer);
gelenk_runtime::dynamics!(struct RailArm { driven } = limited_rail_arm);

/// Place of the forearm among the joints that follow, and among all joints.
const FOREARM: usize = 1;

/// The coordinates stay within their limits, the forearm would end at 1.7 rad, 0.2 rad beyond its own.
fn beyond_the_forearm() -> ([f64; 4], RestToRest<4>) {
    let start = [0.0, 0.3, 0.8, 0.0];
    (start, RestToRest::new(start, [0.4, -0.1, 1.6, 0.5], 2.0).unwrap())
}

/// The largest value of `shown` at the start of a period, over the motion and its half again.
fn run<const N: usize, const M: usize, D: Dynamics<N, M> + Copy>(
    model: D,
    controller: &mut dyn Controller<N, M>,
    motion: RestToRest<N>,
    shown: impl Fn(&[f64; N], &[f64; N]) -> f64,
) -> f64 {
    let mut plant = Plant::new(model, PlantOptions::default()).unwrap();
    let start = motion.sample(0.0).positions;
    plant.reset(start, [0.0; N]).unwrap();
    controller.reset(&start, &[0.0; M]);
    let (mut last_inputs, mut largest) = ([0.0; M], f64::NEG_INFINITY);
    for k in 0..(1.5 * motion.duration() / PERIOD) as u32 {
        let (time, periods) = (PERIOD * f64::from(k), u32::from(k > 0));
        let positions = Some(plant.measure().positions);
        let cycle = Cycle { time, periods, positions, last_inputs, ..Cycle::default() };
        last_inputs = controller.step(&cycle).unwrap().inputs;
        let (y, v) = plant.state();
        largest = largest.max(shown(&y, &v));
        plant.apply(&last_inputs, PERIOD).unwrap();
    }
    largest
}

#[test]
fn both_predictive_controllers_keep_the_limits_of_sums() {
    let (_, motion) = beyond_the_forearm();
    let forearm = Palletizer.limits().dependent[FOREARM];
    assert_eq!((forearm.name, forearm.ratios), ("forearm", [0.0, -1.0, 1.0, 0.0]));
    let options = || MpcOptions::new(&Palletizer, PERIOD, 15);
    let rows = MpcRow::of_limits(&Palletizer);
    let linear = LtvMpc::new(Palletizer, motion, options().with_rows(rows)).unwrap();
    assert!(linear.notes().iter().any(|note| matches!(note, MpcNote::Row { row: "forearm", .. })));
    let nonlinear = Nmpc::new(Palletizer, motion, options().with_rows(rows)).unwrap();
    let controllers: [Box<dyn Controller<4, 4>>; 2] = [Box::new(linear), Box::new(nonlinear)];
    for mut controller in controllers {
        let angle = |y: &[f64; 4], v: &[f64; 4]| forearm.motion(y, v, &[])[0];
        let largest = run(Palletizer, &mut *controller, motion, angle);
        assert!(largest < 1.5 + 5e-3 && largest > 1.4, "{largest}");
    }
}

#[test]
fn a_limit_of_speed_of_a_sum_is_kept() {
    let (start, _) = beyond_the_forearm();
    // Within 1 s at up to 0.94 rad/s.
    let motion = RestToRest::new(start, [0.0, 0.05, 1.05, 0.0], 1.0).unwrap();
    let rows = MpcRow::of_limits(&SlowPalletizer);
    assert_eq!(rows.map(|row| row.name), ["forearm", "forearm"]);
    let options = MpcOptions::new(&SlowPalletizer, PERIOD, 15).with_rows(rows);
    let mut controller = LtvMpc::new(SlowPalletizer, motion, options).unwrap();
    let speed = |_: &[f64; 4], v: &[f64; 4]| v[2] - v[1];
    let largest = run(SlowPalletizer, &mut controller, motion, speed);
    assert!(largest < 0.62 && largest > 0.5, "{largest}");
}

/// Nobody leaves such limits out without knowing.
#[test]
fn a_predictive_controller_without_these_rows_is_refused() {
    let (_, motion) = beyond_the_forearm();
    let options = || MpcOptions::new(&Palletizer, PERIOD, 15).with_rows([]);
    let error = LtvMpc::new(Palletizer, motion, options()).unwrap_err();
    assert_eq!(error, MpcError::Dependent { joint: "forearm" });
    assert!(error.to_string().contains("MpcRow::of_limits"), "{error}");
    assert!(Nmpc::new(Palletizer, motion, options()).is_err());
    // Bounds within which the forearm keeps its limits, or a row of its name, do as well.
    let mut within = options();
    within.position_limits[2] = [-0.3, 0.8];
    within.position_limits[1] = [-0.7, 0.9];
    assert!(LtvMpc::new(Palletizer, motion, within).is_ok());
    let own = MpcRow::new("forearm", [0.0, -1.0, 1.0, 0.0], [0.0; 4], [0.0; 4], [-1.3, 1.6]);
    assert!(LtvMpc::new(Palletizer, motion, options().with_rows([own])).is_ok());
    // One of its name for speeds says nothing of positions.
    let speeds = MpcRow::new("forearm", [0.0; 4], [0.0, -1.0, 1.0, 0.0], [0.0; 4], [-9.0, 9.0]);
    assert!(LtvMpc::new(Palletizer, motion, options().with_rows([speeds])).is_err());
    let slow = MpcOptions::new(&SlowPalletizer, PERIOD, 15).with_rows([own]);
    assert!(LtvMpc::new(SlowPalletizer, motion, slow).is_err(), "its speed has a limit too");
}

/// A joint that follows one coordinate narrows its bounds.
#[test]
fn a_finger_narrows_the_limits_of_its_drive() {
    let limits = Gripper.limits();
    assert_eq!((limits.position[1], limits.velocity[1]), ([0.0, 0.8], 2.0));
    let narrowed = limits.narrowed();
    assert_eq!((narrowed.position, narrowed.velocity), ([[-3.0, 3.0], [0.0, 0.5]], [3.0, 1.2]));
    let motion = RestToRest::new([0.0, 0.1], [0.5, 0.7], 2.0).unwrap();
    let options = || MpcOptions::new(&Gripper, PERIOD, 15);
    assert_eq!((options().position_limits[1], options().velocity_limits[1]), ([0.0, 0.5], 1.2));
    let mut linear = LtvMpc::new(Gripper, motion, options()).unwrap();
    let mut nonlinear = Nmpc::new(Gripper, motion, options()).unwrap();
    for controller in [&mut linear as &mut dyn Controller<2, 2>, &mut nonlinear] {
        let largest = run(Gripper, controller, motion, |y, _| y[1]);
        assert!(largest < 0.5 + 5e-3 && largest > 0.45, "{largest}");
    }
    let mut wide = options();
    wide.position_limits[1] = [0.0, 0.8];
    let error = LtvMpc::new(Gripper, motion, wide).unwrap_err();
    assert_eq!(error, MpcError::Dependent { joint: "left_finger" }, "widened by hand");
    let within = MotionLimits::of(&limits, 0.5, [1.0; 2]);
    assert_eq!((within.positions[1], within.speeds[1]), ([0.0, 0.5], 0.6));
}

/// Runs the loop with a law that keeps no limits.
fn end<const N: usize>(model: impl Dynamics<N, N> + Copy, motion: RestToRest<N>) -> End {
    let start = motion.sample(0.0);
    let law = || {
        let gains = JointGains::from_bandwidth(&model, &start.positions, 15.0, 0.8);
        JointPd::new(model, gains).unwrap()
    };
    end_with(model, motion, law)
}

fn end_with<L: JointLaw<N, N>, const N: usize>(
    model: impl Dynamics<N, N> + Copy,
    motion: RestToRest<N>,
    law: impl Fn() -> L,
) -> End {
    let start = motion.sample(0.0);
    let settings = LoopSettings { warm_up: 0.0, ..LoopSettings::for_robot(1.0 / PERIOD, &model) };
    let mut plant = Plant::new(model, PlantOptions::default()).unwrap();
    plant.reset(start.positions, [0.0; N]).unwrap();
    plant.preload(FeedForward::new(model).unwrap().at_time(0.0, &start).inputs);
    let clock = VirtualClock::new();
    let transport = InProcess::new(plant, clock.clone(), settings.period());
    let controller = LawController::new(law(), motion, PERIOD, 0.01).unwrap();
    let mut control = ControlLoop::new(settings, law(), motion, controller, transport, clock).unwrap();
    control.run().end
}

#[test]
fn the_loop_brakes_at_them() {
    let (start, motion) = beyond_the_forearm();
    let stopped = end(Palletizer, motion);
    let End::Stopped(StopReason::Limit(LimitFault::Position {
        joint, name, position, stopping, limits, ..
    })) = stopped
    else {
        panic!("{stopped}")
    };
    assert_eq!((joint, name, limits), (4 + FOREARM, "forearm", [-1.2, 1.5]));
    assert!(position < 1.5 && stopping > 1.5, "{stopped}");
    let fast = end(SlowPalletizer, RestToRest::new(start, [0.0, 0.05, 1.05, 0.0], 1.0).unwrap());
    let is_of_speed = matches!(
        fast,
        End::Stopped(StopReason::Limit(LimitFault::Speed { name: "forearm", limit, .. })) if limit == 0.6 * SPEED_MARGIN
    );
    assert!(is_of_speed, "{fast}");
    let within = end(Palletizer, RestToRest::new(start, [0.4, 0.3, 1.2, 0.5], 2.0).unwrap());
    assert_eq!(within, End::Finished);
}

#[test]
fn the_loop_does_not_start_beyond_them() {
    let start = [0.0, -0.3, 1.6, 0.0];
    let refused = end(Palletizer, RestToRest::new(start, start, 1.0).unwrap());
    let is_of_position =
        matches!(refused, End::Refused(Refusal::Limit(LimitFault::Position { name: "forearm", .. })));
    assert!(is_of_position, "{refused}");
}

fn found(violations: &[Violation], name: &str, quantity: Quantity) -> Vec<Violation> {
    violations.iter().filter(|found| found.name == name && found.quantity == quantity).copied().collect()
}

#[test]
fn checks_of_trajectories_tell_of_them() {
    let (start, motion) = beyond_the_forearm();
    let all = violations(&motion, Palletizer, Rating::Peak, PERIOD).unwrap();
    let [forearm] = found(&all, "forearm", Quantity::Position)[..] else { panic!("{all:?}") };
    assert_eq!((forearm.index, forearm.limit), (4 + FOREARM, 1.5));
    assert!((forearm.value - 1.7).abs() < 1e-12 && forearm.worst_time == 2.0, "{forearm}");
    let speed = RestToRest::new(start, [0.0, 0.05, 1.05, 0.0], 1.0).unwrap();
    let all = violations(&speed, SlowPalletizer, Rating::Peak, PERIOD).unwrap();
    let [forearm] = found(&all, "forearm", Quantity::Velocity)[..] else { panic!("{all:?}") };
    assert!((forearm.value - 0.5 * 1.875).abs() < 1e-12, "{forearm}");
    // As fast as it may be.
    let slow =
        RestToRest::within_limits(start, [0.0, 0.05, 1.05, 0.0], &SlowPalletizer.limits(), 1.0, &[99.0; 4]);
    let slow = slow.unwrap();
    assert!((slow.duration() - 0.5 * 1.875 / 0.6).abs() < 1e-12, "{}", slow.duration());
    let all = violations(&slow, SlowPalletizer, Rating::Peak, PERIOD).unwrap();
    assert!(found(&all, "forearm", Quantity::Velocity).is_empty(), "{all:?}");
    let grip = RestToRest::new([0.0, 0.1], [0.0, 0.7], 2.0).unwrap();
    let all = violations(&grip, Gripper, Rating::Peak, PERIOD).unwrap();
    let [finger] = found(&all, "left_finger", Quantity::Position)[..] else { panic!("{all:?}") };
    assert_eq!((finger.limit, finger.value), (-0.5, -0.7));
}

/// Its place is the sum of the shoulder's and twice the rail's: from 0.1 rad it goes to 0.5 rad with the shoulder, and beyond
/// 0.8 rad with the rail.
#[test]
fn a_joint_that_follows_a_driven_one_is_judged_beside_its_motion() {
    let motion = RestToRest::new([0.0, 0.3], [0.4, -0.2], 2.0).unwrap();
    let resting = RestToRest::new([0.0], [0.0], 2.0).unwrap();
    let moving = RestToRest::new([0.0], [0.3], 2.0).unwrap();
    let [still, away] = [resting, moving].map(|rail| DrivenRobot::new(RailArm::default(), rail));
    let judged = |robot| violations(&motion, robot, Rating::Peak, PERIOD).unwrap();
    assert!(found(&judged(still), "rod", Quantity::Position).is_empty());
    let [rod] = found(&judged(away), "rod", Quantity::Position)[..] else { panic!("{:?}", judged(away)) };
    assert!((rod.value - 1.1).abs() < 1e-12, "{rod}");
    assert_eq!(end(still, motion), End::Finished);
    let stopped = end(away, motion);
    let is_of_rod =
        matches!(stopped, End::Stopped(StopReason::Limit(LimitFault::Position { name: "rod", .. })));
    assert!(is_of_rod, "{stopped}");
    let mpc = LtvMpc::new(away, motion, MpcOptions::new(&away, PERIOD, 5)).unwrap();
    let notes: Vec<String> = mpc.notes().iter().map(ToString::to_string).collect();
    assert!(
        notes.iter().any(|note| note.contains("joint rod, because it follows a driven joint")),
        "{notes:?}"
    );
    assert_eq!(MpcRow::of_limits(&away), [] as [MpcRow<2, 2>; 0]);
}

/// Beyond the limit of the one joint or motor that follows, as a part of it; not positive within.
fn excess<const N: usize>(joint: &DependentJoint<N>, y: &[f64; N], v: &[f64; N]) -> f64 {
    let [position, speed] = joint.motion(y, v, &[]);
    let [low, high] = joint.position;
    if joint.has_velocity_limit() {
        speed.abs() / joint.velocity - 1.0
    } else {
        (low - position).max(position - high)
    }
}

/// That controllers, checks and the loop know the limit of the one joint or motor that follows, which the motion leaves.
fn check<D, L, const N: usize, const NX: usize, const NR: usize>(
    model: D,
    motion: RestToRest<N>,
    law: impl Fn(D) -> L,
) where
    D: Predictable<N, N, NX, NR> + Copy,
    L: JointLaw<N, N>,
{
    let [joint] = model.limits().dependent else { panic!("one joint or motor follows") };
    let shown = |y: &[f64; N], v: &[f64; N]| excess(joint, y, v);
    let options = || MpcOptions::new(&model, PERIOD, 15);
    assert_eq!(options().rows[0].name, joint.name);
    let free = options().rows.map(|row| MpcRow { lower: f64::NEG_INFINITY, upper: f64::INFINITY, ..row });
    let mut without = LtvMpc::new(model, motion, options().with_rows(free)).unwrap();
    let beyond = run(model, &mut without, motion, shown);
    let mut linear = LtvMpc::new(model, motion, options()).unwrap();
    let mut nonlinear = Nmpc::new(model, motion, options()).unwrap();
    let kept = [&mut linear as &mut dyn Controller<N, N>, &mut nonlinear];
    let kept = kept.map(|controller| run(model, controller, motion, shown));
    println!("{}: {beyond:.3} without its row, {kept:?} with it", joint.name);
    assert!(beyond > 0.05 && kept.iter().all(|kept| *kept < 0.01 && *kept > -0.2), "{}", joint.name);
    let quantity = if joint.has_velocity_limit() { Quantity::Velocity } else { Quantity::Position };
    let all = violations(&motion, model, Rating::Peak, PERIOD).unwrap();
    assert_eq!(found(&all, joint.name, quantity).len(), 1, "{all:?}");
    let stopped = end_with(model, motion, || law(model));
    let of_joint = matches!(
        stopped,
        End::Stopped(StopReason::Limit(LimitFault::Position { name, .. } | LimitFault::Speed { name, .. })) if name == joint.name
    );
    assert!(of_joint, "{}: {stopped}", joint.name);
}

fn joint_pd<const N: usize, D: Dynamics<N, N>>(model: D) -> JointPd<D, N, N> {
    let gains = JointGains::from_bandwidth(&model, &[0.0; N], 15.0, 0.8);
    JointPd::new(model, gains).unwrap()
}

#[test]
fn speeds_of_motors_on_two_joints_reach_controllers_checks_and_the_loop() {
    let [start, goal] = [[0.2, 0.6, -0.4, 0.0], [0.2, 0.6, 0.4, 0.9]];
    check(Wrist, RestToRest::new(start, goal, 0.6).unwrap(), joint_pd);
    let [start, goal] = [[0.0, 0.3, 0.8, 0.0, -0.4, 0.0], [0.1, 0.3, 0.8, 0.2, 0.4, 1.4]];
    let motion = RestToRest::new(start, goal, 0.7).unwrap();
    check(Tx40, motion, joint_pd);
    let [start, goal] = [[0.2, 0.4, 0.0, -0.02, 0.0], [0.1, 0.5, 0.4, -0.1, 0.0]];
    check(Scara, RestToRest::new(start, goal, 0.6).unwrap(), joint_pd);
}

/// Cylinders move what is followed.
#[test]
fn a_limit_of_a_joint_that_follows_boom_and_stick_reaches_an_excavators_controllers() {
    let motion = RestToRest::new([0.0, -0.2, 1.2, 0.6], [0.0, -0.3, 1.55, 0.9], 2.0).unwrap();
    check(Excavator, motion, |model| {
        ComputedTorque::new(model, AccelerationGains::from_bandwidth(10.0, 1.0)).unwrap()
    });
}

/// Largest and least position of the forearm along a motion, and its largest speed.
fn of_forearm(motion: &impl Trajectory<4>) -> [f64; 3] {
    let forearm = Palletizer.limits().dependent[FOREARM];
    let mut extremes = [f64::INFINITY, f64::NEG_INFINITY, 0.0];
    for k in 0..=20_000 {
        let sample = motion.sample(motion.duration() * f64::from(k) / 20_000.0);
        let [position, speed] = forearm.motion(&sample.positions, &sample.velocities, &[]);
        extremes = [extremes[0].min(position), extremes[1].max(position), speed.abs().max(extremes[2])];
    }
    extremes
}

/// The coordinates move against each other, so that the forearm is faster than both.
#[test]
fn a_motion_through_points_keeps_the_speed_of_a_joint_that_follows_several_coordinates() {
    let points = [[0.0, 0.4, 0.6, 0.0], [0.1, 0.1, 0.9, 0.0], [0.2, 0.0, 1.1, 0.3], [0.0, 0.3, 0.7, 0.0]];
    let limits = MotionLimits::of(&SlowPalletizer.limits(), 0.5, [6.0; 4]);
    let [.., speed] = of_forearm(&ViaPoints::within(&points, &limits).unwrap());
    assert!(speed <= 0.3 * (1.0 + 1e-9), "{speed}");
    assert!(speed > 0.3 * 0.999, "it is what limits this motion: {speed}");
    let others = MotionLimits { dependent: &[], ..limits };
    let [.., speed] = of_forearm(&ViaPoints::within(&points, &others).unwrap());
    assert!(speed > 0.6, "without its limit it is faster than it may be: {speed}");
}

/// In both points in the middle the forearm stands just below its highest position, 1.5 rad; both coordinates are far from their
/// limits.
#[test]
fn a_motion_through_points_keeps_the_position_of_a_joint_that_follows_several_coordinates() {
    let points =
        [[0.0, -0.1, 0.4, 0.0], [0.0, -0.3, 1.19, 0.0], [0.0, -0.3, 1.19, 1.5], [0.0, -0.1, 0.4, 0.0]];
    let limits = MotionLimits::of(&Palletizer.limits(), 0.5, [6.0; 4]);
    let motion = ViaPoints::within(&points, &limits).unwrap();
    let [_, highest, _] = of_forearm(&motion);
    assert!((1.49 - 1e-9..=1.5).contains(&highest), "{highest}");
    assert!((motion.sample(motion.times()[1]).positions[2] - 1.19).abs() < 1e-9);
    let others = MotionLimits { dependent: &[], ..limits };
    let [_, highest, _] = of_forearm(&ViaPoints::within(&points, &others).unwrap());
    assert!(highest > 1.5, "a spline leads it beyond: {highest}");

    let beyond = [points[0], [0.0, -0.4, 1.2, 0.0]];
    let error = ViaPoints::within(&beyond, &limits).unwrap_err();
    assert!(matches!(error, TrajectoryError::DependentOutside { joint: "forearm", point: 1, .. }), "{error}");
    assert!(error.to_string().starts_with("point 2 has joint forearm, which follows several"), "{error}");
}

/// From the second to the third point, where the forearm stands below its highest position, the crank moves first and the lower
/// arm after it, each of them monotone.
#[test]
fn a_joint_that_would_leave_its_limits_between_two_points_is_refused() {
    let points =
        [[0.0, -0.6, 0.59, 0.0], [0.0, -0.6, 0.89, 0.0], [0.0, -0.3, 1.19, 0.0], [0.0, 0.0, 1.19, 0.0]];
    let limits = MotionLimits::of(&Palletizer.limits(), 0.5, [6.0; 4]);
    let error = ViaPoints::within(&points, &limits).unwrap_err();
    let is_between = matches!(error, TrajectoryError::DependentOvershoot { joint: "forearm", point: 1, .. });
    assert!(is_between, "{error}");
    assert!(error.to_string().contains("between points 2 and 3"), "{error}");
    let between = [points[0], points[1], [0.0, -0.31, 0.95, 0.0], points[2], points[3]];
    let motion = ViaPoints::within(&between, &limits).unwrap();
    assert!(of_forearm(&motion)[1] <= 1.5);
}

#[test]
fn a_target_that_changes_is_refused_where_it_would_not_keep_them() {
    let limits = MotionLimits { jerks: [50.0; 4], ..MotionLimits::of(&Palletizer.limits(), 0.5, [6.0; 4]) };
    let error = OnlineTarget::new([0.0, 0.3, 0.8, 0.0], &limits).unwrap_err();
    assert_eq!(error, TrajectoryError::DependentNotKept { joint: "forearm" });
    assert!(error.to_string().contains("MotionLimits::dependent"), "{error}");
    let narrowed = MotionLimits { dependent: &[], ..limits };
    assert!(OnlineTarget::new([0.0, 0.3, 0.8, 0.0], &narrowed).is_ok());
    // Fingers that follow one coordinate count by its limits.
    let limits = MotionLimits { jerks: [50.0; 2], ..MotionLimits::of(&Gripper.limits(), 0.5, [6.0; 2]) };
    assert!(OnlineTarget::new([0.0, 0.1], &limits).is_ok());
}
