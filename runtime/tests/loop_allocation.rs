//! The loop allocates when it is made, not when it runs: in process, over UDP, with its log.

#![allow(clippy::unwrap_used, reason = "test code")]

use crate::allocations;
use crate::support::learning;
use crate::support::robot::{END, PowerCube, START, law, pd_of, plant_at, plant_options, settings};
use gelenk_runtime::control_loop::{
    Clock, ControlLoop, Controller, LoopSettings, MonotonicClock, VirtualClock, log_to,
};
use gelenk_runtime::trajectory::RestToRest;
use gelenk_runtime::transport::{InProcess, Pace, PlantServer, ServerOptions, Transport, UdpTransport};
use std::time::Duration;

const RATE: f64 = 1000.0;

/// Long enough for 10 000 periods.
fn motion() -> RestToRest<2> {
    RestToRest::new(START, END, 12.0).unwrap()
}

fn controller() -> impl Controller<2, 2> {
    pd_of(PowerCube, motion(), RATE)
}

/// Plain, and learning friction and a load.
fn controllers() -> [Box<dyn Controller<2, 2>>; 3] {
    let friction = || learning::made(RATE, |model| pd_of(model, motion(), RATE));
    [Box::new(controller()), Box::new(friction()), Box::new(learning::carrying(friction()))]
}

/// Allocations in `periods` periods, and records written and dropped.
fn allocations_of(
    mut controller: Box<dyn Controller<2, 2>>,
    transport: impl Transport<2, 2>,
    clock: VirtualClock,
    periods: u64,
) -> (u64, u64) {
    let (sink, writer) = log_to(std::io::sink(), &PowerCube, 20_000).unwrap();
    let settings = LoopSettings {
        // A machine that stalls the server for long shall not end this.
        hold_periods: 1_000_000,
        ..settings(RATE)
    };
    let mut control = ControlLoop::new(settings, law(), motion(), &mut *controller, transport, clock)
        .unwrap()
        .with_log(sink);
    let before = allocations::count();
    control.start().unwrap();
    for _ in 0..periods {
        assert!(control.period());
    }
    let counted = allocations::count() - before;
    drop(control);
    let summary = writer.finish().unwrap();
    (counted, summary.written + summary.dropped)
}

#[test]
fn ten_thousand_periods_in_process_do_not_allocate() {
    for controller in controllers() {
        let clock = VirtualClock::new();
        let plant = plant_at(START, plant_options());
        let robot = InProcess::new(plant, clock.clone(), Duration::from_millis(1));
        assert_eq!(allocations_of(controller, robot, clock, 10_000), (0, 10_000));
    }
}

#[test]
fn two_thousand_periods_over_udp_do_not_allocate() {
    let options = ServerOptions { period: 1.0 / RATE, pace: Pace::LockStep, ..ServerOptions::default() };
    let plant = plant_at(START, plant_options());
    let mut server = PlantServer::bind(plant, "127.0.0.1:0", options).unwrap();
    let address = server.local_address().unwrap();
    let serving = std::thread::spawn(move || server.serve(Duration::from_secs(1)));
    let link: UdpTransport<2, 2> = UdpTransport::connect(address, Duration::from_secs(30)).unwrap();
    assert_eq!(allocations_of(Box::new(controller()), link, VirtualClock::new(), 2000), (0, 2000));
    serving.join().unwrap().unwrap();
}

/// The real clock, too; three periods are enough to see whether it does.
#[test]
fn sleeping_does_not_allocate() {
    let clock = MonotonicClock;
    let before = allocations::count();
    for _ in 0..3 {
        clock.sleep_until(clock.now() + Duration::from_millis(1));
    }
    assert_eq!(allocations::count() - before, 0);
}

/// Nor does what the loop computes for the caches.
#[test]
fn warm_ups_do_not_allocate() {
    use gelenk_runtime::control_loop::Cycle;
    use gelenk_runtime::mpc::{LtvMpc, MpcOptions, Nmpc};
    let options = || MpcOptions::new(&PowerCube, 0.02, 5);
    let controllers: [Box<dyn Controller<2, 2>>; 3] = [
        Box::new(controller()),
        Box::new(LtvMpc::new(PowerCube, motion(), options()).unwrap()),
        Box::new(Nmpc::new(PowerCube, motion(), options()).unwrap()),
    ];
    for mut controller in controllers {
        controller.reset(&START, &[0.0; 2]);
        let next = Cycle { positions: Some(START), ..Cycle::default() };
        let before = allocations::count();
        for _ in 0..3 {
            controller.warm_up(&next);
        }
        assert_eq!(allocations::count() - before, 0);
    }
}
