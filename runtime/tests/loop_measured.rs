//! The loop on robots whose drives measure velocities and torques, and with computed torque; asserted on the
//! plant's own state.

#![allow(clippy::unwrap_used, reason = "test code")]

use super::pd;
use crate::support::named_robot::NamedRobot;
use crate::support::robot::{
    DURATION, PowerCube, START, Watched, loop_with, motion, plant_at, plant_options, settings,
};
use gelenk_identification::log::{ColumnOptions, runs};
use gelenk_identification::run::Effort;
use gelenk_runtime::control_loop::{
    AccelerationGains, Command, ComputedTorque, ControlLoop, Controller, ControllerFault, Cycle,
    EncoderFault, End, LawController, LoopReport, StopReason, log_to_file,
};
use gelenk_runtime::plant::PlantOptions;
use std::sync::{Arc, Mutex};

const RATE: f64 = 50.0;

/// Drives that measure both.
fn measuring() -> PlantOptions<2, 2> {
    PlantOptions { velocity_noise: Some([1e-4; 2]), torque_noise: Some([0.1; 2]), ..plant_options() }
}

fn robot(options: PlantOptions<2, 2>) -> Watched {
    Watched::new(RATE, plant_at(START, options))
}

fn run(robot: &mut Watched) -> LoopReport<2> {
    loop_with(settings(RATE), pd(RATE), robot).run()
}

/// Records the cycles it receives.
struct Listening<C> {
    controller: C,
    cycles: Arc<Mutex<Vec<Cycle<2, 2>>>>,
}

impl<C: Controller<2, 2>> Controller<2, 2> for Listening<C> {
    fn reset(&mut self, positions: &[f64; 2], inputs: &[f64; 2]) {
        self.controller.reset(positions, inputs);
    }

    fn step(&mut self, cycle: &Cycle<2, 2>) -> Result<Command<2>, ControllerFault> {
        self.cycles.lock().unwrap().push(*cycle);
        self.controller.step(cycle)
    }
}

#[test]
fn what_drives_measure_reaches_controller_and_log() {
    let path = std::env::temp_dir().join(format!("gelenk_measured_{}.csv", std::process::id()));
    let (sink, writer) = log_to_file(&path, &PowerCube, 10_000).unwrap();
    let mut robot = robot(measuring());
    let cycles = Arc::default();
    let listening = Listening { controller: pd(RATE), cycles: Arc::clone(&cycles) };
    let report = loop_with(settings(RATE), listening, &mut robot).with_log(sink).run();
    assert_eq!(report.end, End::Finished, "{report}");
    robot.assert_at_end(5e-3);
    robot.assert_stopped_safely();
    // Half-way the arm moves at 15/8 of its mean speed, and 76.6 N m s/rad of friction alone need a good part
    // of the torque.
    let cycle = cycles.lock().unwrap()[125];
    let speed = cycle.velocities.unwrap()[0];
    assert!((speed - 1.875 * 1.4 / DURATION).abs() < 0.02, "{speed}");
    assert!(cycle.torques.unwrap()[0] > 40.0, "{cycle:?}");
    writer.finish().unwrap();
    let robot =
        NamedRobot { names: vec!["beta".into(), "gamma".into()], gear: 161.0, ..NamedRobot::default() };
    let read = |columns: Option<&str>| {
        let columns = ColumnOptions { columns: columns.map(str::to_owned), ..ColumnOptions::default() };
        let recording = runs(std::slice::from_ref(&path), &robot, &columns).unwrap();
        let [run] = recording.runs.try_into().unwrap();
        // A period without a reading has no measurement, and the log has no header's row less.
        let at = run.rows.iter().position(|row| *row == 127).unwrap();
        (run, at)
    };
    let (measured, at) = read(None);
    assert_eq!(measured.velocities[0].as_ref().unwrap()[at], speed);
    let (estimated, other) = read(Some("velocity=dq_{name},input=u_{name}"));
    std::fs::remove_file(&path).unwrap();
    assert_eq!((measured.effort, estimated.effort), (Effort::Joint, Effort::Input));
    assert_eq!(estimated.velocities[0].as_ref().unwrap()[other], speed, "the estimate is the measurement");
    // The input held over the last period makes the torque, through the gear.
    let (u, tau) = (&estimated.efforts[0], &measured.efforts[0]);
    assert!((tau[at] - 161.0 * u[other - 1]).abs() < 0.5);
}

/// Coarse encoders make coarse differences; measured velocities are not touched by them.
#[test]
fn measured_velocities_make_a_quieter_loop() {
    let roughness = |velocity_noise| {
        let mut robot =
            robot(PlantOptions { encoder_resolution: [2e-3; 2], velocity_noise, ..plant_options() });
        let inputs = Arc::new(Mutex::new(Vec::new()));
        let seen = Arc::clone(&inputs);
        let recording = Recording { controller: pd(RATE), inputs: seen };
        let report = loop_with(settings(RATE), recording, &mut robot).run();
        assert_eq!(report.end, End::Finished, "{report}");
        let inputs = inputs.lock().unwrap();
        let second = |w: &[f64]| (w[0] - 2.0 * w[1] + w[2]).powi(2);
        inputs.windows(3).map(second).sum::<f64>().sqrt()
    };
    let (differences, measured) = (roughness(None), roughness(Some([1e-4; 2])));
    assert!(measured < 0.7 * differences, "{measured} {differences}");
}

struct Recording<C> {
    controller: C,
    inputs: Arc<Mutex<Vec<f64>>>,
}

impl<C: Controller<2, 2>> Controller<2, 2> for Recording<C> {
    fn reset(&mut self, positions: &[f64; 2], inputs: &[f64; 2]) {
        self.controller.reset(positions, inputs);
    }

    fn step(&mut self, cycle: &Cycle<2, 2>) -> Result<Command<2>, ControllerFault> {
        let command = self.controller.step(cycle)?;
        self.inputs.lock().unwrap().push(command.inputs[0]);
        Ok(command)
    }
}

/// A turned sign and a sensor that stands still are found while the arm still is slow; the motor's side of
/// the gear and degrees already by the speed that they make of noise.
#[test]
fn velocities_that_contradict_positions_stop_the_arm() {
    for factor in [-1.0, 0.0, 161.0, 57.3] {
        let mut robot = robot(measuring()).with_fault(move |_, mut reading| {
            if let Some(velocities) = &mut reading.velocities {
                velocities[1] *= factor;
            }
            Some(reading)
        });
        let report = run(&mut robot);
        match report.end {
            End::Stopped(StopReason::Encoder(EncoderFault::Velocity { joint: 1, .. })) => {
                assert!(report.to_string().contains("of joint gamma"));
                assert_eq!(report.counts.velocity_faults, 4, "three are bridged");
            }
            End::Stopped(StopReason::Limit(_)) => assert!(factor > 1.0, "{report}"),
            _ => panic!("{factor}: {report}"),
        }
        robot.assert_stopped_safely();
    }
}

#[test]
fn a_single_velocity_that_is_no_number_is_bridged() {
    let mut robot = robot(measuring()).with_fault(|k, mut reading| {
        if (70..73).contains(&k) {
            reading.velocities = Some([f64::NAN, 0.0]);
        }
        if k == 90 {
            reading.torques = Some([f64::NAN; 2]);
        }
        Some(reading)
    });
    let report = run(&mut robot);
    assert_eq!(report.end, End::Finished, "{report}");
    assert_eq!((report.counts.velocity_faults, report.counts.held), (3, 3));
    robot.assert_at_end(5e-3);
    robot.assert_stopped_safely();
}

/// Drives that stop measuring velocities in the middle of the motion: differences take over.
#[test]
fn velocities_may_stay_away() {
    let mut robot = robot(measuring()).with_fault(|k, mut reading| {
        if k > 100 {
            reading.velocities = None;
        }
        Some(reading)
    });
    let report = run(&mut robot);
    assert_eq!(report.end, End::Finished, "{report}");
    robot.assert_at_end(5e-3);
}

/// As controller and as what the loop falls back on.
#[test]
fn computed_torque_drives_the_arm() {
    let computed = || ComputedTorque::new(PowerCube, AccelerationGains::from_bandwidth(10.0, 1.0)).unwrap();
    let controller = || LawController::new(computed(), motion(), 1.0 / RATE, 0.01).unwrap();
    let mut robot = robot(measuring());
    let report = loop_with(settings(RATE), controller(), &mut robot).run();
    assert_eq!(report.end, End::Finished, "{report}");
    assert_eq!(report.counts.controller_faults, 0);
    robot.assert_at_end(5e-3);
    robot.assert_stopped_safely();

    let mut robot = self::robot(measuring());
    let clock = robot.clock.clone();
    let broken = Broken;
    let mut control =
        ControlLoop::new(settings(RATE), computed(), motion(), broken, &mut robot, clock).unwrap();
    let report = control.run();
    drop(control);
    assert_eq!(report.end, End::Stopped(StopReason::Controller(ControllerFault::NotFinite)), "{report}");
    assert!(report.counts.fallback > 25, "{report}");
    robot.assert_stopped_safely();
}

struct Broken;

impl Controller<2, 2> for Broken {
    fn reset(&mut self, _: &[f64; 2], _: &[f64; 2]) {}

    fn step(&mut self, _: &Cycle<2, 2>) -> Result<Command<2>, ControllerFault> {
        Err(ControllerFault::NotFinite)
    }
}
