//! Ctrl-C stops the arm and engages its brakes; the process lives on.

#![allow(clippy::unwrap_used, reason = "test code")]

mod support;

use gelenk_runtime::control_loop::{
    Command, ControlLoop, Controller, ControllerFault, Cycle, End, LoopReport, StopReason, StopRequest,
};
use gelenk_runtime::transport::Brakes;
use support::learning;
use support::robot::{Watched, law, motion, pd, settings};

/// Sends the signal to its own process in the middle of the motion, twice, as impatient people do.
struct Interrupting {
    sound: Box<dyn Controller<2, 2>>,
    step: u32,
    signal: i32,
}

impl Controller<2, 2> for Interrupting {
    fn reset(&mut self, positions: &[f64; 2], inputs: &[f64; 2]) {
        self.sound.reset(positions, inputs);
    }

    fn step(&mut self, cycle: &Cycle<2, 2>) -> Result<Command<2>, ControllerFault> {
        self.step += 1;
        if self.step == 100 || self.step == 101 {
            signal_hook::low_level::raise(self.signal).unwrap();
        }
        self.sound.step(cycle)
    }
}

/// One test in this file: signals are for the whole process.
#[test]
fn signals_stop_the_arm_and_engage_the_brakes() {
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        for sound in [Box::new(pd(50.0)) as Box<dyn Controller<2, 2>>, Box::new(learning::pd(50.0))] {
            interrupt(sound, signal);
        }
    }
}

fn interrupt(sound: Box<dyn Controller<2, 2>>, signal: i32) {
    let mut robot = Watched::at_start(50.0);
    let controller = Interrupting { sound, step: 0, signal };
    let clock = robot.clock.clone();
    let control = ControlLoop::new(settings(50.0), law(), motion(), controller, &mut robot, clock).unwrap();
    let report: LoopReport<2> = control.with_stop_request(StopRequest::on_signals().unwrap()).run();
    assert_eq!(report.end, End::Stopped(StopReason::Requested), "{report}");
    assert_eq!(report.brakes, Brakes::Engaged);
    assert_eq!(report.counts.controller, 100);
    robot.assert_stopped_safely();
}
