//! Format of the frames on a CAN bus: classical CAN 2.0A, 11-bit identifiers, at most 8 bytes, little-endian.
//!
//! | identifier | sender | bytes |
//! |---|---|---|
//! | `base` | controller | command (0x01 release, 0x02 brake); complement of the command |
//! | `base + 0x10 + j` | controller | input j (four bytes, signed count); sequence number (one byte) |
//! | `base + 0x40 + i` | drive i | position i (four bytes, signed count); sequence number (one byte); status (one byte) |
//! | `base + 0x70 + i` | drive i, if it measures velocity or force | velocity i (four bytes, signed count); force of drive i (two bytes, signed count); sequence number (one byte); contents (one byte) |
//!
//! A signed count is `round(value / resolution)`. Status byte: bit 0 is set if the brake is engaged, and bit 1 is set if
//! the encoder reports a fault. Contents byte: bit 0 is set if the velocity is measured, and bit 1 is set if the force is
//! measured. The bytes of a quantity that is not measured are 0. The CRC of CAN protects the frames.
//!
//! The command has the lowest identifier, so a brake command wins every arbitration. Measurements of the same sampling
//! time must have the same sequence number. The drives can use the number of a SYNC of the bus master, or that of the
//! last inputs that they received. Only a complete set of measurements is a reading. By default a set consists of the
//! positions. After [`CanCodec::with_velocities`] or [`CanCodec::with_torques`], a set also needs the second frame of each
//! drive.
//!
//! The positions i are the NY entries of y. Velocities and forces belong to the N velocity entries. For a robot with
//! quaternions, the sensor of the attitude sends the entries x, y, z, w like positions. A resolution of 1e-9 for these
//! entries keeps the length of the quaternion accurate.

mod measurement_set;
#[cfg(test)]
mod tests;

pub use self::measurement_set::MeasurementSet;
use super::Brakes;
use thiserror::Error;

/// Largest number of coordinates or inputs, so that identifiers do not overlap.
pub const MAX_NODES: usize = 0x30;
const INPUT_OFFSET: u16 = 0x10;
const POSITION_OFFSET: u16 = 0x40;
const RATES_OFFSET: u16 = 0x70;
/// Largest base identifier for which all identifiers of a robot have 11 bits.
const LAST_BASE: u16 = 0x780;
const LAST_BASE_WITH_RATES: u16 = 0x760;
/// Allowed magnitudes of resolutions.
const RESOLUTIONS: std::ops::RangeInclusive<f64> = 1e-30..=1e30;
const RELEASE: u8 = 0x01;
const BRAKE: u8 = 0x02;
const STATUS_BRAKED: u8 = 0x01;
const STATUS_FAULT: u8 = 0x02;
const HAS_VELOCITY: u8 = 0x01;
const HAS_TORQUE: u8 = 0x02;

/// A frame on the bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frame {
    /// 11-bit identifier.
    pub identifier: u16,
    /// Number of bytes, at most 8.
    pub length: u8,
    /// Data bytes; zero beyond `length`.
    pub data: [u8; 8],
}

impl Frame {
    /// A frame with these bytes; `None` for an identifier of more than 11 bits, or for more than 8 bytes.
    #[must_use]
    pub fn new(identifier: u16, bytes: &[u8]) -> Option<Self> {
        if identifier > 0x7ff || bytes.len() > 8 {
            return None;
        }
        let mut data = [0; 8];
        data[..bytes.len()].copy_from_slice(bytes);
        Some(Self { identifier, length: bytes.len() as u8, data })
    }

    /// Data bytes of the frame.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.data[..usize::from(self.length.min(8))]
    }
}

/// Content of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CanMessage {
    /// Command to release all brakes.
    Release,
    /// Command to engage all brakes.
    Brake,
    /// Input of a drive.
    Input {
        /// Index of the input.
        index: usize,
        /// Value of the input [N m, N or A].
        value: f64,
        /// Sequence number, equal for all inputs of one period.
        sequence: u8,
    },
    /// Position of a joint.
    Position {
        /// Index of the coordinate.
        index: usize,
        /// Position [rad or m]; NaN if the encoder reports a fault.
        value: f64,
        /// Sequence number of the sampling time.
        sequence: u8,
        /// State of the brake of this joint.
        brake: Brakes,
    },
    /// Velocity and force that a drive measures in addition to the position of its joint.
    Rates {
        /// Index of the coordinate.
        index: usize,
        /// Velocity of the coordinate [rad/s or m/s]; `None` if it is not measured.
        velocity: Option<f64>,
        /// Force of the drive at the joint [N m or N]; `None` if it is not measured.
        torque: Option<f64>,
        /// Sequence number of the sampling time.
        sequence: u8,
    },
}

/// Error of encoding or decoding a frame.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum CanFrameError {
    /// The identifier does not belong to this robot.
    #[error("identifier {0:#05x} does not belong to this robot")]
    Identifier(u16),
    /// The frame has too few or too many bytes for its identifier.
    #[error("the frame has {given} bytes instead of {needed}")]
    Length {
        /// Number of bytes in the frame.
        given: u8,
        /// Number of bytes that the identifier requires.
        needed: u8,
    },
    /// The command is unknown, or its complement is wrong.
    #[error("the command bytes {0:#04x} and {1:#04x} are not a known command and its complement")]
    Command(u8, u8),
    /// The drive measures other quantities than the settings of the codec require.
    #[error(
        "the contents byte of the frame is {given:#04x} instead of {needed:#04x}. The drive must measure the \
         quantities of `with_velocities` and `with_torques`"
    )]
    Contents {
        /// Contents byte in the frame.
        given: u8,
        /// Contents byte according to the settings.
        needed: u8,
    },
    /// A value is not finite, or exceeds the range of its count. A count has four bytes, or two bytes for a force.
    #[error("the value {value} is not finite, or too large for the resolution {resolution}")]
    Range {
        /// Value that does not fit in its count.
        value: f64,
        /// Resolution, which is the unit of a count.
        resolution: f64,
    },
    /// The settings or the index of a message are not valid.
    #[error("{0}")]
    Settings(&'static str),
}

/// Converts between messages and frames of one robot.
#[derive(Debug, Clone, PartialEq)]
pub struct CanCodec<const N: usize, const M: usize, const NY: usize = N> {
    base: u16,
    position_resolution: [f64; NY],
    input_resolution: [f64; M],
    velocity_resolution: Option<[f64; N]>,
    torque_resolution: Option<[f64; N]>,
}

impl<const N: usize, const M: usize, const NY: usize> CanCodec<N, M, NY> {
    /// A codec with identifiers from `base` on. The resolution is the value of one count, for each position [rad or m; no
    /// unit for entries of a quaternion] and for each input [N m, N or A]. A negative resolution reverses the direction of
    /// an encoder or drive.
    ///
    /// # Errors
    /// [`CanFrameError::Settings`] in these cases:
    ///
    /// - more than 48 coordinates or inputs
    /// - a base above 0x780, because identifiers must have 11 bits
    /// - a resolution whose magnitude is not 1e-30 to 1e30
    pub fn new(
        base: u16,
        position_resolution: [f64; NY],
        input_resolution: [f64; M],
    ) -> Result<Self, CanFrameError> {
        if NY > MAX_NODES || N > MAX_NODES || M > MAX_NODES {
            return Err(CanFrameError::Settings(
                "identifiers are available for at most 48 coordinates and 48 inputs",
            ));
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

    /// Adds the velocities that the drives measure, as counts of four bytes. `resolution` is the velocity per
    /// count of each coordinate [rad/s or m/s].
    ///
    /// # Errors
    /// [`CanFrameError::Settings`] for a resolution whose magnitude is not 1e-30 to 1e30, or for a base above
    /// 0x760.
    pub fn with_velocities(self, resolution: [f64; N]) -> Result<Self, CanFrameError> {
        require_resolutions(&resolution)?;
        self.require_base_for_rates()?;
        Ok(Self { velocity_resolution: Some(resolution), ..self })
    }

    /// Adds the forces that the drives measure at the joints, as counts of two bytes. `resolution` is the
    /// force per count of each joint [N m or N].
    ///
    /// # Errors
    /// The errors of [`with_velocities`](Self::with_velocities).
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

    /// Contents byte of the frames with velocities and forces; 0 if the drives measure neither.
    fn contents(&self) -> u8 {
        let bit = |present: bool, bit: u8| if present { bit } else { 0 };
        bit(self.velocity_resolution.is_some(), HAS_VELOCITY)
            | bit(self.torque_resolution.is_some(), HAS_TORQUE)
    }

    /// An empty set for the measurements of this robot.
    #[must_use]
    pub fn new_set(&self) -> MeasurementSet<N, NY> {
        MeasurementSet::new(self.contents() != 0)
    }

    /// Encodes a message as a frame.
    ///
    /// # Errors
    /// - [`CanFrameError::Range`] for a value that is not finite or exceeds the range of its count.
    /// - [`CanFrameError::Settings`] for an index out of range, or for measured quantities that differ from the settings.
    pub fn encode(&self, message: &CanMessage) -> Result<Frame, CanFrameError> {
        const UNKNOWN: CanFrameError =
            CanFrameError::Settings("the robot has no coordinate or input with this index");
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

    /// Decodes a frame. No frame causes a panic.
    ///
    /// # Errors
    /// - [`CanFrameError::Identifier`] for other traffic on the bus.
    /// - [`CanFrameError::Length`], [`CanFrameError::Command`] or [`CanFrameError::Contents`] for an invalid frame of this
    ///   robot.
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

/// A value with its resolution; `None` if both are missing.
///
/// # Errors
/// [`CanFrameError::Settings`] if only one of the two is given.
fn paired<const L: usize>(
    value: Option<f64>,
    resolution: &Option<[f64; L]>,
    index: usize,
) -> Result<Option<(f64, f64)>, CanFrameError> {
    match (value, resolution) {
        (Some(value), Some(resolution)) => Ok(Some((value, resolution[index]))),
        (None, None) => Ok(None),
        _ => Err(CanFrameError::Settings(
            "the velocities and torques of a message must be those of `with_velocities` and `with_torques`",
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
