//! Frames on a CAN bus: classical CAN 2.0A, 11-bit identifiers, at most 8 bytes, little-endian.
//!
//! | identifier | from | bytes |
//! |---|---|---|
//! | `base` | controller | command: 0x01 release, 0x02 brake; its complement |
//! | `base + 0x10 + j` | controller | input j: count, four bytes signed; sequence, one byte |
//! | `base + 0x40 + i` | drive i | position i: count, four bytes signed; sequence, one byte; status, one byte |
//! | `base + 0x70 + i` | drive i, if it measures more | velocity i: count, four bytes signed; force of drive i: count, two bytes signed; sequence, one byte; contents, one byte |
//!
//! Status bit 0: the brake is engaged; bit 1: the encoder reports a fault. The command has the lowest
//! identifier, so that the brakes win every arbitration. Drives stamp positions of the same sampling instant
//! with the same sequence number (a SYNC of the bus master, or the sequence of the inputs they last
//! received); only complete sets are readings. A count is `round(value / resolution)`; the CRC of CAN itself
//! protects the frame.
//!
//! Contents bit 0: the velocity is measured; bit 1: the force is. The bytes of what is not are 0. Which of
//! them the drives measure is told to the code ([`CanCodec::with_velocities`], [`CanCodec::with_torques`]),
//! and a set is then complete with both frames of each drive.

use super::{Brakes, Reading};
use thiserror::Error;

/// Most coordinates or inputs: their identifiers must not meet.
pub const MAX_NODES: usize = 0x30;
const INPUT_OFFSET: u16 = 0x10;
const POSITION_OFFSET: u16 = 0x40;
const RATES_OFFSET: u16 = 0x70;
/// Bases above these leave 11 bits.
const LAST_BASE: u16 = 0x780;
const LAST_BASE_WITH_RATES: u16 = 0x760;
/// Resolutions with which four bytes of counts neither overflow nor vanish.
const RESOLUTIONS: std::ops::RangeInclusive<f64> = 1e-30..=1e30;
const RELEASE: u8 = 0x01;
const BRAKE: u8 = 0x02;
const STATUS_BRAKED: u8 = 0x01;
const STATUS_FAULT: u8 = 0x02;
const HAS_VELOCITY: u8 = 0x01;
const HAS_TORQUE: u8 = 0x02;

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
        Some(Self { identifier, length: bytes.len() as u8, data })
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
    /// What a drive measures beside the position of its joint.
    Rates {
        /// Index of the coordinate.
        index: usize,
        /// Velocity of the coordinate [rad/s or m/s].
        velocity: Option<f64>,
        /// Force of the drive at the joint [N m or N].
        torque: Option<f64>,
        /// Number of the set that it belongs to.
        sequence: u8,
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
    /// Contents other than the drives of this robot have.
    #[error("contents {given:#04x} instead of {needed:#04x}")]
    Contents {
        /// Received.
        given: u8,
        /// Of this robot.
        needed: u8,
    },
    /// A value that is not finite or does not fit in its counts: four bytes, two for a force.
    #[error("value {value} at resolution {resolution} does not fit in its counts")]
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
    velocity_resolution: Option<[f64; N]>,
    torque_resolution: Option<[f64; N]>,
}

impl<const N: usize, const M: usize> CanCodec<N, M> {
    /// A code with identifiers from `base`, with the value of a count for each position [rad or m] and input.
    /// A negative resolution turns the sense of an encoder or drive around.
    ///
    /// # Errors
    /// [`CanFrameError::Settings`] for more than 48 coordinates or inputs, a base above 0x780 (identifiers
    /// must stay in 11 bits), and resolutions whose magnitude is not 1e-30 to 1e30.
    pub fn new(
        base: u16,
        position_resolution: [f64; N],
        input_resolution: [f64; M],
    ) -> Result<Self, CanFrameError> {
        if N > MAX_NODES || M > MAX_NODES {
            return Err(CanFrameError::Settings("at most 48 coordinates and 48 inputs have identifiers"));
        }
        if base > LAST_BASE {
            return Err(CanFrameError::Settings("the base of the identifiers must be at most 0x780"));
        }
        require_resolutions(&position_resolution)?;
        require_resolutions(&input_resolution)?;
        Ok(Self {
            base,
            position_resolution,
            input_resolution,
            velocity_resolution: None,
            torque_resolution: None,
        })
    }

    /// For drives that measure velocities, with the value of a count for each [rad/s or m/s].
    ///
    /// # Errors
    /// [`CanFrameError::Settings`] as for [`new`](Self::new); the base must be at most 0x760.
    pub fn with_velocities(self, resolution: [f64; N]) -> Result<Self, CanFrameError> {
        require_resolutions(&resolution)?;
        self.require_base_for_rates()?;
        Ok(Self { velocity_resolution: Some(resolution), ..self })
    }

    /// For drives that measure their forces at the joints, with the value of a count for each [N m or N]; a
    /// count has two bytes.
    ///
    /// # Errors
    /// As [`with_velocities`](Self::with_velocities).
    pub fn with_torques(self, resolution: [f64; N]) -> Result<Self, CanFrameError> {
        require_resolutions(&resolution)?;
        self.require_base_for_rates()?;
        Ok(Self { torque_resolution: Some(resolution), ..self })
    }

    fn require_base_for_rates(&self) -> Result<(), CanFrameError> {
        if self.base <= LAST_BASE_WITH_RATES {
            return Ok(());
        }
        Err(CanFrameError::Settings(
            "with velocities or torques the base of the identifiers must be at most 0x760",
        ))
    }

    /// Contents of this robot's frames of velocities and forces; 0 where there are none.
    fn contents(&self) -> u8 {
        let bit = |present: bool, bit: u8| if present { bit } else { 0 };
        bit(self.velocity_resolution.is_some(), HAS_VELOCITY)
            | bit(self.torque_resolution.is_some(), HAS_TORQUE)
    }

    /// An empty set of this robot's measurements.
    #[must_use]
    pub fn new_set(&self) -> MeasurementSet<N> {
        MeasurementSet { with_rates: self.contents() != 0, ..MeasurementSet::default() }
    }

    /// The frame of a message.
    ///
    /// # Errors
    /// [`CanFrameError::Range`]; [`CanFrameError::Settings`] for an index that the robot does not have.
    pub fn encode(&self, message: &CanMessage) -> Result<Frame, CanFrameError> {
        const UNKNOWN: CanFrameError = CanFrameError::Settings("no such coordinate or input");
        let mut frame = Frame { identifier: self.base, length: 2, data: [0; 8] };
        match *message {
            CanMessage::Release => frame.data[..2].copy_from_slice(&[RELEASE, !RELEASE]),
            CanMessage::Brake => frame.data[..2].copy_from_slice(&[BRAKE, !BRAKE]),
            CanMessage::Input { index, value, sequence } => {
                let resolution = self.input_resolution.get(index).ok_or(UNKNOWN)?;
                frame.identifier += INPUT_OFFSET + index as u16;
                frame.length = 5;
                frame.data[..4].copy_from_slice(&count(value, *resolution)?.to_le_bytes());
                frame.data[4] = sequence;
            }
            CanMessage::Rates { index, velocity, torque, sequence } => {
                if index >= N {
                    return Err(UNKNOWN);
                }
                let velocity = paired(velocity, &self.velocity_resolution, index)?;
                let torque = paired(torque, &self.torque_resolution, index)?;
                frame.identifier += RATES_OFFSET + index as u16;
                frame.length = 8;
                if let Some((value, resolution)) = velocity {
                    frame.data[..4].copy_from_slice(&count(value, resolution)?.to_le_bytes());
                }
                if let Some((value, resolution)) = torque {
                    let counts = i16::try_from(count(value, resolution)?)
                        .map_err(|_| CanFrameError::Range { value, resolution })?;
                    frame.data[4..6].copy_from_slice(&counts.to_le_bytes());
                }
                (frame.data[6], frame.data[7]) = (sequence, self.contents());
            }
            CanMessage::Position { index, value, sequence, brake } => {
                let resolution = self.position_resolution.get(index).ok_or(UNKNOWN)?;
                let fault = value.is_nan();
                let value = if fault { 0.0 } else { value };
                frame.identifier += POSITION_OFFSET + index as u16;
                frame.length = 6;
                frame.data[..4].copy_from_slice(&count(value, *resolution)?.to_le_bytes());
                frame.data[4] = sequence;
                frame.data[5] = if fault { STATUS_FAULT } else { 0 }
                    | if brake == Brakes::Engaged { STATUS_BRAKED } else { 0 };
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
                Err(CanFrameError::Length { given: frame.length, needed })
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
                brake: if data[5] & STATUS_BRAKED == 0 { Brakes::Released } else { Brakes::Engaged },
            });
        }
        let joint = index(RATES_OFFSET);
        if self.contents() != 0 && joint < N {
            require(8)?;
            return self.rates(joint, data);
        }
        Err(other)
    }

    fn rates(&self, index: usize, data: &[u8; 8]) -> Result<CanMessage, CanFrameError> {
        let needed = self.contents();
        if data[7] != needed {
            return Err(CanFrameError::Contents { given: data[7], needed });
        }
        let velocity = f64::from(i32::from_le_bytes([data[0], data[1], data[2], data[3]]));
        let torque = f64::from(i16::from_le_bytes([data[4], data[5]]));
        Ok(CanMessage::Rates {
            index,
            velocity: self.velocity_resolution.map(|r| velocity * r[index]),
            torque: self.torque_resolution.map(|r| torque * r[index]),
            sequence: data[6],
        })
    }
}

/// A value with its resolution: both, or neither.
fn paired<const L: usize>(
    value: Option<f64>,
    resolution: &Option<[f64; L]>,
    index: usize,
) -> Result<Option<(f64, f64)>, CanFrameError> {
    match (value, resolution) {
        (Some(value), Some(resolution)) => Ok(Some((value, resolution[index]))),
        (None, None) => Ok(None),
        _ => Err(CanFrameError::Settings(
            "a drive measures what its code has a resolution for, no more and no less",
        )),
    }
}

fn require_resolutions(resolutions: &[f64]) -> Result<(), CanFrameError> {
    if resolutions.iter().all(|r| RESOLUTIONS.contains(&r.abs())) {
        return Ok(());
    }
    Err(CanFrameError::Settings("the magnitude of a resolution must be 1e-30 to 1e30"))
}

fn count(value: f64, resolution: f64) -> Result<i32, CanFrameError> {
    let count = (value / resolution).round();
    if (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&count) {
        Ok(count as i32)
    } else {
        Err(CanFrameError::Range { value, resolution })
    }
}

/// Collects measurements of one sampling instant. A set with another sequence number discards an incomplete
/// older one.
#[derive(Debug, Clone)]
pub struct MeasurementSet<const N: usize> {
    sequence: Option<u8>,
    positions: [Option<f64>; N],
    /// Velocity and force of each drive.
    rates: [Option<(Option<f64>, Option<f64>)>; N],
    /// True where a set is complete with the rates of each drive alone.
    with_rates: bool,
    brakes: Brakes,
}

impl<const N: usize> Default for MeasurementSet<N> {
    fn default() -> Self {
        Self {
            sequence: None,
            positions: [None; N],
            rates: [None; N],
            with_rates: false,
            brakes: Brakes::Unknown,
        }
    }
}

impl<const N: usize> MeasurementSet<N> {
    /// Takes one message in; returns the reading that it completes. Messages to the drives complete none.
    pub fn take(&mut self, message: &CanMessage) -> Option<Reading<N>> {
        match *message {
            CanMessage::Position { index, value, sequence, brake } => {
                self.begin(sequence);
                *self.positions.get_mut(index)? = Some(value);
                self.brakes = match (self.brakes, brake) {
                    (Brakes::Engaged, _) | (_, Brakes::Engaged) => Brakes::Engaged,
                    (_, other) => other,
                };
            }
            CanMessage::Rates { index, velocity, torque, sequence } => {
                self.begin(sequence);
                *self.rates.get_mut(index)? = Some((velocity, torque));
            }
            CanMessage::Release | CanMessage::Brake | CanMessage::Input { .. } => return None,
        }
        self.complete()
    }

    fn begin(&mut self, sequence: u8) {
        if self.sequence != Some(sequence) {
            *self = Self { sequence: Some(sequence), with_rates: self.with_rates, ..Self::default() };
        }
    }

    fn complete(&mut self) -> Option<Reading<N>> {
        let positions = all(&self.positions)?;
        let mut reading = Reading::of(positions, self.brakes);
        if self.with_rates {
            let rates = all(&self.rates)?;
            reading.velocities = all(&rates.map(|(velocity, _)| velocity));
            reading.torques = all(&rates.map(|(_, torque)| torque));
        }
        self.positions = [None; N];
        self.rates = [None; N];
        self.brakes = Brakes::Unknown;
        Some(reading)
    }
}

/// The values, if there is one for each.
fn all<V: Copy + Default, const N: usize>(values: &[Option<V>; N]) -> Option<[V; N]> {
    let complete = values.iter().all(Option::is_some);
    complete.then(|| values.map(Option::unwrap_or_default))
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
        assert_eq!(codec().decode(&frame), Err(CanFrameError::Identifier(0x171)), "drives that measure none");
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
            // Also what no bus delivers: lengths and identifiers out of range.
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
}
