//! Frames on a CAN bus: classical CAN 2.0A, 11-bit identifiers, at most 8 bytes, little-endian.
//!
//! | identifier | from | bytes |
//! |---|---|---|
//! | `base` | controller | command: 0x01 release, 0x02 brake; its complement |
//! | `base + 0x10 + j` | controller | input j: count, four bytes signed; sequence, one byte |
//! | `base + 0x40 + i` | drive i | position i: count, four bytes signed; sequence, one byte; status, one byte |
//!
//! Status bit 0: the brake is engaged; bit 1: the encoder reports a fault. The command has the lowest identifier, so that the
//! brakes win every arbitration. Drives stamp positions of the same sampling instant with the same sequence number (a SYNC of
//! the bus master, or the sequence of the inputs they last received); only complete sets are readings. A count is
//! `round(value / resolution)`; the CRC of CAN itself protects the frame.

use super::Brakes;
use thiserror::Error;

/// Most coordinates or inputs: their identifiers must not meet.
pub const MAX_NODES: usize = 0x30;
const INPUT_OFFSET: u16 = 0x10;
const POSITION_OFFSET: u16 = 0x40;
const RELEASE: u8 = 0x01;
const BRAKE: u8 = 0x02;
const STATUS_BRAKED: u8 = 0x01;
const STATUS_FAULT: u8 = 0x02;

/// A frame as it stands on the bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frame {
    /// Identifier, 11 bits.
    pub identifier: u16,
    /// Number of bytes, at most 8.
    pub length: u8,
    /// The bytes; zeros behind `length`.
    pub data: [u8; 8],
}

impl Frame {
    /// A frame from bytes of the bus; None for identifiers above 11 bits or more than 8 bytes.
    #[must_use]
    pub fn new(identifier: u16, bytes: &[u8]) -> Option<Self> {
        if identifier > 0x7ff || bytes.len() > 8 {
            return None;
        }
        let mut data = [0; 8];
        data[..bytes.len()].copy_from_slice(bytes);
        Some(Self {
            identifier,
            length: bytes.len() as u8,
            data,
        })
    }

    /// Its bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.data[..usize::from(self.length.min(8))]
    }
}

/// What a frame says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CanMessage {
    /// Release all brakes.
    Release,
    /// Engage all brakes.
    Brake,
    /// Input of a drive.
    Input {
        /// Index of the input.
        index: usize,
        /// Its value, in the model's unit.
        value: f64,
        /// Number of the set that it belongs to.
        sequence: u8,
    },
    /// Position of a joint.
    Position {
        /// Index of the coordinate.
        index: usize,
        /// Its value [rad or m]; NaN where the encoder reports a fault.
        value: f64,
        /// Number of the set that it belongs to.
        sequence: u8,
        /// The brake of this joint.
        brake: Brakes,
    },
}

/// Why a frame was not made or not taken.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum CanFrameError {
    /// An identifier that is not of this robot: other traffic.
    #[error("identifier {0:#05x} is not of this robot")]
    Identifier(u16),
    /// Too few or too many bytes for its identifier.
    #[error("{given} bytes instead of {needed}")]
    Length {
        /// Bytes received.
        given: u8,
        /// Bytes needed.
        needed: u8,
    },
    /// Not a known command, or not followed by its complement.
    #[error("command bytes {0:#04x}, {1:#04x}")]
    Command(u8, u8),
    /// A value that is not finite or does not fit in four bytes of counts.
    #[error("value {value} at resolution {resolution} does not fit in 32 bits")]
    Range {
        /// The value.
        value: f64,
        /// Its unit per count.
        resolution: f64,
    },
    /// Settings that make no code.
    #[error("{0}")]
    Settings(&'static str),
}

/// Translates between messages and frames of one robot.
#[derive(Debug, Clone, PartialEq)]
pub struct CanCodec<const N: usize, const M: usize> {
    base: u16,
    position_resolution: [f64; N],
    input_resolution: [f64; M],
}

impl<const N: usize, const M: usize> CanCodec<N, M> {
    /// A code with identifiers from `base`, with the value of a count for each position [rad or m] and input. A negative
    /// resolution turns the sense of an encoder or drive around.
    ///
    /// # Errors
    /// [`CanFrameError::Settings`] for more than 48 coordinates or inputs, a base above 0x780 (identifiers must stay in 11
    /// bits), and resolutions that are 0 or not finite.
    pub fn new(
        base: u16,
        position_resolution: [f64; N],
        input_resolution: [f64; M],
    ) -> Result<Self, CanFrameError> {
        if N > MAX_NODES || M > MAX_NODES {
            return Err(CanFrameError::Settings(
                "at most 48 coordinates and 48 inputs have identifiers",
            ));
        }
        if base > 0x780 {
            return Err(CanFrameError::Settings(
                "the base of the identifiers must be at most 0x780",
            ));
        }
        let mut resolutions = position_resolution.iter().chain(&input_resolution);
        if !resolutions.all(|r| r.is_finite() && *r != 0.0) {
            return Err(CanFrameError::Settings(
                "resolutions must be finite and not 0",
            ));
        }
        Ok(Self {
            base,
            position_resolution,
            input_resolution,
        })
    }

    /// The frame of a message.
    ///
    /// # Errors
    /// [`CanFrameError::Range`]; [`CanFrameError::Settings`] for an index that the robot does not have.
    pub fn encode(&self, message: &CanMessage) -> Result<Frame, CanFrameError> {
        const UNKNOWN: CanFrameError = CanFrameError::Settings("no such coordinate or input");
        let mut frame = Frame {
            identifier: self.base,
            length: 2,
            data: [0; 8],
        };
        match *message {
            CanMessage::Release => frame.data[..2].copy_from_slice(&[RELEASE, !RELEASE]),
            CanMessage::Brake => frame.data[..2].copy_from_slice(&[BRAKE, !BRAKE]),
            CanMessage::Input {
                index,
                value,
                sequence,
            } => {
                let resolution = self.input_resolution.get(index).ok_or(UNKNOWN)?;
                frame.identifier += INPUT_OFFSET + index as u16;
                frame.length = 5;
                frame.data[..4].copy_from_slice(&count(value, *resolution)?.to_le_bytes());
                frame.data[4] = sequence;
            }
            CanMessage::Position {
                index,
                value,
                sequence,
                brake,
            } => {
                let resolution = self.position_resolution.get(index).ok_or(UNKNOWN)?;
                let fault = value.is_nan();
                let value = if fault { 0.0 } else { value };
                frame.identifier += POSITION_OFFSET + index as u16;
                frame.length = 6;
                frame.data[..4].copy_from_slice(&count(value, *resolution)?.to_le_bytes());
                frame.data[4] = sequence;
                frame.data[5] = if fault { STATUS_FAULT } else { 0 }
                    | if brake == Brakes::Engaged {
                        STATUS_BRAKED
                    } else {
                        0
                    };
            }
        }
        Ok(frame)
    }

    /// The message of a frame. Any frame may come in; none makes it panic.
    ///
    /// # Errors
    /// [`CanFrameError::Identifier`] for other traffic on the bus; others for damaged frames of this robot.
    pub fn decode(&self, frame: &Frame) -> Result<CanMessage, CanFrameError> {
        let other = CanFrameError::Identifier(frame.identifier);
        let offset = frame.identifier.checked_sub(self.base).ok_or(other)?;
        let data = &frame.data;
        let require = |needed: u8| {
            if frame.length == needed {
                Ok(())
            } else {
                Err(CanFrameError::Length {
                    given: frame.length,
                    needed,
                })
            }
        };
        let counts = f64::from(i32::from_le_bytes([data[0], data[1], data[2], data[3]]));
        let index = |first: u16| usize::from(offset.wrapping_sub(first));
        if offset == 0 {
            require(2)?;
            return match (data[0], data[1]) {
                (RELEASE, check) if check == !RELEASE => Ok(CanMessage::Release),
                (BRAKE, check) if check == !BRAKE => Ok(CanMessage::Brake),
                (command, check) => Err(CanFrameError::Command(command, check)),
            };
        }
        if let Some(resolution) = self.input_resolution.get(index(INPUT_OFFSET)) {
            require(5)?;
            return Ok(CanMessage::Input {
                index: index(INPUT_OFFSET),
                value: counts * resolution,
                sequence: data[4],
            });
        }
        if let Some(resolution) = self.position_resolution.get(index(POSITION_OFFSET)) {
            require(6)?;
            let fault = data[5] & STATUS_FAULT != 0;
            return Ok(CanMessage::Position {
                index: index(POSITION_OFFSET),
                value: if fault { f64::NAN } else { counts * resolution },
                sequence: data[4],
                brake: if data[5] & STATUS_BRAKED == 0 {
                    Brakes::Released
                } else {
                    Brakes::Engaged
                },
            });
        }
        Err(other)
    }
}

fn count(value: f64, resolution: f64) -> Result<i32, CanFrameError> {
    let count = (value / resolution).round();
    if (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&count) {
        Ok(count as i32)
    } else {
        Err(CanFrameError::Range { value, resolution })
    }
}

/// Collects positions of one sampling instant. A set with a newer sequence number discards an incomplete older one.
#[derive(Debug, Clone)]
pub struct PositionSet<const N: usize> {
    sequence: Option<u8>,
    positions: [Option<f64>; N],
    brakes: Brakes,
}

impl<const N: usize> Default for PositionSet<N> {
    fn default() -> Self {
        Self {
            sequence: None,
            positions: [None; N],
            brakes: Brakes::Unknown,
        }
    }
}

impl<const N: usize> PositionSet<N> {
    /// Takes one position in; returns all and the brakes where this one completes the set.
    pub fn take(
        &mut self,
        index: usize,
        value: f64,
        sequence: u8,
        brake: Brakes,
    ) -> Option<([f64; N], Brakes)> {
        if self.sequence != Some(sequence) {
            *self = Self {
                sequence: Some(sequence),
                ..Self::default()
            };
        }
        *self.positions.get_mut(index)? = Some(value);
        self.brakes = match (self.brakes, brake) {
            (Brakes::Engaged, _) | (_, Brakes::Engaged) => Brakes::Engaged,
            (_, other) => other,
        };
        if self.positions.contains(&None) {
            return None;
        }
        let complete = (self.positions.map(|y| y.unwrap_or(f64::NAN)), self.brakes);
        self.positions = [None; N];
        self.brakes = Brakes::Unknown;
        Some(complete)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Axis 0 counts 0.001 degrees; axis 1 is mounted the other way round.
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
        let input = frame(CanMessage::Input {
            index: 1,
            value: 0.5,
            sequence: 9,
        });
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
            let sent = CanMessage::Input {
                index: 1,
                value,
                sequence: 3,
            };
            let CanMessage::Input { value: back, .. } =
                codec.decode(&codec.encode(&sent).unwrap()).unwrap()
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
        let sent = CanMessage::Position {
            index: 1,
            value: f64::NAN,
            sequence: 0,
            brake: Brakes::Released,
        };
        let back = codec.decode(&codec.encode(&sent).unwrap()).unwrap();
        assert!(matches!(back, CanMessage::Position { value, .. } if value.is_nan()));
    }

    #[test]
    fn what_does_not_fit_is_an_error() {
        for value in [f64::NAN, f64::INFINITY, 1e9] {
            let message = CanMessage::Input {
                index: 0,
                value,
                sequence: 0,
            };
            assert!(matches!(
                codec().encode(&message),
                Err(CanFrameError::Range { .. })
            ));
        }
        let message = CanMessage::Input {
            index: 2,
            value: 0.0,
            sequence: 0,
        };
        assert!(codec().encode(&message).is_err(), "there are two inputs");
        assert!(CanCodec::<2, 2>::new(0x781, [1.0; 2], [1.0; 2]).is_err());
        assert!(CanCodec::<2, 2>::new(0, [0.0; 2], [1.0; 2]).is_err());
        assert!(CanCodec::<2, 2>::new(0, [1.0; 2], [f64::NAN; 2]).is_err());
        assert!(CanCodec::<49, 1>::new(0, [1.0; 49], [1.0]).is_err());
    }

    #[test]
    fn other_traffic_and_damage_are_told_apart() {
        let decode = |identifier, bytes: &[u8]| {
            let frame = Frame::new(identifier, bytes).unwrap();
            codec().decode(&frame).unwrap_err()
        };
        for identifier in [0x0, 0xff, 0x101, 0x10f, 0x112, 0x13f, 0x142, 0x7ff] {
            assert_eq!(
                decode(identifier, &[0; 8]),
                CanFrameError::Identifier(identifier)
            );
        }
        assert_eq!(decode(0x100, &[1, 1]), CanFrameError::Command(1, 1));
        assert!(matches!(
            decode(0x110, &[0; 4]),
            CanFrameError::Length {
                given: 4,
                needed: 5
            }
        ));
        assert!(Frame::new(0x800, &[]).is_none() && Frame::new(0, &[0; 9]).is_none());
    }

    #[test]
    fn arbitrary_frames_do_not_panic() {
        let codec = CanCodec::<48, 48>::new(0x300, [1e-5; 48], [1e-4; 48]).unwrap();
        let mut generator = ChaCha8Rng::seed_from_u64(5);
        let mut taken = 0;
        for _ in 0..100_000 {
            let mut data = [0; 8];
            generator.fill_bytes(&mut data);
            // Also what no bus delivers: lengths and identifiers out of range.
            let frame = Frame {
                identifier: generator.random(),
                length: generator.random_range(0..12),
                data,
            };
            let _ = frame.bytes();
            taken += u32::from(codec.decode(&frame).is_ok());
        }
        assert!(taken > 0);
    }

    #[test]
    fn only_complete_sets_are_readings() {
        let mut set = PositionSet::<2>::default();
        assert_eq!(set.take(0, 1.0, 7, Brakes::Released), None);
        assert_eq!(
            set.take(1, 2.0, 7, Brakes::Engaged),
            Some(([1.0, 2.0], Brakes::Engaged))
        );
        // Joint 1 of set 8 is lost.
        assert_eq!(set.take(0, 3.0, 8, Brakes::Released), None);
        assert_eq!(set.take(1, 4.0, 9, Brakes::Released), None);
        assert_eq!(
            set.take(0, 5.0, 9, Brakes::Released),
            Some(([5.0, 4.0], Brakes::Released))
        );
        assert_eq!(
            set.take(2, 0.0, 10, Brakes::Released),
            None,
            "no such joint"
        );
    }
}
