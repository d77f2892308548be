//! Damaged input from outside: datagrams, frames of a CAN bus, logs, recordings. Nothing panics, nothing
//! hangs, and damaged data are not accepted as valid.
//!
//! In CI a few thousand of each. The long form, a million datagrams for each of their readers and a hundred
//! thousand logs, takes one or two minutes and also fails where a single one takes more than ten seconds:
//!
//! ```text
//! GELENK_MUTATIONS=long cargo test --release -p gelenk-runtime --test all mutations:: -- --nocapture
//! ```

#![allow(clippy::unwrap_used, reason = "test code")]

mod logs;

use crate::support::named_robot::NamedRobot;
use gelenk_identification::log::{ColumnOptions, runs_of};
use gelenk_runtime::control_loop::{Source, log_to};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{Columns, Recording, Smoothing, Trajectory};
use gelenk_runtime::transport::can_frame::{CanCodec, Frame};
use gelenk_runtime::transport::datagram::{Datagram, MAX_DATAGRAM, Message, Push, TrueState};
use gelenk_runtime::transport::{Brakes, Pace, PlantServer, ServerOptions, Transport, UdpTransport};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::net::{SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);
gelenk_runtime::dynamics!(struct Alpha = gelenk_generated::powercube_alpha);

fn is_long() -> bool {
    std::env::var_os("GELENK_MUTATIONS").is_some_and(|value| value == "long")
}

fn rounds(short: u64, long: u64) -> u64 {
    if is_long() { long } else { short }
}

/// Time of the slowest call.
#[derive(Default)]
struct Slowest(Duration);

impl Slowest {
    fn time<T>(&mut self, call: impl FnOnce() -> T) -> T {
        let begin = Instant::now();
        let result = call();
        self.0 = self.0.max(begin.elapsed());
        result
    }

    fn report(&self, what: &str, rounds: u64) {
        println!("{what}: {rounds}, the slowest took {:?}", self.0);
        assert!(!is_long() || self.0 < Duration::from_secs(10), "{what}: {:?}", self.0);
    }
}

/// A number as a bit pattern, an end of what numbers are, or an ordinary one.
fn number(generator: &mut ChaCha8Rng) -> f64 {
    const ENDS: [f64; 8] = [f64::NAN, f64::INFINITY, 1e308, -1e308, 1e10, 5e-324, 0.0, -0.0];
    match generator.random_range(0..4) {
        0 => f64::from_bits(generator.random()),
        1 => ENDS[generator.random_range(0..ENDS.len())],
        _ => generator.random_range(-1.0..1.0),
    }
}

fn numbers<const L: usize>(generator: &mut ChaCha8Rng) -> [f64; L] {
    core::array::from_fn(|_| number(generator))
}

fn message<const N: usize, const M: usize>(generator: &mut ChaCha8Rng) -> Message<N, M> {
    match generator.random_range(0..10) {
        0 | 1 => Message::Query,
        2 => Message::Inputs(numbers(generator).map(|u: f64| if u.is_finite() { u } else { 0.0 })),
        3 => Message::Release,
        4 => Message::Brake,
        5 => Message::Inspect,
        6 => Message::Measured {
            positions: numbers(generator),
            velocities: generator.random_bool(0.5).then(|| numbers(generator)),
            torques: generator.random_bool(0.5).then(|| numbers(generator)),
        },
        7 => Message::Lost,
        9 => Message::Push(Push::Joints { duration: generator.random(), forces: [generator.random(); N] }),
        _ => Message::TrueState(TrueState {
            positions: numbers(generator),
            velocities: numbers(generator),
            lowest: numbers(generator),
            highest: numbers(generator),
            fastest: numbers(generator),
        }),
    }
}

/// A valid datagram, then spoilt: bytes, length, a piece of another; in half of the cases with a checksum
/// that is right again.
fn datagram<const N: usize, const M: usize>(generator: &mut ChaCha8Rng) -> Vec<u8> {
    let mut buffer = [0; MAX_DATAGRAM];
    let sound = Datagram::<N, M> {
        connection: generator.random(),
        sequence: generator.random(),
        brakes: [Brakes::Unknown, Brakes::Released, Brakes::Engaged][generator.random_range(0..3)],
        message: message(generator),
    };
    let mut bytes = sound.encode(&mut buffer).unwrap().to_vec();
    for _ in 0..generator.random_range(0..4) {
        spoil(&mut bytes, generator);
    }
    if bytes.len() >= 4 && generator.random_bool(0.5) {
        let end = bytes.len() - 4;
        let checksum = crc32(&bytes[..end]).to_le_bytes();
        bytes[end..].copy_from_slice(&checksum);
    }
    bytes
}

fn spoil(bytes: &mut Vec<u8>, generator: &mut ChaCha8Rng) {
    let length = bytes.len().max(1);
    let at = generator.random_range(0..length);
    match generator.random_range(0..6) {
        0 => bytes.truncate(at),
        1 => bytes.extend((0..at % 40).map(|k| k as u8)),
        2 if !bytes.is_empty() => bytes[at] = generator.random(),
        3 if !bytes.is_empty() => bytes[at] ^= 1 << generator.random_range(0..8),
        // The head, which decides.
        4 if bytes.len() > 24 => bytes[at % 24] = generator.random_range(0..9),
        5 if bytes.len() >= at + 8 => {
            bytes[at..at + 8].copy_from_slice(&number(generator).to_le_bytes());
        }
        _ => bytes.clear(),
    }
}

/// CRC-32 of IEEE 802.3, bit by bit: not the crate that the transport uses.
fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for byte in bytes {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
        }
    }
    !crc
}

/// An accepted datagram is written again to the last bit: each message has one encoding.
fn read_datagrams<const N: usize, const M: usize>(seed: u64, count: u64) {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let (mut taken, mut slowest) = (0_u64, Slowest::default());
    for _ in 0..count {
        let bytes = datagram::<N, M>(&mut generator);
        let decoded = slowest.time(|| Datagram::<N, M>::decode(&bytes));
        // For another robot: never taken for one's own.
        assert!(Datagram::<5, 4>::decode(&bytes).is_err() || (N, M) == (5, 4) || bytes[6] == 5);
        if let Ok(datagram) = decoded {
            let mut buffer = [0; MAX_DATAGRAM];
            assert_eq!(datagram.encode(&mut buffer).unwrap(), bytes);
            taken += 1;
        }
    }
    assert!(taken > count / 20, "{taken} of {count} were sound");
    slowest.report(&format!("datagrams of {N} coordinates and {M} inputs"), count);
}

#[test]
fn datagrams() {
    read_datagrams::<1, 1>(1, rounds(3000, 300_000));
    read_datagrams::<3, 2>(2, rounds(3000, 300_000));
    read_datagrams::<7, 7>(3, rounds(3000, 300_000));
    read_datagrams::<36, 20>(4, rounds(1000, 100_000));
}

#[test]
fn can_frames() {
    const KNOWN: [u16; 11] = [0x100, 0x110, 0x111, 0x112, 0x140, 0x141, 0x142, 0x143, 0x170, 0x171, 0x172];
    let mut generator = ChaCha8Rng::seed_from_u64(5);
    let plain = CanCodec::<3, 2>::new(0x100, [1e-5; 3], [1e-4, -1e-4]).unwrap();
    let full = plain.clone().with_velocities([1e-4; 3]).unwrap();
    let full = full.with_torques([0.01, -0.01, 0.02]).unwrap();
    let (mut slowest, mut taken) = (Slowest::default(), 0_u64);
    let count = rounds(20_000, 1_000_000);
    for codec in [&plain, &full] {
        let mut set = codec.new_set();
        for _ in 0..count / 2 {
            let mut data = [0; 8];
            generator.fill_bytes(&mut data);
            data[7] %= 5;
            let near = KNOWN[generator.random_range(0..KNOWN.len())];
            let frame = Frame {
                identifier: if generator.random_bool(0.9) { near } else { generator.random() },
                length: if generator.random_bool(0.9) {
                    [2, 5, 6, 8][generator.random_range(0..4)]
                } else {
                    generator.random()
                },
                data,
            };
            let Ok(message) = slowest.time(|| codec.decode(&frame)) else {
                continue;
            };
            taken += 1;
            if let Some(reading) = set.take(&message) {
                assert_eq!(reading.velocities.is_some(), codec == &full);
            }
            // What was taken can be sent, and says the same.
            let sent = codec.encode(&message).unwrap();
            let again = format!("{:?}", codec.decode(&sent).unwrap());
            assert_eq!(again, format!("{message:?}"));
        }
    }
    assert!(taken > count / 100, "{taken}");
    slowest.report("CAN frames", count);
}

/// A plant with arbitrary inputs always has a finite position.
#[test]
fn a_server_survives_what_it_is_told() {
    let mut generator = ChaCha8Rng::seed_from_u64(6);
    let mut plant = Plant::new(Alpha, PlantOptions::default()).unwrap();
    plant.reset([0.1], [0.0]).unwrap();
    let options = ServerOptions { pace: Pace::LockStep, period: 0.005, ..ServerOptions::default() };
    let mut server: PlantServer<Alpha, 1, 1> = PlantServer::bind(plant, "127.0.0.1:0", options).unwrap();
    let (count, mut slowest, mut answers) = (rounds(1500, 1_000_000), Slowest::default(), 0_u64);
    let controller = SocketAddr::from(([127, 0, 0, 1], 4000));
    let mut number = 0;
    for sequence in 0..count {
        let bytes = datagram::<1, 1>(&mut generator);
        let Ok(mut question) = Datagram::decode(&bytes) else {
            continue;
        };
        // Mostly of the controller, which connects anew where the robot has none.
        if generator.random_bool(0.9) {
            (question.connection, question.sequence) = (number, sequence);
            question.message = match generator.random_range(0..8) {
                _ if number == 0 => Message::Connect,
                0 => Message::Release,
                1 => Message::Query,
                2 => Message::Inputs([f64::MAX * generator.random_range(-1.0..1.0)]),
                _ => question.message,
            };
        }
        let answer = slowest.time(|| server.respond(&question, controller)).unwrap();
        if let Some(answer) = answer {
            answers += 1;
            assert_eq!(answer.sequence, question.sequence);
            number = answer.connection;
            match answer.message {
                Message::Connect => assert!(number != 0),
                Message::Measured { positions, .. } => assert!(positions[0].is_finite()),
                Message::TrueState(state) => assert!(state.velocities[0].is_finite()),
                other => panic!("{other:?}"),
            }
        }
    }
    assert!(answers > count / 20, "{answers}");
    println!("{} breakdowns", server.breakdowns());
    assert!(server.breakdowns() > 0);
    slowest.report("datagrams to a server", count);
}

/// Through its socket, with bytes that are not a datagram.
#[test]
fn a_server_survives_its_network() {
    let mut generator = ChaCha8Rng::seed_from_u64(7);
    let mut plant = Plant::new(Alpha, PlantOptions::default()).unwrap();
    plant.reset([0.1], [0.0]).unwrap();
    let options = ServerOptions { pace: Pace::LockStep, period: 0.005, ..ServerOptions::default() };
    let mut server: PlantServer<Alpha, 1, 1> = PlantServer::bind(plant, "127.0.0.1:0", options).unwrap();
    let address = server.local_address().unwrap();
    let serving = std::thread::spawn(move || server.serve(Duration::from_secs(2)));
    let noise = UdpSocket::bind("127.0.0.1:0").unwrap();
    noise.connect(address).unwrap();
    let mut link: UdpTransport<1, 1> = UdpTransport::connect(address, Duration::from_secs(30)).unwrap();
    let count = rounds(1000, 200_000);
    for k in 0..count {
        let mut bytes = datagram::<1, 1>(&mut generator);
        if k % 50 == 0 {
            bytes.resize(generator.random_range(0..60_000), 0x47);
        }
        let _ = noise.send(&bytes);
        if k % 20 == 0 {
            // Answered, though perhaps as a robot that has restarted.
            let mut answered = || link.read().is_ok_and(|reading| reading.is_some());
            assert!(answered() || answered() || answered(), "after {k}");
        }
    }
    drop(link);
    serving.join().unwrap().unwrap();
    println!("datagrams through a server's socket: {count}");
}

/// Whatever a robot answers, a reading is one that was meant: its checksum is right and its number that of
/// the question.
#[test]
fn a_client_survives_what_it_is_answered() {
    let robot = UdpSocket::bind("127.0.0.1:0").unwrap();
    let address = robot.local_addr().unwrap();
    let count = rounds(2000, 1_000_000);
    // An answer for every ten spoilt ones.
    let questions = count / 10;
    let answering = std::thread::spawn(move || {
        let mut generator = ChaCha8Rng::seed_from_u64(8);
        let mut buffer = [0; MAX_DATAGRAM];
        // And the one that connects.
        for _ in 0..=questions {
            let (length, from) = robot.recv_from(&mut buffer).unwrap();
            let question = Datagram::<2, 2>::decode(&buffer[..length]).unwrap();
            let message = match question.message {
                Message::Connect => Message::Connect,
                _ => {
                    Message::Measured { positions: [0.25, -0.5], velocities: Some([1.0, 2.0]), torques: None }
                }
            };
            for _ in 0..10 {
                let mut bytes = datagram::<2, 2>(&mut generator);
                if bytes.len() >= 24 && generator.random_bool(0.3) {
                    // The right number, with the old checksum.
                    bytes[12..20].copy_from_slice(&question.sequence.to_le_bytes());
                }
                let _ = robot.send_to(&bytes, from);
            }
            let answer = Datagram::<2, 2> {
                connection: 1,
                sequence: question.sequence,
                brakes: Brakes::Released,
                message,
            };
            let mut buffer = [0; MAX_DATAGRAM];
            robot.send_to(answer.encode(&mut buffer).unwrap(), from).unwrap();
        }
    });
    let mut link: UdpTransport<2, 2> = UdpTransport::connect(address, Duration::from_secs(5)).unwrap();
    let (mut slowest, mut readings) = (Slowest::default(), 0_u64);
    for _ in 0..questions {
        if let Ok(Some(reading)) = slowest.time(|| link.read()) {
            assert_eq!(reading.positions, [0.25, -0.5]);
            assert_eq!(reading.velocities, Some([1.0, 2.0]));
            readings += 1;
        }
    }
    answering.join().unwrap();
    assert_eq!(readings, questions);
    slowest.report("answers to a client", count);
}
