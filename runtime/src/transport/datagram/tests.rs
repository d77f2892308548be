//! Tests of the documented layout byte by byte, and of values that do not fit it.

use super::*;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

type Small = Datagram<3, 2>;

fn measured(velocities: Option<[f64; 3]>, torques: Option<[f64; 3]>) -> Message<3, 2> {
    Message::Measured { positions: [1.0, -0.0, 1e-300], velocities, torques }
}

fn messages() -> [Message<3, 2>; 14] {
    [
        Message::Query,
        Message::Inputs([0.5, -1e300]),
        Message::Release,
        Message::Brake,
        Message::Inspect,
        measured(None, None),
        measured(Some([4.0, 5.0, 6.0]), None),
        measured(None, Some([7.0, 8.0, 9.0])),
        measured(Some([4.0, 5.0, 6.0]), Some([7.0, 8.0, 9.0])),
        Message::Lost,
        Message::TrueState(TrueState {
            positions: [1.0, 2.0, 3.0],
            velocities: [4.0, 5.0, 6.0],
            lowest: [7.0, 8.0, 9.0],
            highest: [10.0, 11.0, 12.0],
            fastest: [13.0, 14.0, 15.0],
        }),
        Message::Connect,
        Message::Push(Push::Joints { duration: 0.1, forces: [1.0, -2.0, 3.0] }),
        Message::Push(Push::Frame { duration: 0.1, frame: 254, wrench: [1.0, 2.0, 3.0, 4.0, 5.0, 6.0] }),
    ]
}

fn datagram(message: Message<3, 2>) -> Small {
    Small { connection: 0xdead_beef, sequence: u64::MAX - 1, brakes: Brakes::Engaged, message }
}

#[test]
fn what_is_encoded_is_decoded() {
    for message in messages() {
        let mut buffer = [0xff; MAX_DATAGRAM];
        let sent = datagram(message);
        let bytes = sent.encode(&mut buffer).unwrap();
        assert_eq!(Small::decode(bytes), Ok(sent));
    }
}

#[test]
fn the_layout_is_the_documented_one() {
    let mut buffer = [0; MAX_DATAGRAM];
    let sent = Datagram::<1, 1> {
        connection: 1,
        sequence: 2,
        brakes: Brakes::Released,
        message: Message::Inputs([1.0]),
    };
    let bytes = sent.encode(&mut buffer).unwrap();
    let head = b"GLNK\x04\x02\x01\x01\x01\0\0\0\x02\0\0\0\0\0\0\0\x01\0\0\0";
    assert_eq!(&bytes[..24], head);
    assert_eq!(&bytes[24..32], 1.0f64.to_le_bytes());
    // This is the published check value of the CRC for "123456789".
    assert_eq!(crc32fast::hash(b"123456789"), 0xcbf4_3926);
    assert_eq!(bytes.len(), 36);
}

#[test]
fn positions_may_be_nan_inputs_not() {
    let mut buffer = [0; MAX_DATAGRAM];
    let nan =
        datagram(Message::Measured { positions: [f64::NAN, 0.0, 0.0], velocities: None, torques: None });
    let decoded = Small::decode(nan.encode(&mut buffer).unwrap()).unwrap();
    assert!(matches!(decoded.message, Message::Measured { positions: [x, ..], .. } if x.is_nan()));
    let nan = datagram(Message::Inputs([0.0, f64::NAN]));
    assert_eq!(nan.encode(&mut buffer), Err(DatagramError::Input { input: 1 }));
    // Another program can write such a datagram with the right checksum.
    let good = datagram(Message::Inputs([0.0, 0.0]));
    let length = good.encode(&mut buffer).unwrap().len();
    buffer[32..40].copy_from_slice(&f64::INFINITY.to_le_bytes());
    seal(&mut buffer[..length]);
    assert_eq!(Small::decode(&buffer[..length]), Err(DatagramError::Input { input: 1 }));
}

fn seal(bytes: &mut [u8]) {
    let end = bytes.len() - CHECKSUM;
    let checksum = crc32fast::hash(&bytes[..end]);
    bytes[end..].copy_from_slice(&checksum.to_le_bytes());
}

#[test]
fn every_changed_bit_is_found() {
    for message in messages() {
        let mut buffer = [0; MAX_DATAGRAM];
        let length = datagram(message).encode(&mut buffer).unwrap().len();
        for bit in 0..8 * length {
            let mut bytes = buffer[..length].to_vec();
            bytes[bit / 8] ^= 1 << (bit % 8);
            assert!(Small::decode(&bytes).is_err(), "bit {bit}");
        }
        for cut in 0..length {
            assert!(Small::decode(&buffer[..cut]).is_err(), "{cut} bytes");
        }
        assert!(Small::decode(&buffer[..=length]).is_err());
    }
}

#[test]
fn other_versions_and_robots_are_named() {
    let mut buffer = [0; MAX_DATAGRAM];
    let length = datagram(Message::Query).encode(&mut buffer).unwrap().len();
    let bytes = &mut buffer[..length];
    let sizes = |needed| Err(DatagramError::Sizes { given: [3, 2, 3], needed });
    assert_eq!(Datagram::<2, 2>::decode(bytes), sizes([2, 2, 2]));
    assert_eq!(
        Datagram::<3, 2, 4>::decode(bytes).unwrap_err().to_string(),
        "the datagram is for 3 positions, 3 velocities and 2 inputs instead of 4, 3 and 2"
    );
    for version in [1, 3, 5] {
        bytes[4] = version;
        seal(bytes);
        let error = Small::decode(bytes).unwrap_err();
        assert!(
            error.to_string().starts_with(&format!("the datagram has version {version} instead")),
            "{error}"
        );
    }
    bytes[4] = VERSION;
    bytes[20] = 3;
    seal(bytes);
    let error = Small::decode(bytes).unwrap_err();
    assert_eq!(error.to_string(), "byte 20 of the datagram has the invalid value 3");
}

#[test]
fn a_kind_has_its_own_contents_alone() {
    let mut buffer = [0; MAX_DATAGRAM];
    let length = datagram(measured(None, None)).encode(&mut buffer).unwrap().len();
    for (kind, contents) in [(6, 4), (1, 1)] {
        (buffer[5], buffer[21]) = (kind, contents);
        seal(&mut buffer[..length]);
        assert!(Small::decode(&buffer[..length]).is_err());
    }
}

#[test]
fn pushes_are_finite_and_their_frames_have_numbers() {
    let mut buffer = [0; MAX_DATAGRAM];
    let (duration, forces, wrench) = (0.1, [0.0; 3], [0.0; 6]);
    for push in [
        Push::Joints { duration: f64::NAN, forces },
        Push::Joints { duration, forces: [f64::INFINITY; 3] },
        Push::Frame { duration, frame: 255, wrench },
    ] {
        assert_eq!(datagram(Message::Push(push)).encode(&mut buffer), Err(DatagramError::Push));
    }
    // Another program can write such a datagram with the right checksum.
    let good = datagram(Message::Push(Push::Frame { duration, frame: 0, wrench }));
    let length = good.encode(&mut buffer).unwrap().len();
    buffer[HEADER..HEADER + 8].copy_from_slice(&f64::NAN.to_le_bytes());
    seal(&mut buffer[..length]);
    assert_eq!(Small::decode(&buffer[..length]), Err(DatagramError::Push));
}

/// The datagram has one position more than velocities.
#[test]
fn a_robot_with_a_quaternion_has_ny_positions_and_n_velocities() {
    type Ball = Datagram<3, 1, 4>;
    let mut buffer = [0; MAX_DATAGRAM];
    let envelope = |message| Ball { connection: 1, sequence: 2, brakes: Brakes::Released, message };
    let measured = Message::Measured {
        positions: [0.5, -0.5, 0.5, 0.5],
        velocities: Some([1.0, 2.0, 3.0]),
        torques: Some([4.0, 5.0, 6.0]),
    };
    let state = Message::TrueState(TrueState {
        positions: [0.5, -0.5, 0.5, 0.5],
        velocities: [1.0, 2.0, 3.0],
        lowest: [-1.0, -0.9, -0.8, -0.7],
        highest: [0.1, 0.2, 0.3, 0.4],
        fastest: [7.0, 8.0, 9.0],
    });
    for message in [measured, state, Message::Query, Message::Inputs([0.25])] {
        let sent = envelope(message);
        let bytes = sent.encode(&mut buffer).unwrap().to_vec();
        assert_eq!((bytes[4], bytes[6], bytes[22]), (4, 3, 1));
        assert_eq!(Ball::decode(&bytes), Ok(sent));
        assert!(Datagram::<3, 1>::decode(&bytes).is_err() && Datagram::<4, 1>::decode(&bytes).is_err());
    }
    let bytes = envelope(measured).encode(&mut buffer).unwrap();
    assert_eq!(bytes.len(), HEADER + 8 * (4 + 3 + 3) + CHECKSUM);
    let value = |k: usize| f64::from_le_bytes(array(&bytes[HEADER + 8 * k..]));
    assert_eq!([value(3), value(4), value(7)], [0.5, 1.0, 4.0]);
    // No robot has fewer positions than velocities.
    assert!(Datagram::<4, 1, 3>::decode(&[0; 100]).is_err());
}

#[test]
fn a_robot_too_large_is_an_error() {
    let sent =
        Datagram::<40, 2> { connection: 0, sequence: 0, brakes: Brakes::Unknown, message: Message::Query };
    assert_eq!(sent.encode(&mut [0; MAX_DATAGRAM]), Err(DatagramError::TooLarge { values: 200 }));
    assert!(Datagram::<300, 2>::decode(&[0; 100]).is_err());
}

/// Random bytes, random bytes after a valid header, and random bytes with a valid checksum give a result without a panic.
#[test]
fn arbitrary_bytes_do_not_panic() {
    let mut generator = ChaCha8Rng::seed_from_u64(4);
    let mut taken = 0;
    for round in 0..200_000 {
        let length = generator.random_range(0..200);
        let mut bytes = vec![0; length];
        generator.fill_bytes(&mut bytes);
        if round % 3 > 0 && length >= 8 {
            bytes[..8].copy_from_slice(b"GLNK\x04\x01\x03\x02");
            bytes[5] = generator.random_range(0..12);
        }
        if round % 3 > 1 && length >= HEADER + CHECKSUM {
            bytes[20] %= 4;
            bytes[21] = if bytes[5] % 4 == 2 { bytes[21] % 4 } else { 0 };
            bytes[22..24].fill(0);
            seal(&mut bytes);
        }
        taken += u32::from(Small::decode(&bytes).is_ok());
    }
    assert!(taken > 100, "{taken}: the third kind reaches the values");
}
