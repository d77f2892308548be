//! Faults that the loop survives, asserted on the plant's own state. All on a virtual clock: the same every
//! time.

#![allow(clippy::unwrap_used, reason = "test code")]

use super::{Pd, pd};
use crate::support::named_robot::NamedRobot;
use crate::support::robot::{
    END, LIMITS, Law, START, Watched, WatchedLoop, law, loop_with, lossy, motion, plant_at, plant_options,
    run_oversleeping, settings,
};
use gelenk_identification::log::{ColumnOptions, runs};
use gelenk_runtime::control_loop::{
    Clock, Command, ControlLoop, Controller, ControllerFault, Counts, Cycle, EncoderFault, End, Estimate,
    Lateness, LimitFault, LoopReport, LoopSettings, Refusal, StopReason, StopRequest, VirtualClock,
    log_to_file,
};
use gelenk_runtime::trajectory::RestToRest;
use gelenk_runtime::transport::{Brakes, Reading};
use std::time::Duration;

const RATE: f64 = 50.0;

fn run(settings: LoopSettings<2, 2>, robot: &mut Watched) -> LoopReport<2> {
    let rate = settings.rate;
    loop_with(settings, pd(rate), robot).run()
}

/// A controller that misbehaves: what `act` returns is used, or else the feed-forward with PD beneath.
struct Troubled<F> {
    sound: Pd,
    last: [f64; 2],
    step: u64,
    act: F,
}

impl<F> Troubled<F> {
    fn new(act: F) -> Self {
        Self { sound: pd(RATE), last: [0.0; 2], step: 0, act }
    }
}

impl<F: FnMut(u64) -> Option<Result<Command<2>, ControllerFault>>> Controller<2, 2> for Troubled<F> {
    fn reset(&mut self, positions: &[f64; 2], inputs: &[f64; 2]) {
        self.sound.reset(positions, inputs);
    }

    fn step(&mut self, cycle: &Cycle<2, 2>) -> Result<Command<2>, ControllerFault> {
        let sound = self.sound.step(cycle);
        let step = self.step;
        self.step += 1;
        let command = (self.act)(step).unwrap_or(sound);
        if let Ok(command) = command
            && command.inputs.iter().all(|u| u.is_finite())
        {
            self.last = command.inputs;
        }
        command
    }

    /// A plan of three periods that goes on as before.
    fn planned(&self, periods: u32) -> Option<[f64; 2]> {
        (periods <= 3).then_some(self.last)
    }

    fn estimate(&self) -> Option<Estimate<2>> {
        self.sound.estimate()
    }
}

/// Motion and settling, in periods; the one in which the brakes are engaged writes nothing.
fn periods(rate: f64) -> u64 {
    ((crate::support::robot::DURATION + 0.1) * rate).round() as u64
}

#[test]
fn without_faults_the_motion_is_finished_at_every_rate() {
    for rate in [50.0, 200.0, 1000.0] {
        let mut robot = Watched::at_start(rate);
        let report = run(settings(rate), &mut robot);
        assert_eq!(report.end, End::Finished, "{report}");
        assert_eq!(report.brakes, Brakes::Engaged);
        let mut lateness = Lateness::default();
        lateness.counts[0] = periods(rate) + 2;
        let expected = Counts {
            periods: periods(rate) + 2,
            lateness,
            controller: periods(rate),
            // Before the start, and before each period that drives.
            warm_ups: periods(rate) + 2,
            ..Counts::default()
        };
        assert_eq!(report.counts, expected, "{report}");
        robot.assert_at_end(5e-3);
        robot.assert_stopped_safely();
    }
}

#[test]
fn the_same_run_gives_the_same_motion() {
    let motion = || {
        let mut robot = Watched::new(RATE, plant_at(START, lossy(3)));
        let report = run(settings(RATE), &mut robot);
        (report, robot.state(), robot.seen)
    };
    assert_eq!(motion(), motion());
}

#[test]
fn nan_encoders_stop_the_arm() {
    for (joint, bad) in [(0, f64::NAN), (1, f64::NAN), (1, f64::INFINITY)] {
        let mut robot = Watched::at_start(RATE).with_fault(move |k, mut reading| {
            if k >= 70 {
                reading.positions[joint] = bad;
            }
            Some(reading)
        });
        let report = run(settings(RATE), &mut robot);
        assert!(
            matches!(report.end, End::Stopped(StopReason::Encoder(EncoderFault::NotFinite { .. }))),
            "{report}"
        );
        assert_eq!(report.counts.not_finite, 4, "three are bridged");
        assert_eq!(report.counts.held, 3);
        robot.assert_stopped_safely();
    }
}

#[test]
fn three_nan_readings_are_bridged() {
    let mut robot = Watched::at_start(RATE).with_fault(|k, reading| {
        Some(if (70..73).contains(&k) { Reading { positions: [f64::NAN; 2], ..reading } } else { reading })
    });
    let report = run(settings(RATE), &mut robot);
    assert_eq!(report.end, End::Finished, "{report}");
    assert_eq!(report.counts.not_finite, 3);
    robot.assert_at_end(5e-3);
    robot.assert_stopped_safely();
}

#[test]
fn frozen_encoders_stop_the_arm() {
    for joints in [&[0][..], &[1], &[0, 1]] {
        let mut robot = Watched::at_start(RATE).frozen(joints, 70);
        let report = run(settings(RATE), &mut robot);
        assert!(
            matches!(report.end, End::Stopped(StopReason::Encoder(EncoderFault::Frozen { .. }))),
            "{report}"
        );
        robot.assert_stopped_safely();
    }
}

#[test]
fn a_single_jump_is_bridged_a_lasting_one_stops() {
    for (last, finished) in [(75, true), (1000, false)] {
        let mut robot = Watched::at_start(RATE).with_fault(move |k, mut reading| {
            if (75..=last).contains(&k) {
                reading.positions[1] += 0.7;
            }
            Some(reading)
        });
        let report = run(settings(RATE), &mut robot);
        if finished {
            assert_eq!(report.end, End::Finished, "{report}");
            assert_eq!(report.counts.jumps, 1);
        } else {
            assert!(
                matches!(report.end, End::Stopped(StopReason::Encoder(EncoderFault::Jump { joint: 1, .. }))),
                "{report}"
            );
        }
        robot.assert_stopped_safely();
    }
}

/// One in five measurements and one in five inputs. Four losses in a row stop the arm, which some seeds have.
#[test]
fn a_fifth_of_the_frames_may_be_lost() {
    let mut finished = 0;
    for seed in 0..20 {
        let mut robot = Watched::new(RATE, plant_at(START, lossy(seed)));
        let report = run(settings(RATE), &mut robot);
        match report.end {
            End::Finished => {
                finished += 1;
                assert!(report.counts.missing > 15, "{report}");
                assert_eq!(
                    report.counts.controller_faults, 0,
                    "a lost frame is no fault of the controller: {report}"
                );
                robot.assert_at_end(5e-3);
            }
            End::Stopped(StopReason::NoMeasurement) => {}
            _ => panic!("{report}"),
        }
        robot.assert_stopped_safely();
    }
    assert!(finished >= 10, "{finished} of 20");
}

#[test]
fn three_periods_of_silence_are_bridged_four_stop() {
    for silence in [3, 4] {
        let mut robot = Watched::at_start(RATE)
            .with_fault(move |k, reading| (!(70..70 + silence).contains(&k)).then_some(reading));
        let report = run(settings(RATE), &mut robot);
        assert_eq!(report.counts.missing, silence);
        assert_eq!(report.counts.held, 3);
        assert_eq!(report.counts.controller_faults, 0);
        if silence == 3 {
            assert_eq!(report.end, End::Finished, "{report}");
            robot.assert_at_end(5e-3);
        } else {
            assert_eq!(report.end, End::Stopped(StopReason::NoMeasurement));
        }
        robot.assert_stopped_safely();
    }
}

#[test]
fn an_infeasible_start_is_refused_with_brakes_engaged() {
    let start = |positions, settings| {
        let mut robot = Watched::new(RATE, plant_at(positions, plant_options()));
        let report = run(settings, &mut robot);
        assert_eq!(robot.releases, 0, "{report}");
        assert_eq!(report.brakes, Brakes::Engaged);
        let before = robot.state().0;
        robot.clock.advance(Duration::from_secs(2));
        let _ = gelenk_runtime::transport::Transport::read(&mut robot);
        assert!(robot.robot.plant().is_braked());
        for i in 0..2 {
            assert!((robot.state().0[i] - before[i]).abs() < 1e-6, "it stands");
        }
        report.end
    };
    let end = start([-1.1, 0.4], settings(RATE));
    assert!(matches!(end, End::Refused(Refusal::Limit(LimitFault::Position { joint: 0, .. }))), "{end}");
    let end = start([-0.6, 0.3], settings(RATE));
    assert!(matches!(end, End::Refused(Refusal::Start { joint: 1, .. })), "{end}");
    let end = start(
        [f64::from(-0.6_f32), 0.4],
        LoopSettings { input_limits: [[-0.05, 0.05], [-0.5, 0.5]], ..settings(RATE) },
    );
    assert!(matches!(end, End::Refused(Refusal::Torque { input: 0, .. })), "{end}");
}

#[test]
fn a_robot_that_never_answers_is_refused() {
    let mut robot = Watched::at_start(RATE).with_fault(|_, _| None);
    let report = run(settings(RATE), &mut robot);
    assert_eq!(report.end, End::Refused(Refusal::NoMeasurement));
    assert_eq!(robot.releases, 0);
    robot.assert_stopped_safely();
}

/// The controller computes for 100 ms: the plant moves on with what it has, and so does the clock.
#[test]
fn a_stall_of_100_ms_is_survived() {
    for (rate, hold, finished) in [(50.0, 3, false), (50.0, 5, true), (200.0, 3, false)] {
        let mut robot = Watched::at_start(rate);
        let clock = robot.clock.clone();
        let mut controller = Troubled::new(move |step| {
            if step == (1.4 * rate) as u64 {
                clock.advance(Duration::from_millis(100));
            }
            None
        });
        controller.sound = pd(rate);
        let settings = LoopSettings { hold_periods: hold, ..settings(rate) };
        let report = loop_with(settings, controller, &mut robot).run();
        if finished {
            assert_eq!(report.end, End::Finished, "{report}");
            assert_eq!(report.counts.deadline_misses, 5);
            assert_eq!(report.counts.longest_miss, 5);
            assert_eq!(report.counts.periods, periods(rate) + 2 - 4);
            robot.assert_at_end(5e-3);
        } else {
            assert_eq!(report.end, End::Stopped(StopReason::DeadlineMissed));
            assert_eq!(report.counts.budget_overruns[1], 1, "of the controller");
        }
        robot.assert_stopped_safely();
    }
}

/// The same stall in the sleep of the loop's thread.
#[test]
fn a_late_wake_up_of_100_ms_is_survived() {
    for (hold, end) in [(3, End::Stopped(StopReason::DeadlineMissed)), (5, End::Finished)] {
        let mut robot = Watched::at_start(RATE);
        let settings = LoopSettings { hold_periods: hold, ..settings(RATE) };
        let late = [1400, 100].map(Duration::from_millis);
        let report = run_oversleeping(settings, pd(RATE), &mut robot, late);
        assert_eq!(report.end, end, "{report}");
        assert_eq!(report.counts.deadline_misses, 5);
        assert_eq!(report.counts.latest_wake, Duration::from_millis(100));
        robot.assert_stopped_safely();
    }
}

#[test]
fn a_failing_controller_is_replaced_by_its_plan_then_by_feed_forward_pd() {
    let mut robot = Watched::at_start(RATE);
    let failing = Troubled::new(|step| {
        (60..75).contains(&step).then_some(Err(ControllerFault::NoSolution { iterations: 30 }))
    });
    let report = loop_with(settings(RATE), failing, &mut robot).run();
    assert_eq!(report.end, End::Finished, "{report}");
    assert_eq!(report.counts.controller_faults, 15);
    assert_eq!(report.counts.plan, 3, "as long as the plan is");
    assert_eq!(report.counts.fallback, 12);
    robot.assert_at_end(5e-3);
    robot.assert_stopped_safely();
}

#[test]
fn a_controller_that_stays_broken_stops_the_arm_on_its_path() {
    for broken in [Err(ControllerFault::NotFinite), Ok(Command { inputs: [f64::NAN, 0.0], iterations: 1 })] {
        let mut robot = Watched::at_start(RATE);
        let failing = Troubled::new(move |step| (step >= 40).then_some(broken));
        let report = loop_with(settings(RATE), failing, &mut robot).run();
        assert_eq!(report.end, End::Stopped(StopReason::Controller(ControllerFault::NotFinite)), "{report}");
        let counts = report.counts;
        assert_eq!((counts.controller, counts.plan), (40, 3));
        // 22 as fallback, then the controlled stop of half a second.
        assert!(counts.fallback >= 22 + 25, "{report}");
        assert_on_path(&robot);
        robot.assert_stopped_safely();
    }
}

/// The path from start to end is a straight line in the joints.
fn assert_on_path(robot: &Watched) {
    let (positions, _) = robot.state();
    let part = |i: usize| (positions[i] - START[i]) / (END[i] - START[i]);
    assert!((0.05..0.95).contains(&part(0)), "on the way: {positions:?}");
    assert!((part(0) - part(1)).abs() < 0.02, "{positions:?}");
}

#[test]
fn inputs_beyond_the_limit_are_cut_off() {
    let mut robot = Watched::at_start(RATE);
    let wild =
        Troubled::new(|step| (step == 60).then_some(Ok(Command { inputs: [1e6, -1e6], iterations: 0 })));
    let report = loop_with(settings(RATE), wild, &mut robot).run();
    assert_eq!(report.counts.limited_inputs, 2);
    robot.assert_stopped_safely();
}

#[test]
fn drives_with_the_wrong_sign_are_stopped_at_once() {
    let mut robot = Watched::at_start(RATE);
    robot.input_sign = -1.0;
    let report = run(settings(RATE), &mut robot);
    assert!(
        matches!(report.end, End::Stopped(StopReason::Limit(LimitFault::FollowingError { .. }))),
        "{report}"
    );
    assert!(report.counts.periods < 30, "{report}");
    robot.assert_stopped_safely();
}

#[test]
fn a_trajectory_beyond_the_limits_is_stopped_inside_them() {
    let mut robot = Watched::at_start(RATE);
    let too_far = RestToRest::new(START, [LIMITS[0][1] + 0.5, 0.0], 6.0).unwrap();
    let controller =
        gelenk_runtime::control_loop::FeedForwardPd::new(law(), too_far, 1.0 / RATE, 0.01).unwrap();
    let clock = robot.clock.clone();
    let mut control = ControlLoop::new(
        settings(RATE),
        law(),
        RestToRest::new(START, [LIMITS[0][1] + 0.5, 0.0], 6.0).unwrap(),
        controller,
        &mut robot,
        clock,
    )
    .unwrap();
    let report = control.run();
    drop(control);
    assert!(
        matches!(report.end, End::Stopped(StopReason::Limit(LimitFault::Position { joint: 0, .. }))),
        "{report}"
    );
    robot.assert_stopped_safely();
}

#[test]
fn a_stop_on_request_stays_on_the_path() {
    let mut robot = Watched::at_start(RATE);
    let request = StopRequest::new();
    let raised = request.clone();
    let controller = Troubled::new(move |step| {
        if step == 70 {
            raised.raise();
        }
        None
    });
    let report = loop_with(settings(RATE), controller, &mut robot).with_stop_request(request).run();
    assert_eq!(report.end, End::Stopped(StopReason::Requested), "{report}");
    assert_eq!(report.brakes, Brakes::Engaged);
    assert_on_path(&robot);
    robot.assert_stopped_safely();
}

#[test]
fn brakes_that_the_robot_engages_end_the_run() {
    let mut robot = Watched::at_start(RATE).with_fault(|k, mut reading| {
        if k >= 70 {
            reading.brakes = Brakes::Engaged;
        }
        Some(reading)
    });
    let report = run(settings(RATE), &mut robot);
    assert_eq!(report.end, End::Stopped(StopReason::BrakedByRobot), "{report}");
    robot.assert_stopped_safely();
}

#[test]
fn a_panic_in_the_controller_engages_the_brakes() {
    let mut robot = Watched::at_start(RATE);
    let panicking = Troubled::new(|step| {
        assert!(step < 70, "a defect");
        None
    });
    let mut control = loop_with(settings(RATE), panicking, &mut robot);
    let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(move || control.run()));
    assert!(outcome.is_err());
    robot.assert_stopped_safely();
}

#[test]
fn brakes_that_take_time_to_release_are_waited_for() {
    let mut robot = Watched::at_start(RATE).with_fault(|k, mut reading| {
        // Engaged for 100 ms after the command.
        if k <= 5 {
            reading.brakes = Brakes::Engaged;
        }
        Some(reading)
    });
    let settings = LoopSettings { release_time: 0.11, ..settings(RATE) };
    let report = run(settings, &mut robot);
    assert_eq!(report.end, End::Finished, "{report}");
    assert_eq!(report.counts.controller, periods(RATE) + 6);
    robot.assert_stopped_safely();
}

#[test]
fn the_log_has_every_period_and_identification_reads_it() {
    let path = std::env::temp_dir().join(format!("gelenk_loop_{}.csv", std::process::id()));
    let (sink, writer) = log_to_file(&path, &crate::support::robot::PowerCube, 10_000).unwrap();
    let mut robot = Watched::at_start(RATE);
    let report = loop_with(settings(RATE), pd(RATE), &mut robot).with_log(sink).run();
    let summary = writer.finish().unwrap();
    assert_eq!(summary.written, report.counts.periods);
    assert_eq!(summary.dropped, 0);
    let robot = NamedRobot { names: vec!["beta".into(), "gamma".into()], ..NamedRobot::default() };
    let recording = runs(std::slice::from_ref(&path), &robot, &ColumnOptions::default()).unwrap();
    std::fs::remove_file(&path).unwrap();
    let [run] = recording.runs.try_into().unwrap();
    assert_eq!(run.times.len() as u64, report.counts.periods);
    for (k, time) in run.times.iter().enumerate() {
        assert!((time - 0.02 * k as f64).abs() < 1e-9);
    }
    let q = &run.positions[0];
    assert!((q[0] - START[0]).abs() < 1e-3 && (q[q.len() - 1] - END[0]).abs() < 5e-3);
    // Half-way it is fastest, at 15/8 of the mean speed.
    let speed = run.velocities[0].as_ref().unwrap()[125];
    assert!((speed - 1.875 * 1.4 / 5.0).abs() < 0.02, "{speed}");
    assert!(run.efforts[0].iter().all(|u| u.abs() <= 0.5));
}

#[test]
fn settings_out_of_range_are_named() {
    for (rate, message) in [
        (20.0, "setting rate of the loop is 20, but must be 50 to 1000 Hz"),
        (f64::NAN, "setting rate of the loop is NaN, but must be 50 to 1000 Hz"),
    ] {
        let mut robot = Watched::at_start(RATE);
        let clock = robot.clock.clone();
        let control: Result<WatchedLoop<'_, _, _>, _> =
            ControlLoop::new(settings(rate), law() as Law, motion(), pd(RATE), &mut robot, clock);
        assert_eq!(control.err().unwrap().to_string(), message);
    }
    assert_eq!(VirtualClock::new().now(), Duration::ZERO);
}
