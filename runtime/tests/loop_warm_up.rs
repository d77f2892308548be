//! The loop's warm-up of its controller: when it happens, and that no period begins later for it.

#![allow(clippy::unwrap_used, reason = "test code")]

use super::{Pd, pd};
use crate::support::robot::{Watched, loop_with, settings};
use gelenk_runtime::control_loop::{
    Clock, Command, Controller, ControllerFault, Cycle, End, LoopReport, LoopSettings, VirtualClock,
};
use std::sync::{Arc, Mutex};
use std::time::Duration;

const RATE: f64 = 50.0;
const LEAD: f64 = 2e-3;

/// A controller whose warm-ups take as long as `takes` says, by their number.
struct Slow<F> {
    sound: Pd,
    clock: VirtualClock,
    takes: F,
    warm_ups: u64,
    /// When warm-ups began and steps happened.
    seen: Arc<Mutex<Vec<(char, Duration)>>>,
}

impl<F: FnMut(u64) -> Duration> Controller<2, 2> for Slow<F> {
    fn reset(&mut self, positions: &[f64; 2], inputs: &[f64; 2]) {
        self.sound.reset(positions, inputs);
    }

    fn step(&mut self, cycle: &Cycle<2, 2>) -> Result<Command<2>, ControllerFault> {
        self.seen.lock().unwrap().push(('s', self.clock.now()));
        self.sound.step(cycle)
    }

    fn warm_up(&mut self, next: &Cycle<2, 2>) {
        assert!(next.positions.is_some_and(|y| y.iter().all(|y| y.is_finite())));
        assert_eq!(next.periods, 1);
        self.seen.lock().unwrap().push(('w', self.clock.now()));
        self.clock.advance((self.takes)(self.warm_ups));
        self.warm_ups += 1;
    }
}

type Seen = Vec<(char, Duration)>;

fn run(warm_up: f64, takes: impl FnMut(u64) -> Duration) -> (LoopReport<2>, Seen) {
    let mut robot = Watched::at_start(RATE);
    let seen = Arc::default();
    let controller =
        Slow { sound: pd(RATE), clock: robot.clock.clone(), takes, warm_ups: 0, seen: Arc::clone(&seen) };
    let settings = LoopSettings { warm_up, ..settings(RATE) };
    let report = loop_with(settings, controller, &mut robot).run();
    assert_eq!(report.end, End::Finished, "{report}");
    robot.assert_at_end(5e-3);
    let seen = seen.lock().unwrap().clone();
    (report, seen)
}

/// Times modulo the period, from the first step on.
fn phases(seen: &Seen) -> Vec<(char, Duration)> {
    let period = Duration::from_millis(20);
    let origin = seen.iter().find(|(what, _)| *what == 's').unwrap().1;
    seen.iter()
        .skip_while(|(what, _)| *what == 'w')
        .map(|(what, time)| {
            let since = (*time - origin).as_nanos() % period.as_nanos();
            (*what, Duration::from_nanos(since as u64))
        })
        .collect()
}

#[test]
fn it_fits_before_each_period() {
    let (report, seen) = run(LEAD, |_| Duration::from_micros(1900));
    let counts = report.counts;
    assert_eq!(counts.warm_ups, counts.controller + 2);
    assert_eq!((counts.late_warm_ups, counts.latest_wake), (0, Duration::ZERO));
    for (what, phase) in phases(&seen) {
        let expected = if what == 's' { 0 } else { 18 };
        assert_eq!(phase, Duration::from_millis(expected), "{what}");
    }
    let (report, seen) = run(0.0, |_| unreachable!());
    assert_eq!(report.counts.warm_ups, 0);
    assert!(seen.iter().all(|(what, _)| *what == 's'));
}

/// One that takes too long is found out before the brakes are released: no period begins late.
#[test]
fn one_that_does_not_fit_is_left_out_from_the_start() {
    let (report, seen) = run(LEAD, |_| Duration::from_millis(3));
    let counts = report.counts;
    assert_eq!((counts.warm_ups, counts.late_warm_ups), (1, 1));
    assert_eq!(counts.latest_wake, Duration::ZERO);
    assert_eq!(seen.iter().filter(|(what, _)| *what == 'w').count(), 1);
    assert!(report.to_string().ends_with("and were disabled after warm-up 1"), "{report}");
}

/// One that becomes slow in the middle delays its period once, and is left out from then on.
#[test]
fn one_that_becomes_slow_is_left_out_from_then_on() {
    let (report, _) = run(LEAD, |k| Duration::from_micros(if k < 100 { 100 } else { 2500 }));
    let counts = report.counts;
    assert_eq!((counts.warm_ups, counts.late_warm_ups), (101, 1));
    assert_eq!(counts.latest_wake, Duration::from_micros(500));
    assert_eq!(counts.deadline_misses, 0);
}

/// A period that takes nearly all of its time leaves none for the next one's warm-up.
#[test]
fn where_there_is_no_time_there_is_none() {
    struct Busy(Slow<fn(u64) -> Duration>);
    impl Controller<2, 2> for Busy {
        fn reset(&mut self, positions: &[f64; 2], inputs: &[f64; 2]) {
            self.0.reset(positions, inputs);
        }
        fn step(&mut self, cycle: &Cycle<2, 2>) -> Result<Command<2>, ControllerFault> {
            let command = self.0.step(cycle);
            self.0.clock.advance(Duration::from_millis(19));
            command
        }
        fn warm_up(&mut self, next: &Cycle<2, 2>) {
            self.0.warm_up(next);
        }
    }
    let mut robot = Watched::at_start(RATE);
    let busy = Busy(Slow {
        sound: pd(RATE),
        clock: robot.clock.clone(),
        takes: |_| Duration::from_micros(100),
        warm_ups: 0,
        seen: Arc::default(),
    });
    let report = loop_with(settings(RATE), busy, &mut robot).run();
    assert_eq!(report.end, End::Finished, "{report}");
    // At the start, and before the first period.
    assert_eq!(report.counts.warm_ups, 2);
    assert_eq!(report.counts.latest_wake, Duration::ZERO);
}

#[test]
fn its_time_is_at_most_half_a_period() {
    for warm_up in [-1e-3, 0.0101, f64::NAN, f64::INFINITY] {
        let mut robot = Watched::at_start(RATE);
        let clock = robot.clock.clone();
        let settings = LoopSettings { warm_up, ..settings(RATE) };
        let refused = gelenk_runtime::control_loop::ControlLoop::<_, _, _, _, _, 2, 2>::new(
            settings,
            crate::support::robot::law(),
            crate::support::robot::motion(),
            pd(RATE),
            &mut robot,
            clock,
        );
        assert_eq!(
            refused.err().unwrap().to_string(),
            format!("setting warm_up of the loop is {warm_up}, but must be 0 to half a period (s)")
        );
    }
}
