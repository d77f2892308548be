//! Format of the datagrams between a controller and a plant process (a simulated robot).
//!
//! All numbers are little-endian.
//!
//! | bytes | content |
//! |---|---|
//! | 0–3 | `GLNK` |
//! | 4 | version of the protocol, 4 |
//! | 5 | kind, see [`Message`] |
//! | 6 | N, the number of velocities |
//! | 7 | M, the number of inputs |
//! | 8–11 | number of the connection. In a command: the number that the plant offered. In an answer: the number of the plant's present controller, 0 without a controller |
//! | 12–19 | sequence number |
//! | 20 | brakes: 0 unknown, 1 released, 2 engaged |
//! | 21 | kind 6: quantities after the positions (1 velocities, 2 torques, 3 both). Kind 10 with a frame: number of the frame plus 1. Otherwise 0 |
//! | 22 | NY − N, the number of positions minus the number of velocities; 0 for robots without quaternions |
//! | 23 | 0 |
//! | 24… | values, 8 bytes each; their number depends on the kind |
//! | last 4 | CRC-32 (IEEE 802.3) of all bytes before |
//!
//! NY positions and N velocities or torques have the order of the entries of the model. A quaternion is x, y, z, w, after
//! the position of its joint.
//!
//! A datagram is accepted only if every byte is valid and the length is exact. Inputs must be finite. Measured values can
//! be NaN, because the loop checks positions, velocities and quaternions.
//!
//! A connection begins with a query of kind 9. The plant answers with a random number from the operating system. Every
//! command of the connection must contain this number. Sequence numbers increase, and continue at 0 after the largest
//! number. Commands of another sender or of an earlier connection, duplicates and late commands have no effect. The first
//! command with an offered number makes its sender the controller of the plant. It replaces the previous controller, and
//! the plant engages its brakes.
//!
//! Version 4 introduced connections and pushes. Datagrams of earlier versions are rejected, because any sender could
//! repeat their commands.

#[cfg(test)]
mod tests;

use super::Brakes;
use thiserror::Error;

/// First bytes of every datagram.
const MAGIC: [u8; 4] = *b"GLNK";
/// Version of the protocol.
pub const VERSION: u8 = 4;
/// Bits of byte 21, which tell whether velocities and torques follow the positions.
const VELOCITIES: u8 = 0x01;
const TORQUES: u8 = 0x02;
const HEADER: usize = 24;
const CHECKSUM: usize = 4;
/// Largest number of values for which a datagram fits in one Ethernet frame.
const MAX_VALUES: usize = 180;
/// Length of the longest datagram (bytes).
pub const MAX_DATAGRAM: usize = HEADER + 8 * MAX_VALUES + CHECKSUM;

/// True motion of a simulated robot without measurement errors, for tests and displays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrueState<const N: usize, const NY: usize = N> {
    /// Positions [rad or m] and quaternions.
    pub positions: [f64; NY],
    /// Velocities [rad/s or m/s].
    pub velocities: [f64; N],
    /// Lowest value of each position since the start [rad or m].
    pub lowest: [f64; NY],
    /// Highest value of each position since the start [rad or m].
    pub highest: [f64; NY],
    /// Largest speeds since the start [rad/s or m/s].
    pub fastest: [f64; N],
}

/// An external force that acts on a simulated robot for a limited time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Push<const N: usize> {
    /// The force is given as generalized forces.
    Joints {
        /// Duration of the force (s).
        duration: f64,
        /// Generalized forces [N m or N].
        forces: [f64; N],
    },
    /// The force and a moment act at a frame of [`PlantServer::with_frame`](super::PlantServer::with_frame).
    Frame {
        /// Duration of the force (s).
        duration: f64,
        /// Number of the frame, 0 to 254, in the order of the calls of `with_frame`.
        frame: u8,
        /// Force (N) and moment (N m) at the origin of the frame, in the axes of the world.
        wrench: [f64; 6],
    },
}

/// Content of a datagram.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Message<const N: usize, const M: usize, const NY: usize = N> {
    /// Kind 1, to the plant: requests a measurement. In lock-step ([`Pace`](super::Pace)), the plant first advances by one
    /// period.
    Query,
    /// Kind 2, to the plant: sets the inputs [N m, N or A].
    Inputs([f64; M]),
    /// Kind 3, to the plant: releases the brakes.
    Release,
    /// Kind 4, to the plant: engages the brakes.
    Brake,
    /// Kind 5, to the plant: requests the true state. The plant does not advance.
    Inspect,
    /// Kind 6, from the plant: the measurement, which answers kinds 1, 3 and 10.
    Measured {
        /// Positions [rad or m] and quaternions.
        positions: [f64; NY],
        /// Velocities [rad/s or m/s]; `None` if they are not measured.
        velocities: Option<[f64; N]>,
        /// Forces of the drives at the joints [N m or N]; `None` if they are not measured.
        torques: Option<[f64; N]>,
    },
    /// Kind 7, from the plant in lock-step: the answer if the simulated loss of datagrams affects a message. If this message
    /// was a query, the plant has still advanced by one period.
    Lost,
    /// Kind 8, from the plant: the true state, which answers kind 5.
    TrueState(TrueState<N, NY>),
    /// Kind 9, to the plant: requests a connection. The answer also has kind 9 and contains the offered number of the
    /// connection.
    Connect,
    /// Kind 10, to the plant: pushes the robot. The plant accepts a push from its controller. It also accepts one push from
    /// any other sender with an offered number. The answer is a measurement.
    Push(Push<N>),
}

/// A message with the number of its connection, its sequence number, and the state of the brakes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Datagram<const N: usize, const M: usize, const NY: usize = N> {
    /// Number of the connection; 0 without a connection.
    pub connection: u32,
    /// Sequence number of the message, which increases within a connection. An answer has the sequence number of the
    /// message that it answers.
    pub sequence: u64,
    /// State of the brakes, in datagrams from the plant.
    pub brakes: Brakes,
    /// Content of the datagram.
    pub message: Message<N, M, NY>,
}

/// Reason why a datagram is rejected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum DatagramError {
    /// The datagram is shorter than the shortest valid datagram, or its length does not match its kind.
    #[error("the datagram has {given} bytes instead of {needed}")]
    Length {
        /// Number of bytes that were received.
        given: usize,
        /// Number of bytes that are needed.
        needed: usize,
    },
    /// The datagram does not begin with `GLNK`.
    #[error("the datagram does not begin with GLNK")]
    Magic,
    /// The datagram has another version of the protocol.
    #[error("the datagram has version {0} instead of {VERSION}")]
    Version(u8),
    /// The datagram is for another robot.
    #[error(
        "the datagram is for {} positions, {} velocities and {} inputs instead of {}, {} and {}",
        .given[2], .given[0], .given[1], .needed[2], .needed[0], .needed[1]
    )]
    Sizes {
        /// Numbers of velocities (N), inputs (M) and positions (NY) in the datagram.
        given: [usize; 3],
        /// Numbers of velocities (N), inputs (M) and positions (NY) of this robot.
        needed: [usize; 3],
    },
    /// The datagram was damaged.
    #[error("the checksum of the datagram does not match")]
    Checksum,
    /// A byte has an invalid value: the kind, the brakes, the contents or padding.
    #[error("byte {position} of the datagram has the invalid value {value}")]
    Byte {
        /// Index of the invalid byte.
        position: usize,
        /// Value of the invalid byte.
        value: u8,
    },
    /// An input is NaN or infinite.
    #[error("input {} is not finite", .input + 1)]
    Input {
        /// Index of the input, from 0. Messages count from 1.
        input: usize,
    },
    /// The duration or the force of a push is not finite, or the number of its frame is above 254.
    #[error("the force or the duration of a push is not finite, or its frame number is above 254")]
    Push,
    /// The robot has too many coordinates or inputs for a datagram.
    #[error("the robot needs {values} values in a datagram, but at most {MAX_VALUES} values fit")]
    TooLarge {
        /// Number of values that the datagram would need.
        values: usize,
    },
}

impl<const N: usize, const M: usize, const NY: usize> Message<N, M, NY> {
    fn kind(&self) -> u8 {
        match self {
            Self::Query => 1,
            Self::Inputs(_) => 2,
            Self::Release => 3,
            Self::Brake => 4,
            Self::Inspect => 5,
            Self::Measured { .. } => 6,
            Self::Lost => 7,
            Self::TrueState(_) => 8,
            Self::Connect => 9,
            Self::Push(_) => 10,
        }
    }

    /// Byte 21 of the datagram: measured quantities, or frame of a push.
    fn contents(&self) -> u8 {
        match self {
            Self::Measured { velocities, torques, .. } => {
                u8::from(velocities.is_some()) * VELOCITIES + u8::from(torques.is_some()) * TORQUES
            }
            Self::Push(Push::Frame { frame, .. }) => frame.saturating_add(1),
            _ => 0,
        }
    }

    /// Number of values in a datagram of a kind; `None` for an unknown kind.
    ///
    /// - `contents`: byte 21 of the datagram
    fn values(kind: u8, contents: u8) -> Option<usize> {
        match kind {
            1 | 3 | 4 | 5 | 7 | 9 => Some(0),
            2 => Some(M),
            6 => Some(NY + N * contents.count_ones() as usize),
            8 => Some(3 * NY + 2 * N),
            10 => Some(1 + if contents == 0 { N } else { 6 }),
            _ => None,
        }
    }
}

impl<const N: usize, const M: usize, const NY: usize> Datagram<N, M, NY> {
    /// Writes the datagram to `buffer` and returns the written bytes.
    ///
    /// # Errors
    /// - [`DatagramError::TooLarge`] if the values do not fit.
    /// - [`DatagramError::Input`] for an input that is not finite.
    /// - [`DatagramError::Push`] for an invalid push.
    pub fn encode<'a>(&self, buffer: &'a mut [u8; MAX_DATAGRAM]) -> Result<&'a [u8], DatagramError> {
        let [n, m, more] = sizes::<N, M, NY>()?;
        let (kind, contents) = (self.message.kind(), self.message.contents());
        buffer[..4].copy_from_slice(&MAGIC);
        (buffer[4], buffer[5], buffer[6], buffer[7]) = (VERSION, kind, n, m);
        buffer[8..12].copy_from_slice(&self.connection.to_le_bytes());
        buffer[12..20].copy_from_slice(&self.sequence.to_le_bytes());
        buffer[20] = self.brakes as u8;
        (buffer[21], buffer[22], buffer[23]) = (contents, more, 0);
        let mut end = HEADER;
        let mut put = |values: &[f64]| {
            for value in values {
                buffer[end..end + 8].copy_from_slice(&value.to_le_bytes());
                end += 8;
            }
        };
        match &self.message {
            Message::Inputs(inputs) => {
                require_finite(inputs)?;
                put(inputs);
            }
            Message::Measured { positions, velocities, torques } => {
                put(positions);
                velocities.iter().chain(torques).for_each(|v| put(v));
            }
            Message::TrueState(state) => {
                put(&state.positions);
                put(&state.velocities);
                put(&state.lowest);
                put(&state.highest);
                put(&state.fastest);
            }
            Message::Push(push) => {
                push.check()?;
                let (Push::Joints { duration, .. } | Push::Frame { duration, .. }) = push;
                put(&[*duration]);
                put(push.entries());
            }
            Message::Query
            | Message::Release
            | Message::Brake
            | Message::Inspect
            | Message::Lost
            | Message::Connect => {}
        }
        let checksum = crc32fast::hash(&buffer[..end]);
        buffer[end..end + CHECKSUM].copy_from_slice(&checksum.to_le_bytes());
        Ok(&buffer[..end + CHECKSUM])
    }

    /// Reads a datagram. No sequence of bytes causes a panic.
    ///
    /// # Errors
    /// [`DatagramError`] for the first fault of the datagram.
    pub fn decode(bytes: &[u8]) -> Result<Self, DatagramError> {
        let [n, m, more] = sizes::<N, M, NY>()?;
        let shortest = HEADER + CHECKSUM;
        let wrong_length = |needed| DatagramError::Length { given: bytes.len(), needed };
        if bytes.len() < shortest {
            return Err(wrong_length(shortest));
        }
        if bytes[..4] != MAGIC {
            return Err(DatagramError::Magic);
        }
        if bytes[4] != VERSION {
            return Err(DatagramError::Version(bytes[4]));
        }
        let (kind, contents) = (bytes[5], bytes[21]);
        if [bytes[6], bytes[7], bytes[22]] != [n, m, more] {
            let [n, m, more] = [bytes[6], bytes[7], bytes[22]].map(usize::from);
            return Err(DatagramError::Sizes { given: [n, m, n + more], needed: [N, M, NY] });
        }
        let unknown = |position: usize| DatagramError::Byte { position, value: bytes[position] };
        let values = Message::<N, M, NY>::values(kind, contents).ok_or(unknown(5))?;
        let possible = match kind {
            6 => VELOCITIES | TORQUES,
            10 => u8::MAX,
            _ => 0,
        };
        if contents & !possible != 0 {
            return Err(unknown(21));
        }
        let end = HEADER + 8 * values;
        if bytes.len() != end + CHECKSUM {
            return Err(wrong_length(end + CHECKSUM));
        }
        if array(&bytes[end..]) != crc32fast::hash(&bytes[..end]).to_le_bytes() {
            return Err(DatagramError::Checksum);
        }
        if bytes[23] != 0 {
            return Err(unknown(23));
        }
        Ok(Self {
            connection: u32::from_le_bytes(array(&bytes[8..])),
            sequence: u64::from_le_bytes(array(&bytes[12..])),
            brakes: match bytes[20] {
                0 => Brakes::Unknown,
                1 => Brakes::Released,
                2 => Brakes::Engaged,
                _ => return Err(unknown(20)),
            },
            message: message(kind, contents, &bytes[HEADER..end])?,
        })
    }
}

/// Decodes the content of a datagram with a known kind and the right number of values.
///
/// # Errors
/// [`DatagramError::Input`] or [`DatagramError::Push`] for values that are not finite.
fn message<const N: usize, const M: usize, const NY: usize>(
    kind: u8,
    contents: u8,
    bytes: &[u8],
) -> Result<Message<N, M, NY>, DatagramError> {
    Ok(match kind {
        1 => Message::Query,
        2 => {
            let inputs = floats(bytes, 0);
            require_finite(&inputs)?;
            Message::Inputs(inputs)
        }
        3 => Message::Release,
        4 => Message::Brake,
        5 => Message::Inspect,
        6 => {
            let velocities = (contents & VELOCITIES != 0).then(|| floats(bytes, NY));
            let before = if velocities.is_some() { NY + N } else { NY };
            Message::Measured {
                positions: floats(bytes, 0),
                velocities,
                torques: (contents & TORQUES != 0).then(|| floats(bytes, before)),
            }
        }
        7 => Message::Lost,
        8 => Message::TrueState(TrueState {
            positions: floats(bytes, 0),
            velocities: floats(bytes, NY),
            lowest: floats(bytes, NY + N),
            highest: floats(bytes, 2 * NY + N),
            fastest: floats(bytes, 3 * NY + N),
        }),
        9 => Message::Connect,
        _ => Message::Push(push(contents, bytes)?),
    })
}

/// Decodes a push.
///
/// - `contents`: byte 21 of the datagram
fn push<const N: usize>(contents: u8, bytes: &[u8]) -> Result<Push<N>, DatagramError> {
    let [duration] = floats(bytes, 0);
    let push = match contents.checked_sub(1) {
        None => Push::Joints { duration, forces: floats(bytes, 1) },
        Some(frame) => Push::Frame { duration, frame, wrench: floats(bytes, 1) },
    };
    push.check().map(|()| push)
}

impl<const N: usize> Push<N> {
    fn entries(&self) -> &[f64] {
        match self {
            Self::Joints { forces, .. } => forces,
            Self::Frame { wrench, .. } => wrench,
        }
    }

    fn check(&self) -> Result<(), DatagramError> {
        let (Self::Joints { duration, .. } | Self::Frame { duration, .. }) = self;
        let finite = duration.is_finite() && self.entries().iter().all(|x| x.is_finite());
        let has_number = !matches!(self, Self::Frame { frame: u8::MAX, .. });
        if finite && has_number { Ok(()) } else { Err(DatagramError::Push) }
    }
}

/// Numbers of velocities, of inputs, and of positions minus velocities, as bytes.
///
/// # Errors
/// [`DatagramError::TooLarge`] if the values do not fit in a datagram.
fn sizes<const N: usize, const M: usize, const NY: usize>() -> Result<[u8; 3], DatagramError> {
    let values = (3 * NY + 2 * N).max(M);
    let more = NY.checked_sub(N).map(u8::try_from);
    match (u8::try_from(N), u8::try_from(M), more) {
        (Ok(n), Ok(m), Some(Ok(more))) if values <= MAX_VALUES => Ok([n, m, more]),
        _ => Err(DatagramError::TooLarge { values }),
    }
}

fn require_finite(inputs: &[f64]) -> Result<(), DatagramError> {
    match inputs.iter().position(|u| !u.is_finite()) {
        None => Ok(()),
        Some(input) => Err(DatagramError::Input { input }),
    }
}

/// The first L bytes. Missing bytes are 0, but earlier checks of the length exclude this case.
fn array<const L: usize>(bytes: &[u8]) -> [u8; L] {
    core::array::from_fn(|i| bytes.get(i).copied().unwrap_or(0))
}

fn floats<const L: usize>(bytes: &[u8], first: usize) -> [f64; L] {
    core::array::from_fn(|i| {
        let rest = bytes.get(8 * (first + i)..).unwrap_or(&[]);
        f64::from_le_bytes(array(rest))
    })
}
