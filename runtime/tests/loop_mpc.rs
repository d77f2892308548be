//! LTV-MPC and NMPC in the loop, with the faults that a controller with an observer sees differently;
//! asserted on the plant's own state. Every test runs with both.

#![allow(clippy::unwrap_used, reason = "test code")]

use super::made;
use crate::support::robot::{
    LIMITS, PowerCube, START, Watched, loop_with, lossy, motion, plant_at, plant_options, run_oversleeping,
};
use gelenk_runtime::control_loop::{
    Command, Controller, ControllerFault, Cycle, EncoderFault, End, Estimate, LimitFault, LoopReport,
    LoopSettings, SPEED_MARGIN, StopReason,
};
use gelenk_runtime::mpc::{LtvMpc, MpcOptions, Nmpc};
use gelenk_runtime::plant::PlantOptions;
use gelenk_runtime::transport::Reading;
use std::time::Duration;

const RATE: f64 = 50.0;

/// On a virtual clock nothing is gained by warm caches, but time is lost.
fn settings(rate: f64) -> LoopSettings<2, 2> {
    LoopSettings { warm_up: 0.0, ..crate::support::robot::settings(rate) }
}

/// Which of the two.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Linear,
    Nonlinear,
}

const BOTH: [Kind; 2] = [Kind::Linear, Kind::Nonlinear];

impl Kind {
    /// The nonlinear one is slow in builds without optimization: its horizon is the shorter one.
    fn options(self) -> MpcOptions<2, 2> {
        let horizon = if self == Self::Linear { 20 } else { 10 };
        MpcOptions { position_limits: LIMITS, ..MpcOptions::new(&PowerCube, 1.0 / RATE, horizon) }
    }

    fn with(self, options: MpcOptions<2, 2>) -> Box<dyn Controller<2, 2>> {
        match self {
            Self::Linear => Box::new(made(RATE, |model| LtvMpc::new(model, motion(), options).unwrap())),
            Self::Nonlinear => Box::new(made(RATE, |model| Nmpc::new(model, motion(), options).unwrap())),
        }
    }

    fn run(self, settings: LoopSettings<2, 2>, robot: &mut Watched) -> LoopReport<2> {
        loop_with(settings, &mut *self.with(self.options()), robot).run()
    }
}

#[test]
fn without_faults_it_ends_at_the_end() {
    for kind in BOTH {
        let mut robot = Watched::at_start(RATE);
        let report = kind.run(settings(RATE), &mut robot);
        assert_eq!(report.end, End::Finished, "{report}");
        assert_eq!(report.counts.controller_faults, 0);
        robot.assert_at_end(2e-3);
        robot.assert_stopped_safely();
    }
}

/// The trajectory is 5 % faster than the limit, which is soft to the controller. A loop that brakes at the limit itself stops; its
/// default is a tenth above.
#[test]
fn they_ride_on_a_speed_limit() {
    const LIMIT: f64 = 0.5;
    for kind in BOTH {
        let ride = |speed_limit: f64| {
            let mut robot = Watched::at_start(RATE);
            let options = MpcOptions { velocity_limits: [LIMIT; 2], ..kind.options() };
            let settings = LoopSettings { speed_limit: [speed_limit; 2], ..settings(RATE) };
            let report = loop_with(settings, &mut *kind.with(options), &mut robot).run();
            (report, robot.seen.fastest[0])
        };
        let (report, fastest) = ride(SPEED_MARGIN * LIMIT);
        assert_eq!(report.end, End::Finished, "{report}");
        assert!((0.99 * LIMIT..1.02 * LIMIT).contains(&fastest), "{kind:?}: {fastest}");
        let (report, _) = ride(LIMIT);
        assert!(matches!(report.end, End::Stopped(StopReason::Limit(LimitFault::Speed { .. }))), "{report}");
    }
}

/// The observer predicts what is missing: nothing is held, and no seed stops with eight periods to bridge.
#[test]
fn a_fifth_of_the_frames_may_be_lost() {
    for (kind, seeds) in [(Kind::Linear, 0..8), (Kind::Nonlinear, 8..10)] {
        for seed in seeds {
            let mut robot = Watched::new(RATE, plant_at(START, lossy(seed)));
            let settings = LoopSettings { hold_periods: 8, ..settings(RATE) };
            let report = kind.run(settings, &mut robot);
            assert_eq!(report.end, End::Finished, "{report}");
            assert_eq!(report.counts.held, 0, "{report}");
            assert!(report.counts.missing > 20, "{report}");
            robot.assert_at_end(5e-3);
            robot.assert_stopped_safely();
        }
    }
}

#[test]
fn bad_encoders_and_silence_are_bridged_then_stop() {
    type Spoil = fn(&mut [f64; 2]);
    let spoils: [Spoil; 2] = [|q| q[1] = f64::NAN, |q| q[0] += 0.7];
    for kind in BOTH {
        for spoil in spoils {
            for (bad, finished) in [(3, true), (1000, false)] {
                let mut robot = Watched::at_start(RATE).with_fault(move |k, mut reading| {
                    if (100..100 + bad).contains(&k) {
                        spoil(&mut reading.positions);
                    }
                    Some(reading)
                });
                let report = kind.run(settings(RATE), &mut robot);
                if finished {
                    assert_eq!(report.end, End::Finished, "{report}");
                    robot.assert_at_end(2e-3);
                } else {
                    assert!(matches!(report.end, End::Stopped(StopReason::Encoder(_))), "{report}");
                }
                robot.assert_stopped_safely();
            }
        }
        for (silence, end) in [(3, End::Finished), (4, End::Stopped(StopReason::NoMeasurement))] {
            let mut robot = Watched::at_start(RATE)
                .with_fault(move |k, reading| (!(100..100 + silence).contains(&k)).then_some(reading));
            let report = kind.run(settings(RATE), &mut robot);
            assert_eq!(report.end, end, "{report}");
            assert_eq!(report.counts.held, 0, "the observer predicts");
            robot.assert_stopped_safely();
        }
    }
}

/// Every tenth reading jumps by more than a joint can move, in turns; each is bridged.
#[test]
fn spikes_are_bridged() {
    for kind in BOTH {
        let mut robot = Watched::at_start(RATE).with_fault(|k, mut reading| {
            if k % 10 == 9 {
                let joint = (k / 10 % 2) as usize;
                reading.positions[joint] += if k % 20 == 9 { 0.3 } else { -0.3 };
            }
            Some(reading)
        });
        let report = kind.run(settings(RATE), &mut robot);
        assert_eq!(report.end, End::Finished, "{report}");
        assert_eq!((report.counts.jumps, report.counts.held), (25, 0), "{report}");
        robot.assert_at_end(3e-3);
        robot.assert_stopped_safely();
    }
}

/// For a second every reading is that of a period before, as from a bus that lags: 20 ms that the controller
/// does not know of.
#[test]
fn late_readings_are_survived() {
    for kind in BOTH {
        let mut before: Option<Reading<2>> = None;
        let mut robot = Watched::at_start(RATE).with_fault(move |k, reading| {
            let late = before.replace(reading);
            if (100..150).contains(&k) { late } else { Some(reading) }
        });
        let report = kind.run(settings(RATE), &mut robot);
        assert_eq!(report.end, End::Finished, "{kind:?} {report}");
        robot.assert_at_end(2e-3);
        robot.assert_stopped_safely();
    }
}

/// Drives that are weaker than the controller believes cut its inputs off; so does the loop, where its limit
/// is the lower one.
#[test]
fn saturated_inputs_are_survived() {
    for kind in BOTH {
        for (drives, of_loop) in [(0.33, 0.5), (0.5, 0.33)] {
            let weak = PlantOptions { input_limits: [[-drives, drives]; 2], ..plant_options() };
            let mut robot = Watched::new(RATE, plant_at(START, weak));
            let settings = LoopSettings {
                input_limits: [[-of_loop, of_loop]; 2],
                following_error: [0.3; 2],
                settling_time: 1.0,
                ..settings(RATE)
            };
            let report = kind.run(settings, &mut robot);
            assert_eq!(report.end, End::Finished, "{kind:?} {report}");
            assert_eq!(report.counts.limited_inputs > 0, of_loop < 0.5, "{drives} {report}");
            robot.assert_at_end(5e-3);
            robot.assert_stopped_safely();
        }
    }
}

#[test]
fn frozen_encoders_stop_the_arm() {
    for kind in BOTH {
        let mut robot = Watched::at_start(RATE).frozen(&[0, 1], 100);
        let report = kind.run(settings(RATE), &mut robot);
        assert!(
            matches!(report.end, End::Stopped(StopReason::Encoder(EncoderFault::Frozen { .. }))),
            "{report}"
        );
        robot.assert_stopped_safely();
    }
}

#[test]
fn a_stall_of_100_ms_is_survived() {
    for kind in BOTH {
        for (hold, end) in [(3, End::Stopped(StopReason::DeadlineMissed)), (5, End::Finished)] {
            let mut robot = Watched::at_start(RATE);
            let settings = LoopSettings { hold_periods: hold, ..settings(RATE) };
            let late = [2000, 100].map(Duration::from_millis);
            let controller = &mut *kind.with(kind.options());
            let report = run_oversleeping(settings, controller, &mut robot, late);
            assert_eq!(report.end, end, "{report}");
            assert_eq!(report.counts.deadline_misses, 5);
            robot.assert_stopped_safely();
        }
    }
}

/// The arm stands 40 mrad from the start, outside the soft bounds that the controller has: the QP is
/// infeasible without its slack, and must bring the arm back with inputs within their limits.
#[test]
fn an_infeasible_start_is_recovered_from() {
    let beside = [START[0] - 0.04, START[1] + 0.04];
    for kind in BOTH {
        let mut robot = Watched::new(RATE, plant_at(beside, plant_options()));
        let options = MpcOptions {
            position_limits: [[START[0] - 0.01, 1.2], [-1.0, START[1] + 0.01]],
            ..kind.options()
        };
        let controller = &mut *kind.with(options);
        let report = loop_with(settings(RATE), controller, &mut robot).run();
        assert_eq!(report.end, End::Finished, "{report}");
        assert_eq!(report.counts.controller_faults, 0, "{report}");
        robot.assert_at_end(2e-3);
        robot.assert_stopped_safely();
    }
}

/// A controller whose proposals are spoilt in some steps; its state goes on.
struct Spoilt<C> {
    controller: C,
    step: u64,
    spoilt: std::ops::Range<u64>,
    with: Result<Command<2>, ControllerFault>,
}

impl<C: Controller<2, 2>> Controller<2, 2> for Spoilt<C> {
    fn reset(&mut self, positions: &[f64; 2], inputs: &[f64; 2]) {
        self.controller.reset(positions, inputs);
    }

    fn step(&mut self, cycle: &Cycle<2, 2>) -> Result<Command<2>, ControllerFault> {
        let step = self.step;
        self.step += 1;
        let sound = self.controller.step(cycle);
        if self.spoilt.contains(&step) { self.with } else { sound }
    }

    fn planned(&self, periods: u32) -> Option<[f64; 2]> {
        self.controller.planned(periods)
    }

    fn estimate(&self) -> Option<Estimate<2>> {
        self.controller.estimate()
    }
}

/// Plan, then fallback, then the controller again; or the controlled stop, if it stays broken.
#[test]
fn failing_steps_are_replaced() {
    let faults = [
        Err(ControllerFault::NoSolution { iterations: 30 }),
        Ok(Command { inputs: [0.1, f64::NAN], iterations: 1 }),
    ];
    for (kind, with) in [(BOTH[0], faults[0]), (BOTH[1], faults[1])] {
        for (last, end) in [
            (75, End::Finished),
            (
                1000,
                End::Stopped(StopReason::Controller(match with {
                    Err(fault) => fault,
                    Ok(_) => ControllerFault::NotFinite,
                })),
            ),
        ] {
            let mut robot = Watched::at_start(RATE);
            let controller =
                Spoilt { controller: &mut *kind.with(kind.options()), step: 0, spoilt: 60..last, with };
            let report = loop_with(settings(RATE), controller, &mut robot).run();
            assert_eq!(report.end, end, "{kind:?} {report}");
            assert_eq!(report.counts.plan, 5, "{report}");
            assert!(report.counts.fallback >= 10, "{report}");
            if end == End::Finished {
                robot.assert_at_end(2e-3);
            }
            robot.assert_stopped_safely();
        }
    }
}

/// Warm-ups of the caches change neither the robot's motion nor the controllers' outputs.
#[test]
fn warm_ups_change_nothing() {
    for kind in BOTH {
        let run = |warm_up: f64| {
            let mut robot = Watched::new(RATE, plant_at(START, lossy(3)));
            let settings = LoopSettings { warm_up, hold_periods: 8, ..settings(RATE) };
            let mut report = kind.run(settings, &mut robot);
            let warm_ups = std::mem::take(&mut report.counts.warm_ups);
            assert_eq!(warm_ups > 250, warm_up > 0.0, "{warm_ups}");
            (report, robot.state(), robot.seen)
        };
        assert_eq!(run(0.0), run(2e-3), "{kind:?}");
    }
}

/// A stall of years costs a bounded time, is a fault of that step alone, and leaves the controller able to go
/// on.
#[test]
fn a_stall_beyond_prediction_is_a_fault_of_one_step() {
    for kind in BOTH {
        let mut controller = kind.with(kind.options());
        controller.reset(&START, &[0.0; 2]);
        let cycle = |time: f64, periods| Cycle { time, periods, positions: Some(START), ..Cycle::default() };
        assert!(controller.step(&cycle(0.0, 0)).is_ok());
        for periods in [101, u32::MAX] {
            assert_eq!(
                controller.step(&cycle(0.02, periods)),
                Err(ControllerFault::Stalled { periods }),
                "{kind:?}"
            );
            assert!(controller.step(&cycle(0.04, 1)).is_ok(), "{kind:?}");
        }
        assert_eq!(
            ControllerFault::Stalled { periods: 101 }.to_string(),
            "the state cannot be predicted, because 101 periods passed since the last step"
        );
    }
}

/// Encoders of 5 mrad say little of velocities that an unknown torque changes; drives that measure them do,
/// and the observer takes it if their accuracy is set.
#[test]
fn measured_velocities_improve_the_estimate() {
    let error = |noise: Option<f64>| {
        let coarse = PlantOptions {
            encoder_resolution: [5e-3; 2],
            velocity_noise: Some([1e-3; 2]),
            input_noise: [0.02; 2],
            ..plant_options()
        };
        let mut plant = plant_at(START, coarse);
        let mut options = Kind::Linear.options();
        options.observer.encoder_noise = [5e-3 / 12_f64.sqrt(); 2];
        // 0.02 N m at the motor, over 20 ms.
        options.observer.velocity_noise = [0.02; 2];
        options.observer.velocity_sensor_noise = noise.map(|n| [n; 2]);
        let mut controller = Kind::Linear.with(options);
        controller.reset(&START, &[0.0; 2]);
        let (mut last, mut sum) = ([0.0; 2], 0.0);
        for k in 0..200_u32 {
            let measurement = plant.measure();
            let cycle = Cycle {
                time: f64::from(k) / RATE,
                periods: u32::from(k > 0),
                positions: Some(measurement.positions),
                velocities: measurement.velocities,
                last_inputs: last,
                ..Cycle::default()
            };
            last = controller.step(&cycle).unwrap().inputs;
            let (estimate, (_, v)) = (controller.estimate().unwrap(), plant.state());
            sum += (estimate.velocities[0] - v[0]).powi(2);
            plant.apply(&last, 1.0 / RATE).unwrap();
        }
        (sum / 200.0).sqrt()
    };
    let (without, with) = (error(None), error(Some(1e-3)));
    assert!(with < 0.5 * without, "{with} {without}");
}
