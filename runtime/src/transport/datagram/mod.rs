//! Datagrams between a controller and a plant process.
//!
//! All numbers little-endian:
//!
//! | bytes | content |
//! |---|---|
//! Positions are NY values, velocities and torques N values, all in the order of the model's entries; a joint
//! with a quaternion has x, y, z, w after its position.
//! A datagram is accepted only if every byte is valid and its length is exact. Measured values may be NaN,
//! because the loop's guard checks them and quaternions; inputs must be finite.
//! A connection begins with a query of kind 9. The plant answers with a random number from the operating
//! system, which every command of the connection must carry. Sequence numbers increase, and continue at 0
//! after the largest. Commands of another sender or an earlier connection, duplicates and late commands have
//! no effect. The first command with an offered number makes its sender the plant's controller and engages
//! the brakes.
//! Version 4 adds connections and pushes. Datagrams of earlier versions, whose commands anyone could repeat,
//! are rejected.
//! | 8–11 | number of the connection: of a command, the one that the plant offered; of an answer, that of the plant's controller, 0 without one |
//! | 12–19 | sequence number |
//! | 20 | brakes: 0 unknown, 1 released, 2 engaged |
//! | 21 | what follows positions in kind 6: 1 velocities, 2 torques, 3 both; in kind 10 the number of the frame plus 1; 0 else |
//! | 22 | NY − N: how many more positions than velocities a robot with quaternions has; 0 for all others |
//! | 23 | 0 |
//! | 24… | values, 8 bytes each, as many as the kind has |
//! | last 4 | CRC-32 (IEEE 802.3) of everything before |
//!
//! Positions are NY values, velocities and torques are N, all in the order of the model's entries: of a joint with a
//! quaternion x, y, z, w behind the position.
//!
//! A datagram is taken only if every byte is as it must be; lengths are exact. What is measured may be NaN,
//! which the loop's guard judges, as it does quaternions; inputs must be finite.
//!
//! A connection begins with the question of kind 9. The plant answers with a number, which the operating system draws, and
//! which every command of the connection carries; sequence numbers rise, and go on at 0 after the largest. Commands of
//! another sender, of an earlier connection, doubled ones and late ones have no effect. The first command that carries an
//! offered number makes its sender the plant's controller in place of the one before, and engages the brakes.
//!
//! Version 4 adds connections and pushes. Datagrams of earlier versions, whose commands anybody could repeat, are not taken.

#[cfg(test)]
mod tests;

use super::Brakes;
use thiserror::Error;

/// First bytes of every datagram.
const MAGIC: [u8; 4] = *b"GLNK";
/// Version of this layout.
pub const VERSION: u8 = 4;
/// Bits of byte 21.
const VELOCITIES: u8 = 0x01;
const TORQUES: u8 = 0x02;
const HEADER: usize = 24;
const CHECKSUM: usize = 4;
/// Most values in a datagram: it fits in one Ethernet frame.
const MAX_VALUES: usize = 180;
/// Length of the longest datagram.
pub const MAX_DATAGRAM: usize = HEADER + 8 * MAX_VALUES + CHECKSUM;

/// True motion of a simulated robot, for tests and displays; controllers do not get it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrueState<const N: usize, const NY: usize = N> {
    /// Positions [rad or m], quaternions.
    pub positions: [f64; NY],
    /// Velocities [rad/s or m/s].
    pub velocities: [f64; N],
    /// Lowest value of each position since the start [rad or m].
    pub lowest: [f64; NY],
    /// Highest value of each position since the start [rad or m].
    pub highest: [f64; NY],
    /// Highest speeds since the start [rad/s or m/s].
    pub fastest: [f64; N],
}

/// A temporary external force on a simulated robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Push<const N: usize> {
    /// Forces at the joints.
    Joints {
        /// How long it lasts (s).
        duration: f64,
        /// Generalized forces [N m or N].
        forces: [f64; N],
    },
    /// A wrench at a frame known to the plant, see
    /// [`PlantServer::with_frame`](super::PlantServer::with_frame).
    Frame {
        /// How long it lasts (s).
        duration: f64,
        /// Number of the frame, 0 to 254.
        frame: u8,
        /// Force (N) and moment (N m) at its origin, in the axes of the world.
        wrench: [f64; 6],
    },
}

/// Content of a datagram.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Message<const N: usize, const M: usize, const NY: usize = N> {
    /// Kind 1, to the plant: asks for a measurement. In lock-step a period passes first.
    Query,
    /// Kind 2, to the plant: sets the inputs, in the model's units.
    Inputs([f64; M]),
    /// Kind 3, to the plant: releases the brakes.
    Release,
    /// Kind 4, to the plant: engages the brakes.
    Brake,
    /// Kind 5, to the plant: asks for the true state. No time passes.
    Inspect,
    /// Kind 6, from the plant: the measurement, as the answer to a query.
    Measured {
        /// Positions [rad or m], quaternions.
        positions: [f64; NY],
        /// Velocities [rad/s or m/s], if they are measured.
        velocities: Option<[f64; N]>,
        /// Forces of the drives at the joints [N m or N], if they are measured.
        torques: Option<[f64; N]>,
    },
    /// Kind 7, from the plant in lock-step: the answer to a query whose measurement was intentionally lost. The
    /// period is over.
    Lost,
    /// Kind 8, from the plant: the true state, as the answer to an inspection.
    TrueState(TrueState<N, NY>),
    /// Kind 9, to the plant: requests a connection. The answer has the same kind and the same number.
    Connect,
    /// Kind 10, to the plant: pushes the robot. It is accepted from the controller, or once from anyone with
    /// an offered number. The answer is that to a query.
    Push(Push<N>),
}

/// A message with its envelope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Datagram<const N: usize, const M: usize, const NY: usize = N> {
    /// Number of the connection; 0 without one.
    pub connection: u32,
    /// Number of the query, which increases within a connection; an answer has the number of its query.
    pub sequence: u64,
    /// Brakes, from the plant.
    pub brakes: Brakes,
    /// Content.
    pub message: Message<N, M, NY>,
}

/// Reasons why a datagram was rejected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum DatagramError {
    /// Shorter than any datagram, or not of the length of its kind.
    #[error("the datagram has {given} bytes instead of {needed}")]
    Length {
        /// Bytes received.
        given: usize,
        /// Bytes needed.
        needed: usize,
    },
    /// Not a datagram of this protocol.
    #[error("the datagram does not begin with GLNK")]
    Magic,
    /// Another version of the protocol.
    #[error("the datagram has version {0} instead of {VERSION}")]
    Version(u8),
    /// For another robot.
    #[error(
        "the datagram is for {} positions, {} velocities and {} inputs instead of {}, {} and {}",
        .given[2], .given[0], .given[1], .needed[2], .needed[0], .needed[1]
    )]
    Sizes {
        /// N, M and NY received.
        given: [usize; 3],
        /// N, M and NY here.
        needed: [usize; 3],
    },
    /// The datagram was damaged.
    #[error("the checksum of the datagram does not match")]
    Checksum,
    /// Invalid kind, brakes or padding.
    #[error("byte {position} of the datagram is {value}")]
    Byte {
        /// Index of the byte.
        position: usize,
        /// Value of the byte.
        value: u8,
    },
    /// An input is NaN or infinite.
    #[error("input {} is not finite", .input + 1)]
    Input {
        /// Index of the input; messages count from 1.
        input: usize,
    },
    /// Duration or force of a push is not finite, or its frame has no number.
    #[error("a push is not finite, or its frame is above 254")]
    Push,
    /// More coordinates or inputs than fit in a datagram.
    #[error("{values} values do not fit in a datagram of at most {MAX_VALUES}")]
    TooLarge {
        /// How many values it would hold.
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

    /// Byte 21.
    fn contents(&self) -> u8 {
        match self {
            Self::Measured { velocities, torques, .. } => {
                u8::from(velocities.is_some()) * VELOCITIES + u8::from(torques.is_some()) * TORQUES
            }
            Self::Push(Push::Frame { frame, .. }) => frame.saturating_add(1),
            _ => 0,
        }
    }

    /// Number of values of a kind with this byte 21; None if there is no such kind.
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
    /// Writes the datagram into `buffer`; returns its bytes.
    ///
    /// # Errors
    /// [`DatagramError::TooLarge`] if the values do not fit; [`DatagramError::Input`] for non-finite inputs
    /// and [`DatagramError::Push`] for non-finite pushes.
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

    /// Reads a datagram. Any bytes are accepted as input and never cause a panic.
    ///
    /// # Errors
    /// [`DatagramError`] for the first invalid byte.
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

/// The content of a known kind, with as many values as it has.
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

/// - `contents`: byte 21
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

/// N, M and NY − N.
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

/// The first L bytes; zeros if there are fewer, which the checks of length exclude.
fn array<const L: usize>(bytes: &[u8]) -> [u8; L] {
    core::array::from_fn(|i| bytes.get(i).copied().unwrap_or(0))
}

fn floats<const L: usize>(bytes: &[u8], first: usize) -> [f64; L] {
    core::array::from_fn(|i| {
        let rest = bytes.get(8 * (first + i)..).unwrap_or(&[]);
        f64::from_le_bytes(array(rest))
    })
}
