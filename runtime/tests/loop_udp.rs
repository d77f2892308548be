//! The loop against a plant process, a program of its own, over UDP. Loop and plant move in lock-step on
//! virtual time, so that a busy machine makes these tests slow, but not fail; assertions are on the plant's
//! own state.

#![allow(clippy::unwrap_used, reason = "test code")]

use super::{Pd, pd};
use crate::support::example::program;
use crate::support::plant_process::PlantProcess;
use crate::support::robot::{END, LIMITS, PowerCube, START, Watched, law, motion, settings};
use gelenk_runtime::control_loop::{
    ControlLoop, End, FeedForwardPd, LoopReport, LoopSettings, MonotonicClock, Refusal, StopReason,
    VirtualClock,
};
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::transport::datagram::TrueState;
use gelenk_runtime::transport::{Brakes, Transport, TransportError, UdpTransport};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::net::{SocketAddr, UdpSocket};
use std::time::Duration;

/// Nothing moves while a controller waits, so this may be long.
const PATIENCE: Duration = Duration::from_secs(30);
const RATE: f64 = 50.0;

type Link = UdpTransport<2, 2>;
type Loop<'a> = ControlLoop<
    crate::support::robot::Law,
    gelenk_runtime::trajectory::RestToRest<2>,
    Pd,
    &'a mut Link,
    VirtualClock,
    2,
    2,
>;

fn start(arguments: &[&str]) -> PlantProcess {
    let mut all = vec!["--lock-step"];
    all.extend(arguments);
    PlantProcess::start(&program("plant_process"), &all)
}

fn connect(address: SocketAddr) -> Link {
    UdpTransport::connect(address, PATIENCE).unwrap()
}

fn control(link: &mut Link, settings: LoopSettings<2, 2>) -> Loop<'_> {
    let clock = VirtualClock::new();
    ControlLoop::new(settings, law(), motion(), pd(RATE), link, clock).unwrap()
}

fn run(link: &mut Link) -> LoopReport<2> {
    control(link, settings(RATE)).run()
}

/// The true state two seconds later: within limits, braked, at rest.
fn assert_stopped_safely(link: &mut Link) -> TrueState<2> {
    for _ in 0..100 {
        let _ = link.read();
    }
    let (state, brakes) = link.inspect().unwrap().unwrap();
    assert_eq!(brakes, Brakes::Engaged);
    let speeds = PowerCube.limits().velocity;
    for i in 0..2 {
        assert!(state.velocities[i].abs() < 1e-6, "{state:?}");
        assert!(state.lowest[i] >= LIMITS[i][0] && state.highest[i] <= LIMITS[i][1]);
        assert!(state.fastest[i] <= speeds[i], "{state:?}");
    }
    state
}

#[test]
fn over_udp_the_motion_is_the_same_as_in_process() {
    let plant = start(&[]);
    let mut link = connect(plant.address);
    let report = run(&mut link);
    assert_eq!(report.end, End::Finished, "{report}");
    let there = assert_stopped_safely(&mut link);
    let mut robot = Watched::at_start(RATE);
    let clock = robot.clock.clone();
    // The process begins with its brakes engaged, and in lock-step its first query already lets a period
    // pass.
    robot.brake().unwrap();
    clock.advance(Duration::from_millis(20));
    let here: LoopReport<2> =
        ControlLoop::new(settings(RATE), law(), motion(), pd(RATE), &mut robot, clock).unwrap().run();
    robot.assert_stopped_safely();
    assert_eq!(report, here);
    assert_eq!(there.positions, robot.state().0, "bit for bit");
    for i in 0..2 {
        assert!((there.positions[i] - END[i]).abs() < 5e-3);
    }
}

#[test]
fn a_fifth_of_the_datagrams_may_be_lost() {
    let mut finished = 0;
    for seed in ["1", "2", "3", "4", "5", "6"] {
        let plant = start(&["--loss", "0.2", "--seed", seed]);
        let mut link = connect(plant.address);
        let report = run(&mut link);
        match report.end {
            End::Finished => {
                finished += 1;
                assert!(report.counts.missing > 20, "{report}");
            }
            // Four measurements lost in a row, or six inputs, which the plant's watchdog does not bear.
            End::Stopped(StopReason::NoMeasurement | StopReason::BrakedByRobot) => {}
            _ => panic!("{report}"),
        }
        assert_stopped_safely(&mut link);
    }
    assert!(finished >= 2, "{finished} of 6");
}

#[test]
fn three_periods_of_silence_are_bridged_longer_ones_stop() {
    for (silence, end) in [("100,103", End::Finished), ("100,120", End::Stopped(StopReason::NoMeasurement))] {
        let plant = start(&["--silence", silence]);
        let mut link = connect(plant.address);
        let report = run(&mut link);
        assert_eq!(report.end, end, "{report}");
        assert_stopped_safely(&mut link);
    }
}

/// The operating system refuses the datagrams to a port that no program has open.
#[test]
fn a_loop_does_not_start_without_a_plant() {
    let address = start(&[]).kill();
    let report = run(&mut connect(address));
    assert_eq!(report.end, End::Refused(Refusal::Transport(TransportError::NoAnswer)), "{report}");
    let tries = u64::from(settings(RATE).start_periods) + 1;
    let errors = report.counts.transport_errors;
    assert!(errors >= tries && report.counts.missing == 0, "{report}");
    assert_eq!((report.counts.periods, report.brakes), (0, Brakes::Unknown), "{report}");
    let text = report.to_string();
    let reason = "the start was refused: the program at the robot does not answer. Check that it runs, has the same \
                  version and has the given address; brakes unknown; check the robot";
    assert!(text.starts_with(reason), "{text}");
    assert!(text.contains(&format!("{errors} transport errors")), "{text}");
}

/// The plant dies in the middle of the motion; a new one comes up after the loop gave up, braked, and stays
/// so.
#[test]
fn a_killed_plant_stops_the_loop_and_comes_back_braked() {
    let plant = start(&[]);
    let mut link = connect(plant.address);
    let mut control = control(&mut link, settings(RATE));
    control.start().unwrap();
    for _ in 0..80 {
        assert!(control.period());
    }
    let address = plant.kill();
    while control.period() {}
    let report = control.report();
    drop(control);
    assert_eq!(report.end, End::Stopped(StopReason::Transport(TransportError::NoAnswer)));
    assert_eq!(report.counts.held, 3, "{report}");
    assert_eq!(report.brakes, Brakes::Unknown, "nobody confirmed them");
    assert!(report.to_string().contains("the program at the robot does not answer"), "{report}");
    assert!(report.to_string().contains("brakes unknown; check the robot"), "{report}");

    let port = address.port().to_string();
    let _restarted = start(&["--port", &port]);
    assert_eq!(link.read(), Err(TransportError::Restarted));
    let state = assert_stopped_safely(&mut link);
    assert_eq!(state.positions, START);
}

/// The plant dies and is back within the three periods that the loop bridges: it must not be driven on.
#[test]
fn a_plant_that_restarts_at_once_is_not_driven_on() {
    let plant = start(&[]);
    let mut link = connect(plant.address);
    let mut control = control(&mut link, settings(RATE));
    control.start().unwrap();
    for _ in 0..80 {
        assert!(control.period());
    }
    let port = plant.kill().port().to_string();
    assert!(control.period(), "one period without it");
    let _restarted = start(&["--port", &port]);
    while control.period() {}
    let report = control.report();
    drop(control);
    assert_eq!(report.end, End::Stopped(StopReason::Restarted), "{report}");
    assert_eq!(report.brakes, Brakes::Engaged);
    assert_eq!(assert_stopped_safely(&mut link).positions, START);

    // Once more, from the start.
    let report = run(&mut link);
    assert_eq!(report.end, End::Finished, "{report}");
    assert_stopped_safely(&mut link);
}

/// The controller dies instead: the plant's own watchdog brakes.
#[test]
fn a_plant_without_a_controller_brakes() {
    let plant = start(&["--watchdog", "5"]);
    let mut link = connect(plant.address);
    let mut control = control(&mut link, settings(RATE));
    control.start().unwrap();
    for _ in 0..80 {
        assert!(control.period());
    }
    // What a killed process does: nothing, not even its destructors.
    std::mem::forget(control);
    let mut observer = connect(plant.address);
    assert_stopped_safely(&mut observer);
}

/// On the real clock. A busy machine may miss deadlines and stop the motion early; the arm is safe either
/// way.
#[test]
fn in_real_time_the_arm_ends_braked_and_at_rest() {
    let plant = PlantProcess::start(&program("plant_process"), &[]);
    let mut link: Link = UdpTransport::connect(plant.address, Duration::from_millis(5)).unwrap();
    let near = START.map(|y| y + 0.02);
    let motion = gelenk_runtime::trajectory::RestToRest::new(START, near, 0.3).unwrap();
    let mut control = ControlLoop::new(
        settings(RATE),
        law(),
        motion,
        FeedForwardPd::new(law(), motion, 1.0 / RATE, 0.01).unwrap(),
        &mut link,
        MonotonicClock,
    )
    .unwrap();
    let report = control.run();
    drop(control);
    assert!(!matches!(report.end, End::Running | End::Stopped(StopReason::Limit(_))), "{report}");
    // Patient: the process may be the one that is kept waiting.
    let mut observer: Link = connect(plant.address);
    let at_rest = |state: &TrueState<2>| state.velocities.iter().all(|v| v.abs() < 1e-6);
    let stopped = (0..500).find_map(|_| {
        std::thread::sleep(Duration::from_millis(20));
        let (state, brakes) = observer.inspect().unwrap()?;
        (brakes == Brakes::Engaged && at_rest(&state)).then_some(state)
    });
    let state = stopped.expect("braked and at rest within 10 s");
    for i in 0..2 {
        assert!(state.lowest[i] >= LIMITS[i][0] && state.highest[i] <= LIMITS[i][1]);
    }
}

/// Noise from another socket before and during the motion.
#[test]
fn arbitrary_datagrams_disturb_nothing() {
    let plant = start(&[]);
    let noise = UdpSocket::bind("127.0.0.1:0").unwrap();
    noise.connect(plant.address).unwrap();
    let mut generator = ChaCha8Rng::seed_from_u64(1);
    let mut disturb = |datagrams: usize| {
        for _ in 0..datagrams {
            let mut bytes = vec![0; generator.random_range(0..100)];
            generator.fill_bytes(&mut bytes);
            if bytes.len() > 8 && generator.random_bool(0.5) {
                bytes[..8].copy_from_slice(b"GLNK\x01\x02\x02\x02");
            }
            let _ = noise.send(&bytes);
        }
    };
    let mut link = connect(plant.address);
    let mut control = control(&mut link, settings(RATE));
    disturb(50);
    control.start().unwrap();
    while control.period() {
        disturb(5);
    }
    let report = control.report();
    drop(control);
    assert_eq!(report.end, End::Finished, "{report}");
    assert_eq!(report.counts.missing, 0);
    assert_stopped_safely(&mut link);
}

/// Answers that are late, damaged, foreign or doubled are dropped, and the one that fits is taken.
#[test]
fn only_the_answer_to_the_question_is_a_reading() {
    use gelenk_runtime::transport::datagram::{Datagram, MAX_DATAGRAM, Message};
    let robot = UdpSocket::bind("127.0.0.1:0").unwrap();
    let mut link: Link = connect(robot.local_addr().unwrap());
    let answering = std::thread::spawn(move || {
        let mut buffer = [0; MAX_DATAGRAM];
        for _ in 0..4 {
            let (length, from) = robot.recv_from(&mut buffer).unwrap();
            let question = Datagram::<2, 2>::decode(&buffer[..length]).unwrap();
            let answer = |sequence, position| Datagram::<2, 2> {
                connection: 1,
                sequence,
                brakes: Brakes::Released,
                message: match question.message {
                    Message::Connect => Message::Connect,
                    _ => Message::Measured { positions: [position; 2], velocities: None, torques: None },
                },
            };
            let send = |datagram: Datagram<2, 2>| {
                let mut buffer = [0; MAX_DATAGRAM];
                robot.send_to(datagram.encode(&mut buffer).unwrap(), from).unwrap();
            };
            send(answer(question.sequence.wrapping_sub(1), 9.0));
            send(answer(question.sequence.wrapping_add(1), 9.0));
            robot.send_to(b"", from).unwrap();
            robot.send_to(&[0x47; 4000], from).unwrap();
            let mut damaged = [0; MAX_DATAGRAM];
            let length = answer(question.sequence, 9.0).encode(&mut damaged).unwrap().len();
            damaged[30] ^= 1;
            robot.send_to(&damaged[..length], from).unwrap();
            send(answer(question.sequence, 0.5));
            send(answer(question.sequence, 0.5));
        }
    });
    for _ in 0..3 {
        let reading = link.read().unwrap().unwrap();
        assert_eq!(reading.positions, [0.5; 2]);
    }
    answering.join().unwrap();
}

#[test]
fn inputs_that_are_not_finite_are_not_sent() {
    let robot = UdpSocket::bind("127.0.0.1:0").unwrap();
    robot.set_nonblocking(true).unwrap();
    let mut link: Link = connect(robot.local_addr().unwrap());
    assert_eq!(link.write(&[0.0, f64::NAN]), Err(TransportError::Input { input: 1 }));
    assert!(robot.recv(&mut [0; 100]).is_err(), "nothing arrived");
}

type Server = gelenk_runtime::transport::PlantServer<PowerCube, 2, 2>;

fn server(options: gelenk_runtime::transport::ServerOptions) -> Server {
    let plant = crate::support::robot::plant_at(START, gelenk_runtime::plant::PlantOptions::default());
    Server::bind(plant, "127.0.0.1:0", options).unwrap()
}

/// A valid datagram of 1e308 N m is a breakdown of the robot, which a controller learns as its restart; the
/// process goes on.
#[test]
fn inputs_that_no_simulation_bears_do_not_end_the_server() {
    use gelenk_runtime::transport::{Pace, ServerOptions};
    let mut server = server(ServerOptions { pace: Pace::LockStep, ..ServerOptions::default() });
    let address = server.local_address().unwrap();
    let serving = std::thread::spawn(move || {
        server.serve(Duration::from_secs(1)).unwrap();
        server
    });
    let mut link = connect(address);
    link.release().unwrap();
    assert_eq!(link.read().unwrap().unwrap().brakes, Brakes::Released);
    for inputs in [[1e308, -1e308], [0.0, 1e200]] {
        link.write(&inputs).unwrap();
        assert_eq!(link.read(), Err(TransportError::Restarted), "{inputs:?}");
        let reading = link.read().unwrap().unwrap();
        assert_eq!(reading.brakes, Brakes::Engaged);
        for i in 0..2 {
            assert!((reading.positions[i] - START[i]).abs() < 0.1, "where it was");
        }
        link.release().unwrap();
        assert!(link.read().unwrap().is_some(), "and it can go on");
    }
    let server = serving.join().unwrap();
    assert_eq!(server.breakdowns(), 2);
    let reason = server.last_breakdown().unwrap().to_string();
    assert!(reason.starts_with("the integration stopped at"), "{reason}");
    let (positions, velocities) = server.plant().state();
    assert!(positions.iter().chain(&velocities).all(|x| x.is_finite()));
}

/// In the loop it is a stop with the brakes engaged.
#[test]
fn a_robot_that_breaks_down_stops_the_loop() {
    use gelenk_runtime::control_loop::{Command, Controller, ControllerFault, Cycle};
    use gelenk_runtime::transport::{Pace, ServerOptions};
    struct Wild(Pd);
    impl Controller<2, 2> for Wild {
        fn reset(&mut self, positions: &[f64; 2], inputs: &[f64; 2]) {
            self.0.reset(positions, inputs);
        }
        fn step(&mut self, cycle: &Cycle<2, 2>) -> Result<Command<2>, ControllerFault> {
            let mut command = self.0.step(cycle)?;
            if cycle.time > 1.0 {
                command.inputs[1] = 1e300;
            }
            Ok(command)
        }
    }
    let mut server = server(ServerOptions { pace: Pace::LockStep, ..ServerOptions::default() });
    let address = server.local_address().unwrap();
    let serving = std::thread::spawn(move || server.serve(Duration::from_secs(1)));
    let mut link = connect(address);
    // Limits that do not stop it before.
    let settings = LoopSettings { input_limits: [[f64::NEG_INFINITY, f64::INFINITY]; 2], ..settings(RATE) };
    let mut control =
        ControlLoop::new(settings, law(), motion(), Wild(pd(RATE)), &mut link, VirtualClock::new()).unwrap();
    let report = control.run();
    drop(control);
    assert_eq!(report.end, End::Stopped(StopReason::Restarted), "{report}");
    assert_eq!(report.brakes, Brakes::Engaged);
    serving.join().unwrap().unwrap();
}

#[test]
fn waits_without_an_end_are_refused() {
    let address = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    for timeout in [Duration::ZERO, Duration::MAX, Duration::from_secs(3601)] {
        let refused = Link::connect(address, timeout).err().unwrap();
        assert_eq!(refused.kind(), std::io::ErrorKind::InvalidInput);
        assert!(refused.to_string().contains("must be positive and at most one hour"), "{refused}");
    }
    let mut link = Link::connect(address, Duration::from_nanos(1)).unwrap();
    assert!(!matches!(link.read(), Ok(Some(_))), "nobody is there");
}

#[test]
fn options_of_a_server_are_checked() {
    use gelenk_runtime::transport::{PlantServer, ServerOptions};
    let refused = |options: ServerOptions| {
        let plant = crate::support::robot::plant_at(START, gelenk_runtime::plant::PlantOptions::default());
        let refused: Result<PlantServer<_, 2, 2>, _> = PlantServer::bind(plant, "127.0.0.1:0", options);
        refused.err().unwrap().to_string()
    };
    for period in [f64::NAN, 0.0, -0.02, 5e-324, 1e-7, 61.0, 1e300, f64::INFINITY] {
        let message = refused(ServerOptions { period, ..ServerOptions::default() });
        assert_eq!(message, format!("server option period is {period}, but must be 1e-6 to 60 s"));
    }
    for loss in [f64::NAN, -0.1, 1.1] {
        let message = refused(ServerOptions { loss, ..ServerOptions::default() });
        assert!(message.contains("a probability"), "{message}");
    }
}

/// A machine that cannot keep up, or slept for a day: the server answers all the same.
#[test]
fn a_server_that_is_behind_its_clock_goes_on() {
    use gelenk_runtime::transport::ServerOptions;
    let mut server = server(ServerOptions { period: 1e-6, ..ServerOptions::default() });
    std::thread::sleep(Duration::from_millis(20));
    let address = server.local_address().unwrap();
    let answered = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(false));
    let done = std::sync::Arc::clone(&answered);
    let serving = std::thread::spawn(move || {
        while !done.load(std::sync::atomic::Ordering::Relaxed) {
            server.serve_one().unwrap();
        }
    });
    let mut link = connect(address);
    assert!(link.read().unwrap().is_some());
    answered.store(true, std::sync::atomic::Ordering::Relaxed);
    serving.join().unwrap();
}

/// Measurements of drives arrive through the socket.
#[test]
fn velocities_and_torques_come_over_udp() {
    use gelenk_runtime::transport::{Pace, PlantServer, ServerOptions};
    let measuring = gelenk_runtime::plant::PlantOptions {
        velocity_noise: Some([0.0; 2]),
        torque_noise: Some([0.0; 2]),
        ..crate::support::robot::plant_options()
    };
    let plant = crate::support::robot::plant_at(START, measuring);
    let options = ServerOptions { pace: Pace::LockStep, ..ServerOptions::default() };
    let mut server: PlantServer<PowerCube, 2, 2> = PlantServer::bind(plant, "127.0.0.1:0", options).unwrap();
    let address = server.local_address().unwrap();
    let serving = std::thread::spawn(move || server.serve(Duration::from_secs(1)));
    let mut link = connect(address);
    link.release().unwrap();
    for _ in 0..5 {
        link.write(&[0.3, -0.1]).unwrap();
        let reading = link.read().unwrap().unwrap();
        let (state, _) = link.inspect().unwrap().unwrap();
        assert_eq!(reading.velocities, Some(state.velocities));
        // The gear ratio is 161.
        let torques = reading.torques.unwrap();
        assert!((torques[0] - 48.3).abs() < 1e-9 && (torques[1] + 16.1).abs() < 1e-9);
    }
    drop(link);
    serving.join().unwrap().unwrap();
}
