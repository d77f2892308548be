//! LTV-MPC in the loop, with the faults that a controller with an observer sees differently; asserted on the plant's own state.

#![allow(clippy::unwrap_used, reason = "test code")]

mod support;

use gelenk_runtime::control_loop::{EncoderFault, End, LoopReport, LoopSettings, StopReason};
use gelenk_runtime::mpc::{LtvMpc, MpcOptions};
use gelenk_runtime::trajectory::RestToRest;
use std::time::Duration;
use support::robot::{
    LIMITS, PowerCube, START, Watched, loop_with, lossy, motion, plant_at, plant_options,
    run_oversleeping, settings,
};

const RATE: f64 = 50.0;

type Mpc = LtvMpc<PowerCube, RestToRest<2>, 2, 2, 4>;

fn mpc() -> Mpc {
    let options = MpcOptions {
        position_limits: LIMITS,
        ..MpcOptions::new(&PowerCube, 1.0 / RATE, 20)
    };
    LtvMpc::new(PowerCube, motion(), options).unwrap()
}

fn run(settings: LoopSettings<2, 2>, robot: &mut Watched) -> LoopReport {
    loop_with(settings, mpc(), robot).run()
}

#[test]
fn without_faults_it_ends_at_the_end() {
    let mut robot = Watched::at_start(RATE);
    let report = run(settings(RATE), &mut robot);
    assert_eq!(report.end, End::Finished, "{report}");
    assert_eq!(report.counts.controller_faults, 0);
    robot.assert_at_end(2e-3);
    robot.assert_stopped_safely();
}

/// The observer predicts what is missing: nothing is held, and no seed stops with eight periods to bridge.
#[test]
fn a_fifth_of_the_frames_may_be_lost() {
    for seed in 0..10 {
        let mut robot = Watched::new(RATE, plant_at(START, lossy(seed)));
        let settings = LoopSettings {
            hold_periods: 8,
            ..settings(RATE)
        };
        let report = run(settings, &mut robot);
        assert_eq!(report.end, End::Finished, "{report}");
        assert_eq!(report.counts.held, 0, "{report}");
        assert!(report.counts.missing > 20, "{report}");
        robot.assert_at_end(5e-3);
        robot.assert_stopped_safely();
    }
}

#[test]
fn bad_encoders_and_silence_are_bridged_then_stop() {
    type Spoil = fn(&mut [f64; 2]);
    let spoils: [Spoil; 2] = [|q| q[1] = f64::NAN, |q| q[0] += 0.7];
    for spoil in spoils {
        for (bad, finished) in [(3, true), (1000, false)] {
            let mut robot = Watched::at_start(RATE).with_fault(move |k, mut reading| {
                if (100..100 + bad).contains(&k) {
                    spoil(&mut reading.positions);
                }
                Some(reading)
            });
            let report = run(settings(RATE), &mut robot);
            if finished {
                assert_eq!(report.end, End::Finished, "{report}");
                robot.assert_at_end(2e-3);
            } else {
                assert!(
                    matches!(report.end, End::Stopped(StopReason::Encoder(_))),
                    "{report}"
                );
            }
            robot.assert_stopped_safely();
        }
    }
    for (silence, end) in [
        (3, End::Finished),
        (4, End::Stopped(StopReason::NoMeasurement)),
    ] {
        let mut robot = Watched::at_start(RATE)
            .with_fault(move |k, reading| (!(100..100 + silence).contains(&k)).then_some(reading));
        let report = run(settings(RATE), &mut robot);
        assert_eq!(report.end, end, "{report}");
        assert_eq!(report.counts.held, 0, "the observer predicts");
        robot.assert_stopped_safely();
    }
}

#[test]
fn frozen_encoders_stop_the_arm() {
    let mut robot = Watched::at_start(RATE).frozen(&[0, 1], 100);
    let report = run(settings(RATE), &mut robot);
    assert!(
        matches!(
            report.end,
            End::Stopped(StopReason::Encoder(EncoderFault::Frozen { .. }))
        ),
        "{report}"
    );
    robot.assert_stopped_safely();
}

#[test]
fn a_stall_of_100_ms_is_survived() {
    for (hold, end) in [
        (3, End::Stopped(StopReason::DeadlineMissed)),
        (5, End::Finished),
    ] {
        let mut robot = Watched::at_start(RATE);
        let settings = LoopSettings {
            hold_periods: hold,
            ..settings(RATE)
        };
        let late = [2000, 100].map(Duration::from_millis);
        let report = run_oversleeping(settings, mpc(), &mut robot, late);
        assert_eq!(report.end, end, "{report}");
        assert_eq!(report.counts.deadline_misses, 5);
        robot.assert_stopped_safely();
    }
}

/// The arm stands 40 mrad beside the start, outside the soft bounds that the controller has: the QP is infeasible without
/// its slack, and must bring the arm back with inputs within their limits.
#[test]
fn an_infeasible_start_is_recovered_from() {
    let beside = [START[0] - 0.04, START[1] + 0.04];
    let mut robot = Watched::new(RATE, plant_at(beside, plant_options()));
    let options = MpcOptions {
        position_limits: [[START[0] - 0.01, 1.2], [-1.0, START[1] + 0.01]],
        ..MpcOptions::new(&PowerCube, 1.0 / RATE, 20)
    };
    let controller: Mpc = LtvMpc::new(PowerCube, motion(), options).unwrap();
    let report = loop_with(settings(RATE), controller, &mut robot).run();
    assert_eq!(report.end, End::Finished, "{report}");
    assert_eq!(report.counts.controller_faults, 0, "{report}");
    robot.assert_at_end(2e-3);
    robot.assert_stopped_safely();
}
