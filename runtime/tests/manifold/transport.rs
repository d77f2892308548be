//! A quadrotor over UDP and on a CAN bus: NY positions, N velocities, quaternions that are checked.

use super::Quadrotor;
use super::control_loop::{START, law, motion, options, settings};
use gelenk_runtime::control_loop::{
    ControlLoop, EncoderFault, End, FeedForwardPd, LoopReport, Refusal, StopReason, VirtualClock,
};
use gelenk_runtime::mpc::LtvMpc;
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::transport::can_frame::{CanCodec, CanMessage};
use gelenk_runtime::transport::datagram::{Datagram, MAX_DATAGRAM, Message};
use gelenk_runtime::transport::{Brakes, Pace, PlantServer, ServerOptions, UdpTransport};
use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

type Link = UdpTransport<6, 4, 7>;
type Server = PlantServer<Quadrotor, 6, 4, 7>;

const PATIENCE: Duration = Duration::from_secs(30);

fn server() -> Server {
    let options = PlantOptions { velocity_noise: Some([0.0; 6]), ..PlantOptions::default() };
    let mut plant = Plant::new(Quadrotor, options).unwrap();
    plant.reset(START, [0.0; 6]).unwrap();
    plant.preload([3.715; 4]);
    let period = settings().period().as_secs_f64();
    let options = ServerOptions { period, pace: Pace::LockStep, ..ServerOptions::default() };
    PlantServer::bind(plant, "127.0.0.1:0", options).unwrap()
}

#[test]
fn a_quadrotor_flies_over_udp() {
    let mut server = server();
    let address = server.local_address().unwrap();
    let over = Arc::new(AtomicBool::new(false));
    let is_over = Arc::clone(&over);
    let process = thread::spawn(move || {
        while !is_over.load(Ordering::Relaxed) {
            server.serve_one().unwrap();
        }
        server
    });
    let mut link: Link = UdpTransport::connect(address, PATIENCE).unwrap();
    let controller = LtvMpc::new(Quadrotor, motion(), options()).unwrap();
    let report = ControlLoop::new(settings(), law(), motion(), controller, &mut link, VirtualClock::new())
        .unwrap()
        .run();
    let state = link.inspect();
    over.store(true, Ordering::Relaxed);
    let server = process.join().unwrap();
    assert_eq!(report.end, End::Finished, "{report}");
    assert_eq!((report.counts.missing, report.counts.velocity_faults), (0, 0), "{report}");
    let (state, _) = state.unwrap().unwrap();
    assert_eq!(state.positions, server.plant().state().0, "bit for bit");
    assert!(state.highest[5] > 0.99 && state.fastest[5] > 1.0, "it has turned: {state:?}");
}

/// A plant process whose readings have this quaternion from some query on.
fn spoilt(quaternion: [f64; 4], from: u32, is_over: Arc<AtomicBool>) -> (SocketAddr, thread::JoinHandle<()>) {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.set_read_timeout(Some(Duration::from_millis(100))).unwrap();
    let address = socket.local_addr().unwrap();
    let mut server = server();
    let answer = move || {
        let (mut queries, mut buffer) = (0, [0; MAX_DATAGRAM]);
        while !is_over.load(Ordering::Relaxed) {
            let Ok((length, controller)) = socket.recv_from(&mut buffer) else { continue };
            let question: Datagram<6, 4, 7> = Datagram::decode(&buffer[..length]).unwrap();
            queries += u32::from(question.message == Message::Query);
            let Some(mut answer) = server.respond(&question, controller).unwrap() else { continue };
            if let (true, Message::Measured { positions, .. }) = (queries > from, &mut answer.message) {
                positions[3..].copy_from_slice(&quaternion);
            }
            socket.send_to(answer.encode(&mut buffer).unwrap(), controller).unwrap();
        }
    };
    (address, thread::spawn(answer))
}

fn run_spoilt(quaternion: [f64; 4], from: u32) -> LoopReport<6> {
    let over = Arc::new(AtomicBool::new(false));
    let (address, process) = spoilt(quaternion, from, Arc::clone(&over));
    let link: Link = UdpTransport::connect(address, PATIENCE).unwrap();
    let controller = FeedForwardPd::new(law(), motion(), 0.02, 0.01).unwrap();
    let report =
        ControlLoop::new(settings(), law(), motion(), controller, link, VirtualClock::new()).unwrap().run();
    over.store(true, Ordering::Relaxed);
    process.join().unwrap();
    report
}

/// Zero, not finite, not of unit length: the loop neither starts with such a quaternion nor goes on with it.
#[test]
fn quaternions_in_datagrams_are_checked() {
    for quaternion in [[0.0; 4], [f64::NAN, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.001]] {
        let report = run_spoilt(quaternion, 0);
        assert!(matches!(report.end, End::Refused(Refusal::Encoder(EncoderFault::Attitude(_)))), "{report}");
        let report = run_spoilt(quaternion, 20);
        assert!(matches!(report.end, End::Stopped(StopReason::Encoder(_))), "{report}");
    }
}

#[test]
fn sets_of_can_frames_have_ny_positions_and_n_velocities() {
    let codec = CanCodec::<6, 4, 7>::new(0x100, [1e-9; 7], [1e-6; 4]).unwrap();
    let codec = codec.with_velocities([1e-6; 6]).unwrap();
    let mut set = codec.new_set();
    let positions = [0.1, 0.2, 1.0, 0.1, -0.5, 0.7, 0.5];
    let velocities = [1.0, -0.5, 0.25, 0.1, 0.2, 0.3];
    let mut reading = None;
    for (index, &value) in positions.iter().enumerate() {
        let message = CanMessage::Position { index, value, sequence: 7, brake: Brakes::Released };
        let frame = codec.encode(&message).unwrap();
        assert_eq!(frame.identifier, 0x140 + index as u16);
        reading = set.take(&codec.decode(&frame).unwrap());
        assert!(reading.is_none(), "the velocities are missing");
    }
    for (index, &value) in velocities.iter().enumerate() {
        let message = CanMessage::Rates { index, velocity: Some(value), torque: None, sequence: 7 };
        reading = set.take(&codec.decode(&codec.encode(&message).unwrap()).unwrap());
        assert_eq!(reading.is_some(), index == 5);
    }
    let reading = reading.unwrap();
    for i in 0..7 {
        assert!((reading.positions[i] - positions[i]).abs() <= 1e-9);
    }
    assert!(reading.velocities.unwrap().iter().zip(velocities).all(|(a, b)| (a - b).abs() <= 1e-6));
    let beyond = CanMessage::Rates { index: 6, velocity: Some(0.0), torque: None, sequence: 7 };
    assert!(codec.encode(&beyond).is_err());
}
