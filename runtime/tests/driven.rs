//! Plants, laws and predictive controllers of a robot with a driven joint, whose motion is given over time.

#![allow(clippy::unwrap_used, reason = "test code")]

use gelenk_runtime::control_loop::{
    AccelerationGains, ComputedTorque, ControlLoop, Controller, Cycle, End, FeedForwardPd, JointGains,
    JointLaw, JointPd, LoopSettings, VirtualClock,
};
use gelenk_runtime::driven::DrivenRobot;
use gelenk_runtime::dynamics::{Dynamics, LimitRows, PhaseSpace};
use gelenk_runtime::feed_forward::FeedForward;
use gelenk_runtime::mpc::{LinearizationPoint, LtvMpc, MpcError, MpcOptions, Nmpc};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{RestToRest, Sample, Trajectory};
use gelenk_runtime::transport::InProcess;

gelenk_runtime::dynamics!(struct RailArm { driven } = gelenk_generated::rail_arm: Differentiable);

const PERIOD: f64 = 0.01;
const SECONDS: f64 = 2.0;

/// The rail leaves its rest before the arm does and comes to rest after it.
fn rail() -> RestToRest<1> {
    RestToRest::new([-0.5], [0.5], 1.5).unwrap()
}

fn robot() -> DrivenRobot<RailArm, RestToRest<1>, 1> {
    DrivenRobot::new(RailArm::default(), rail())
}

fn arm() -> RestToRest<2> {
    RestToRest::new([0.1, 0.3], [-0.3, 0.6], SECONDS).unwrap()
}

fn plant() -> Plant<DrivenRobot<RailArm, RestToRest<1>, 1>, 2, 2> {
    let mut plant = Plant::new(robot(), PlantOptions::default()).unwrap();
    plant.reset(arm().sample(0.0).positions, [0.0; 2]).unwrap();
    plant
}

fn distance(plant: &Plant<impl Dynamics<2, 2>, 2, 2>) -> f64 {
    let (y, desired) = (plant.state().0, arm().sample(plant.time()).positions);
    y.iter().zip(&desired).map(|(y, d)| (y - d).abs()).fold(0.0, f64::max)
}

/// Largest distance from the desired motion while a controller of `model` drives the plant.
fn tracked(mut controller: impl Controller<2, 2>) -> f64 {
    let mut plant = plant();
    let (mut last_inputs, mut worst) = ([0.0; 2], 0.0_f64);
    controller.reset(&plant.state().0, &last_inputs);
    for k in 0..200 {
        let cycle = Cycle {
            time: PERIOD * f64::from(k),
            periods: u32::from(k > 0),
            positions: Some(plant.measure().positions),
            last_inputs,
            ..Cycle::default()
        };
        last_inputs = controller.step(&cycle).unwrap().inputs;
        plant.apply(&last_inputs, PERIOD).unwrap();
        worst = worst.max(distance(&plant));
    }
    worst
}

fn options<D: Dynamics<2, 2> + LimitRows<0>>(model: &D) -> MpcOptions<2, 2> {
    MpcOptions::new(model, PERIOD, 20)
}

/// One that takes the rail for resting, as the same controller of a robot without driven joints would.
fn resting() -> RailArm {
    RailArm { driven: [[-0.5, 0.0, 0.0]] }
}

#[test]
fn feed_forward_alone_keeps_the_arm_on_its_way() {
    let feed_forward = FeedForward::new(robot()).unwrap();
    let fine = 1e-3;
    let inputs = feed_forward.along(&arm(), fine, 1e-9).unwrap();
    let mut plant = plant();
    let mut worst = 0.0_f64;
    for input in &inputs[..1000] {
        plant.apply(input, fine).unwrap();
        worst = worst.max(distance(&plant));
    }
    assert!(worst < 2e-3, "{worst}");
    let blind = FeedForward::new(resting()).unwrap().along(&arm(), fine, 1e-9).unwrap();
    let most = inputs.iter().zip(&blind).map(|(a, b)| (a[0] - b[0]).abs()).fold(0.0, f64::max);
    assert!(most > 0.05, "the rail's acceleration is part of the torque: {most} N m at the motor");
}

#[test]
fn predictive_controllers_foresee_the_driven_motion() {
    let ltv = tracked(LtvMpc::new(robot(), arm(), options(&robot())).unwrap());
    let reference = MpcOptions { linearization: LinearizationPoint::Reference, ..options(&robot()) };
    let around_reference = tracked(LtvMpc::new(robot(), arm(), reference).unwrap());
    let nonlinear = tracked(Nmpc::new(robot(), arm(), options(&robot())).unwrap());
    let late = tracked(Nmpc::new(robot().beginning_at(0.5), arm(), options(&robot())).unwrap());
    println!(
        "largest distances: {ltv:.1e}, {around_reference:.1e}, {nonlinear:.1e}; a wrong motion of the rail: {late:.1e}"
    );
    assert!(ltv < 5e-5, "LTV-MPC: {ltv}");
    assert!(around_reference < 5e-5, "LTV-MPC around its reference: {around_reference}");
    assert!(nonlinear < 5e-5, "NMPC: {nonlinear}");
    assert!(late > 20.0 * nonlinear, "a model whose rail moves later: {late}");
}

/// The first input written acts one period later.
#[test]
fn the_delay_of_a_period_is_compensated_along_the_driven_motion() {
    let delayed = MpcOptions { delay: true, ..options(&robot()) };
    let mut controller = LtvMpc::new(robot(), arm(), delayed).unwrap();
    let mut plant = Plant::new(robot(), PlantOptions { delay: 1, ..PlantOptions::default() }).unwrap();
    plant.reset(arm().sample(0.0).positions, [0.0; 2]).unwrap();
    let hold = FeedForward::new(robot()).unwrap().at_time(0.0, &arm().sample(0.0)).inputs;
    plant.preload(hold);
    controller.reset(&plant.state().0, &hold);
    let (mut last_inputs, mut worst) = (hold, 0.0_f64);
    for k in 0..200 {
        let cycle = Cycle {
            time: PERIOD * f64::from(k),
            periods: u32::from(k > 0),
            positions: Some(plant.measure().positions),
            last_inputs,
            ..Cycle::default()
        };
        last_inputs = controller.step(&cycle).unwrap().inputs;
        plant.apply(&last_inputs, PERIOD).unwrap();
        worst = worst.max(distance(&plant));
    }
    assert!(worst < 5e-5, "{worst}");
}

#[test]
fn the_loop_drives_the_arm_while_the_rail_moves() {
    let settings = LoopSettings { release_time: 0.0, ..LoopSettings::for_robot(100.0, &robot()) };
    let gains = JointGains::from_bandwidth(&robot(), &[0.1, 0.3], 15.0, 0.8);
    let law = JointPd::new(robot(), gains).unwrap();
    let controller = FeedForwardPd::new(law.clone(), arm(), PERIOD, 0.0).unwrap();
    // The plant begins a period before the loop's first.
    let mut plant = Plant::new(robot().beginning_at(PERIOD), PlantOptions::default()).unwrap();
    plant.reset([0.1, 0.3], [0.0; 2]).unwrap();
    let clock = VirtualClock::new();
    let transport = InProcess::new(plant, clock.clone(), settings.period());
    let mut control = ControlLoop::new(settings, law, arm(), controller, transport, clock).unwrap();
    let report = control.run();
    assert_eq!(report.end, End::Finished, "{report}");
    assert_eq!(report.counts.controller_faults, 0);
    let y = control.transport().plant().state().0;
    assert!((y[0] + 0.3).abs() < 2e-3 && (y[1] - 0.6).abs() < 2e-3, "{y:?}");
}

#[test]
fn computed_torque_makes_the_accelerations_that_it_wants() {
    let gains = AccelerationGains::from_bandwidth(10.0, 1.0);
    let law = ComputedTorque::new(robot(), gains).unwrap();
    let (y, v) = ([0.2, 0.1], [0.4, -0.3]);
    let u = law.inputs_at_time(0.4, &Sample::at_rest([0.0; 2]), &y, &v).unwrap();
    let a = robot().at(0.4).forward_dynamics(&y, &v, &u);
    for i in 0..2 {
        let wanted = -100.0 * y[i] - 20.0 * v[i];
        assert!((a[i] - wanted).abs() < 1e-9 * wanted.abs(), "{a:?}");
    }
    assert!(law.inputs(&Sample::at_rest([0.0; 2]), &y, &v).is_err(), "at no time");
}

/// Nothing is ever computed as if the rail stood at 0.
#[test]
fn without_a_time_nothing_is_known() {
    let (y, v) = ([0.1, 0.2], [0.0; 2]);
    let is_unknown = |f: [f64; 2]| f.iter().any(|x| x.is_nan());
    assert!(
        is_unknown(RailArm::default().gravity_forces(&y))
            || is_unknown(RailArm::default().bias_forces(&y, &v))
    );
    assert!(is_unknown(robot().bias_forces(&y, &v)));
    assert!(is_unknown(robot().at(f64::INFINITY).bias_forces(&y, &v)));
    // One instant of a moving rail is not a motion; one of a resting rail is.
    let moving = RailArm { driven: [[0.0, 1.0, 0.0]] };
    let mut plant = Plant::new(moving, PlantOptions::default()).unwrap();
    assert!(plant.apply(&[0.0; 2], PERIOD).is_err());
    let mut plant = Plant::new(resting(), PlantOptions::default()).unwrap();
    assert!(plant.apply(&[0.0; 2], PERIOD).is_ok());
    let mut law = JointPd::new(robot(), JointGains { position: [1.0; 2], velocity: [1.0; 2] }).unwrap();
    assert!(law.inputs(&arm().sample(0.0), &y, &v).is_err());
    law = law.clone();
    assert!(law.inputs_at_time(0.3, &arm().sample(0.3), &y, &v).is_ok());
    let nowhere = robot().beginning_at(f64::NAN);
    let options = MpcOptions::new(&nowhere, PERIOD, 5);
    assert!(matches!(LtvMpc::new(nowhere, arm(), options), Err(MpcError::NotFinite { time: 0.0 })));
}

#[test]
fn a_motion_of_any_length_is_given_as_a_reference() {
    let boxed: Box<dyn Trajectory<1>> = Box::new(rail());
    let by_reference = DrivenRobot::new(RailArm::default(), &boxed);
    assert_eq!(by_reference.driven_at(0.7), robot().driven_at(0.7));
    fn states<const NX: usize>(_: &impl PhaseSpace<NX>) -> usize {
        NX
    }
    assert_eq!(states(&by_reference), 4);
}
