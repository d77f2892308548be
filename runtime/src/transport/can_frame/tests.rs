//! Tests of the documented layout byte by byte, and of values that do not fit it.

use super::super::Reading;
use super::*;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The encoder of axis 0 counts 0.001 degrees. Axis 1 is mounted in the opposite direction.
fn codec() -> CanCodec<2, 2> {
    CanCodec::new(0x100, [1e-3_f64.to_radians(), -1e-5], [1e-4, -1e-4]).unwrap()
}

#[test]
fn the_layout_is_the_documented_one() {
    let codec = codec();
    let frame = |message| codec.encode(&message).unwrap();
    let brake = frame(CanMessage::Brake);
    assert_eq!((brake.identifier, brake.bytes()), (0x100, &[2, 0xfd][..]));
    let release = frame(CanMessage::Release);
    assert_eq!(release.bytes(), [1, 0xfe]);
    let input = frame(CanMessage::Input { index: 1, value: 0.5, sequence: 9 });
    // 0.5 / −1e-4 = −5000 = 0xffffec78.
    assert_eq!(input.identifier, 0x111);
    assert_eq!(input.bytes(), [0x78, 0xec, 0xff, 0xff, 9]);
    let position = frame(CanMessage::Position {
        index: 0,
        value: 90_f64.to_radians(),
        sequence: 255,
        brake: Brakes::Engaged,
    });
    // 90 000 counts = 0x15f90.
    assert_eq!(position.identifier, 0x140);
    assert_eq!(position.bytes(), [0x90, 0x5f, 0x01, 0, 255, 1]);
}

#[test]
fn what_is_encoded_is_decoded_to_the_resolution() {
    let codec = codec();
    for value in [-0.37, 0.0, 0.123_456] {
        let sent = CanMessage::Input { index: 1, value, sequence: 3 };
        let CanMessage::Input { value: back, .. } = codec.decode(&codec.encode(&sent).unwrap()).unwrap()
        else {
            panic!("an input")
        };
        assert!((back - value).abs() <= 0.5e-4);
    }
    for sent in [CanMessage::Release, CanMessage::Brake] {
        assert_eq!(codec.decode(&codec.encode(&sent).unwrap()), Ok(sent));
    }
}

#[test]
fn an_encoder_fault_is_nan() {
    let codec = codec();
    let sent = CanMessage::Position { index: 1, value: f64::NAN, sequence: 0, brake: Brakes::Released };
    let back = codec.decode(&codec.encode(&sent).unwrap()).unwrap();
    assert!(matches!(back, CanMessage::Position { value, .. } if value.is_nan()));
}

#[test]
fn what_does_not_fit_is_an_error() {
    for value in [f64::NAN, f64::INFINITY, 1e9] {
        let message = CanMessage::Input { index: 0, value, sequence: 0 };
        assert!(matches!(codec().encode(&message), Err(CanFrameError::Range { .. })));
    }
    let message = CanMessage::Input { index: 2, value: 0.0, sequence: 0 };
    assert!(codec().encode(&message).is_err(), "there are two inputs");
    assert!(CanCodec::<2, 2>::new(0x781, [1.0; 2], [1.0; 2]).is_err());
    for bad in [0.0, f64::NAN, f64::INFINITY, 5e-324, 1e300] {
        assert!(CanCodec::<2, 2>::new(0, [bad; 2], [1.0; 2]).is_err());
        assert!(CanCodec::<2, 2>::new(0, [1.0; 2], [bad; 2]).is_err());
        assert!(codec().with_velocities([1.0, bad]).is_err());
        assert!(codec().with_torques([bad, 1.0]).is_err());
    }
    let high = CanCodec::<2, 2>::new(0x761, [1.0; 2], [1.0; 2]).unwrap();
    assert!(high.with_velocities([1.0; 2]).is_err(), "12 bits");
    assert!(CanCodec::<49, 1>::new(0, [1.0; 49], [1.0]).is_err());
}

#[test]
fn other_traffic_and_damage_are_told_apart() {
    let decode = |identifier, bytes: &[u8]| {
        let frame = Frame::new(identifier, bytes).unwrap();
        codec().decode(&frame).unwrap_err()
    };
    for identifier in [0x0, 0xff, 0x101, 0x10f, 0x112, 0x13f, 0x142, 0x7ff] {
        assert_eq!(decode(identifier, &[0; 8]), CanFrameError::Identifier(identifier));
    }
    assert_eq!(decode(0x100, &[1, 1]), CanFrameError::Command(1, 1));
    assert!(matches!(decode(0x110, &[0; 4]), CanFrameError::Length { given: 4, needed: 5 }));
    assert!(Frame::new(0x800, &[]).is_none() && Frame::new(0, &[0; 9]).is_none());
}

fn rates_codec() -> CanCodec<2, 2> {
    let codec = codec().with_velocities([1e-3, -1e-3]).unwrap();
    codec.with_torques([0.01; 2]).unwrap()
}

#[test]
fn rates_have_the_documented_layout() {
    let rates = CanMessage::Rates { index: 1, velocity: Some(0.5), torque: Some(-2.5), sequence: 9 };
    let frame = rates_codec().encode(&rates).unwrap();
    // 0.5 / −0.001 = −500 = 0xfffffe0c; −2.5 / 0.01 = −250 = 0xff06.
    assert_eq!(frame.identifier, 0x171);
    assert_eq!(frame.bytes(), [0x0c, 0xfe, 0xff, 0xff, 0x06, 0xff, 9, 3]);
    assert_eq!(rates_codec().decode(&frame), Ok(rates));
    assert_eq!(codec().decode(&frame), Err(CanFrameError::Identifier(0x171)), "the drives measure neither");
    let velocities = codec().with_velocities([1e-3; 2]).unwrap();
    assert_eq!(velocities.decode(&frame), Err(CanFrameError::Contents { given: 3, needed: 1 }));
    assert!(velocities.encode(&rates).is_err());
    let strong = CanMessage::Rates { index: 0, velocity: Some(0.0), torque: Some(400.0), sequence: 0 };
    assert!(matches!(rates_codec().encode(&strong), Err(CanFrameError::Range { value: 400.0, .. })));
}

#[test]
fn arbitrary_frames_do_not_panic() {
    let codec = CanCodec::<48, 48>::new(0x300, [1e-5; 48], [1e-4; 48]).unwrap();
    let codec = codec.with_velocities([1e-5; 48]).unwrap();
    let mut set = codec.new_set();
    let mut generator = ChaCha8Rng::seed_from_u64(5);
    let mut taken = 0_u32;
    for _ in 0..100_000 {
        let mut data = [0; 8];
        generator.fill_bytes(&mut data);
        // Lengths and identifiers can be out of range, which no bus delivers.
        let frame = Frame { identifier: generator.random(), length: generator.random_range(0..12), data };
        let _ = frame.bytes();
        if let Ok(message) = codec.decode(&frame) {
            taken += 1;
            set.take(&message);
        }
    }
    assert!(taken > 0);
}

fn position(index: usize, value: f64, sequence: u8, brake: Brakes) -> CanMessage {
    CanMessage::Position { index, value, sequence, brake }
}

#[test]
fn only_complete_sets_are_readings() {
    let mut set = codec().new_set();
    assert_eq!(set.take(&position(0, 1.0, 7, Brakes::Released)), None);
    assert_eq!(
        set.take(&position(1, 2.0, 7, Brakes::Engaged)),
        Some(Reading::of([1.0, 2.0], Brakes::Engaged))
    );
    // Joint 1 of set 8 is lost.
    assert_eq!(set.take(&position(0, 3.0, 8, Brakes::Released)), None);
    assert_eq!(set.take(&position(1, 4.0, 9, Brakes::Released)), None);
    assert_eq!(
        set.take(&position(0, 5.0, 9, Brakes::Released)),
        Some(Reading::of([5.0, 4.0], Brakes::Released))
    );
    assert_eq!(set.take(&position(2, 0.0, 10, Brakes::Released)), None, "no such joint");
}

#[test]
fn with_rates_a_set_has_both_frames_of_each_drive() {
    let rates = |index, sequence| CanMessage::Rates {
        index,
        velocity: Some(0.1 * (index + 1) as f64),
        torque: Some(3.0),
        sequence,
    };
    let mut set = rates_codec().new_set();
    assert_eq!(set.take(&rates(1, 7)), None);
    assert_eq!(set.take(&position(0, 1.0, 7, Brakes::Released)), None);
    assert_eq!(set.take(&position(1, 2.0, 7, Brakes::Released)), None);
    let reading = Reading {
        velocities: Some([0.1, 0.2]),
        torques: Some([3.0; 2]),
        ..Reading::of([1.0, 2.0], Brakes::Released)
    };
    assert_eq!(set.take(&rates(0, 7)), Some(reading));
    // A frame of set 8 is lost.
    for message in [
        position(0, 1.0, 8, Brakes::Released),
        position(1, 1.0, 8, Brakes::Released),
        rates(0, 8),
        rates(1, 9),
    ] {
        assert_eq!(set.take(&message), None);
    }
}
