//! Whom a plant server obeys: the controller that connected last, and each of its commands once.

#![allow(clippy::unwrap_used, reason = "test code")]

use crate::support::robot::{PowerCube, START, plant_at};
use gelenk_runtime::plant::PlantOptions;
use gelenk_runtime::transport::datagram::{Datagram, Message, Push};
use gelenk_runtime::transport::{
    Brakes, Pace, PlantServer, ServerOptions, Transport, TransportError, UdpTransport,
};
use std::net::SocketAddr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

type Server = PlantServer<PowerCube, 2, 2>;

const CONTROLLER: ([u8; 4], u16) = ([127, 0, 0, 1], 4000);
const OTHER: ([u8; 4], u16) = ([127, 0, 0, 1], 4001);

fn server() -> Server {
    let options = ServerOptions { pace: Pace::LockStep, ..ServerOptions::default() };
    Server::bind(plant_at(START, PlantOptions::default()), "127.0.0.1:0", options).unwrap()
}

/// The datagrams of a connection.
#[derive(Clone, Copy)]
struct Sender {
    from: SocketAddr,
    number: u32,
}

impl Sender {
    /// Asks for a connection, and takes it by engaging the brakes: the numbers `sequence` and the next.
    fn connected(server: &mut Server, from: impl Into<SocketAddr>, sequence: u64) -> Self {
        let mut sender = Self { from: from.into(), number: 0 };
        let offer = sender.say(server, sequence, Message::Connect).unwrap();
        assert_eq!(offer.message, Message::Connect);
        sender.number = offer.connection;
        sender.say(server, sequence.wrapping_add(1), Message::Brake);
        sender
    }

    fn say(&self, server: &mut Server, sequence: u64, message: Message<2, 2>) -> Option<Datagram<2, 2>> {
        let datagram = Datagram { connection: self.number, sequence, brakes: Brakes::Unknown, message };
        server.respond(&datagram, self.from).unwrap()
    }
}

#[test]
fn commands_that_come_late_or_twice_are_not_obeyed() {
    let mut server = server();
    let controller = Sender::connected(&mut server, CONTROLLER, 1);
    let answer = controller.say(&mut server, 3, Message::Release).unwrap();
    assert_eq!((answer.brakes, server.plant().is_braked()), (Brakes::Released, false));
    controller.say(&mut server, 6, Message::Brake);
    // Doubled, overtaken by the brake, and with the brake's own number.
    for sequence in [3, 5, 6] {
        let answer = controller.say(&mut server, sequence, Message::Release).unwrap();
        assert_eq!((answer.brakes, server.plant().is_braked()), (Brakes::Engaged, true), "{sequence}");
    }
    controller.say(&mut server, 7, Message::Release);
    assert!(!server.plant().is_braked(), "the next one is");
    // A query that comes twice lets one period pass.
    controller.say(&mut server, 8, Message::Query);
    let time = server.plant().time();
    controller.say(&mut server, 8, Message::Query);
    assert_eq!(server.plant().time(), time);
}

#[test]
fn replayed_inputs_do_not_keep_the_watchdog_quiet() {
    for from in [CONTROLLER, OTHER] {
        let mut server = server();
        let controller = Sender::connected(&mut server, CONTROLLER, 1);
        controller.say(&mut server, 3, Message::Release);
        controller.say(&mut server, 4, Message::Inputs([0.1, 0.0]));
        let replaying = Sender { from: from.into(), ..controller };
        for period in 0..7 {
            // Another sender may know the next number, too.
            let sequence = if from == OTHER { 6 + period } else { 4 };
            replaying.say(&mut server, sequence, Message::Inputs([0.1, 0.0]));
            controller.say(&mut server, 5 + period, Message::Query);
            assert_eq!(server.plant().is_braked(), period == 6, "{from:?} {period}");
        }
    }
}

#[test]
fn commands_of_an_earlier_connection_are_not_obeyed() {
    let mut server = server();
    let before = Sender::connected(&mut server, CONTROLLER, 100);
    before.say(&mut server, 102, Message::Release);
    // The same port, after a restart of the controller.
    let now = Sender::connected(&mut server, CONTROLLER, 1);
    assert!(server.plant().is_braked(), "a connection begins with the brakes");
    assert_ne!(before.number, now.number);
    let answer = before.say(&mut server, 103, Message::Release).unwrap();
    assert_eq!((answer.connection, answer.brakes), (now.number, Brakes::Engaged), "it learns of the other");
    now.say(&mut server, 3, Message::Release);
    before.say(&mut server, 104, Message::Brake);
    assert!(!server.plant().is_braked());
}

#[test]
fn a_question_for_a_connection_changes_nothing_by_itself() {
    let mut server = server();
    let controller = Sender::connected(&mut server, CONTROLLER, 1);
    controller.say(&mut server, 3, Message::Release);
    // A replayed one, and somebody's who takes the number that was offered to another.
    let nobody = Sender { from: CONTROLLER.into(), number: 0 };
    let offer = nobody.say(&mut server, 1, Message::Connect).unwrap();
    Sender { from: OTHER.into(), number: offer.connection }.say(&mut server, 2, Message::Brake);
    Sender { from: OTHER.into(), number: 0 }.say(&mut server, 2, Message::Brake);
    assert!(!server.plant().is_braked());
    controller.say(&mut server, 4, Message::Brake);
    assert!(server.plant().is_braked(), "and the controller is still obeyed");
}

#[test]
fn zero_follows_the_largest_sequence_number() {
    let mut server = server();
    let controller = Sender::connected(&mut server, CONTROLLER, u64::MAX - 2);
    controller.say(&mut server, u64::MAX, Message::Release);
    assert!(!server.plant().is_braked());
    controller.say(&mut server, 0, Message::Brake);
    assert!(server.plant().is_braked());
    controller.say(&mut server, u64::MAX, Message::Release);
    assert!(server.plant().is_braked(), "that was before");
    controller.say(&mut server, 1, Message::Release);
    assert!(!server.plant().is_braked());
}

/// A second controller takes the robot, braked; the first learns it with its next reading.
#[test]
fn a_controller_learns_that_another_has_connected() {
    let mut server = server();
    let address = server.local_address().unwrap();
    let over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let serving = scope.spawn(|| {
            while !over.load(Ordering::Relaxed) {
                server.serve_one().unwrap();
            }
        });
        let connect = || UdpTransport::<2, 2>::connect(address, Duration::from_secs(30)).unwrap();
        let (mut first, mut second) = (connect(), connect());
        first.release().unwrap();
        // A display and a push leave it connected.
        assert!(second.inspect().unwrap().is_some());
        assert!(second.push(Push::Joints { duration: 0.02, forces: [1.0, 0.0] }).unwrap());
        assert_eq!(first.read().unwrap().unwrap().brakes, Brakes::Released);
        assert_eq!(second.read().unwrap().unwrap().brakes, Brakes::Engaged);
        assert_eq!(first.read(), Err(TransportError::Restarted));
        over.store(true, Ordering::Relaxed);
        serving.join().unwrap();
    });
}

/// The same motion as by the plant's own function, once for each offered number.
#[test]
fn pushes_come_through_datagrams() {
    use gelenk_generated::powercube::frame_tool_jacobian;
    let (duration, wrench) = (0.04, [30.0, 0.0, -20.0, 0.0, 1.0, 0.0]);
    let mut server = server().with_frame(frame_tool_jacobian);
    let controller = Sender::connected(&mut server, CONTROLLER, 1);
    controller.say(&mut server, 3, Message::Release);
    let stranger = Sender { from: OTHER.into(), number: 0 };
    let offer = stranger.say(&mut server, 1, Message::Connect).unwrap();
    let pushing = Sender { number: offer.connection, ..stranger };
    let push = Message::Push(Push::Frame { duration, frame: 0, wrench });
    for k in 0..4 {
        pushing.say(&mut server, 2 + k, push);
        controller.say(&mut server, 4 + k, Message::Query);
    }
    let mut plant = plant_at(START, PlantOptions::default());
    plant.push(duration, move |y| gelenk_runtime::plant::wrench_forces(&frame_tool_jacobian(y), &wrench));
    for _ in 0..4 {
        plant.hold(0.02).unwrap();
    }
    assert_eq!(server.plant().state(), plant.state(), "two periods of push, and none by the replays");
    controller.say(&mut server, 8, Message::Push(Push::Joints { duration, forces: [5.0, 0.0] }));
    controller.say(&mut server, 9, Message::Query);
    plant.push(duration, |_| [5.0, 0.0]);
    plant.hold(0.02).unwrap();
    assert_eq!(server.plant().state(), plant.state());
}
