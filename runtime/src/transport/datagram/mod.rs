//! Datagrams between a controller and a plant process.
//!
//! All numbers little-endian:
//!
//! | bytes | content |
//! |---|---|
//! | 0–3 | `GLNK` |
//! | 4 | version: 3 where byte 22 is not 0, else 2 where byte 21 is not 0, else 1 |
//! | 5 | kind, see [`Message`] |
//! | 6, 7 | N, M |
//! | 8–11 | session: which start of the plant process answers; 0 from the controller |
//! | 12–19 | sequence number |
//! | 20 | brakes: 0 unknown, 1 released, 2 engaged |
//! | 21 | what follows positions in kind 6: 1 velocities, 2 torques, 3 both; 0 else |
//! | 22 | NY − N: how many more positions than velocities a robot with quaternions has; 0 for all others |
//! | 23 | 0 |
//! | 24… | values, 8 bytes each, as many as the kind has |
//! | last 4 | CRC-32 (IEEE 802.3) of everything before |
//!
//! Positions are NY values, velocities and torques are N, all in the order of the model's entries: of a joint with a
//! quaternion x, y, z, w behind the position.
//!
//! A datagram is taken only if every byte is as it must be; lengths are exact. What is measured may be NaN,
//! which the loop's guard judges, as it does quaternions; inputs must be finite. Version 2 adds measured velocities and torques; what
//! has neither is still written as version 1, so that programs which know version 1 alone go on talking. Version 3 adds
//! robots with quaternions.

#[cfg(test)]
mod tests;

use super::Brakes;
use thiserror::Error;

/// First bytes of every datagram.
const MAGIC: [u8; 4] = *b"GLNK";
/// Newest version of this layout that is read and written.
pub const VERSION: u8 = 3;
/// The version without measured velocities and torques.
const FIRST_VERSION: u8 = 1;
/// The version without quaternions.
const SECOND_VERSION: u8 = 2;
/// Bits of byte 21.
const VELOCITIES: u8 = 0x01;
const TORQUES: u8 = 0x02;
const HEADER: usize = 24;
const CHECKSUM: usize = 4;
/// Most values in a datagram: it fits in one Ethernet frame.
const MAX_VALUES: usize = 180;
/// Length of the longest datagram.
pub const MAX_DATAGRAM: usize = HEADER + 8 * MAX_VALUES + CHECKSUM;

/// True motion of a simulated robot, which no controller sees; for tests and displays.
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

/// The content of a datagram.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Message<const N: usize, const M: usize, const NY: usize = N> {
    /// Kind 1, to the plant: where are you? In lock-step, a period passes first.
    Query,
    /// Kind 2, to the plant: inputs from now on, in the model's units.
    Inputs([f64; M]),
    /// Kind 3, to the plant: release the brakes.
    Release,
    /// Kind 4, to the plant: engage the brakes.
    Brake,
    /// Kind 5, to the plant: send your true state. No time passes.
    Inspect,
    /// Kind 6, from the plant, answers a query: what was measured.
    Measured {
        /// Positions [rad or m], quaternions.
        positions: [f64; NY],
        /// Velocities [rad/s or m/s], where they are measured.
        velocities: Option<[f64; N]>,
        /// Forces of the drives at the joints [N m or N], where they are measured.
        torques: Option<[f64; N]>,
    },
    /// Kind 7, from the plant in lock-step, answers a query whose answer was lost on purpose: the period is
    /// over.
    Lost,
    /// Kind 8, from the plant, answers an inspection.
    TrueState(TrueState<N, NY>),
}

/// A message with its envelope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Datagram<const N: usize, const M: usize, const NY: usize = N> {
    /// Start of the plant process that answers; 0 from the controller.
    pub session: u32,
    /// Number of the question; an answer bears that of its question.
    pub sequence: u64,
    /// Brakes, from the plant.
    pub brakes: Brakes,
    /// Content.
    pub message: Message<N, M, NY>,
}

/// Why a datagram was not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum DatagramError {
    /// Shorter than any datagram, or not as long as its kind.
    #[error("{given} bytes instead of {needed}")]
    Length {
        /// Bytes received.
        given: usize,
        /// Bytes needed.
        needed: usize,
    },
    /// Not a datagram of this protocol.
    #[error("does not begin with GLNK")]
    Magic,
    /// Another version of the protocol, or not the one that such contents have.
    #[error("version {0}, which is newer than {VERSION}, or not that of its contents")]
    Version(u8),
    /// For another robot.
    #[error(
        "for {} positions, {} velocities and {} inputs instead of {}, {} and {}",
        .given[2], .given[0], .given[1], .needed[2], .needed[0], .needed[1]
    )]
    Sizes {
        /// N, M and NY received.
        given: [usize; 3],
        /// N, M and NY here.
        needed: [usize; 3],
    },
    /// Damaged on the way.
    #[error("checksum does not match")]
    Checksum,
    /// Kind, brakes or padding that do not exist.
    #[error("byte {position} is {value}")]
    Byte {
        /// Index of the byte.
        position: usize,
        /// Its value.
        value: u8,
    },
    /// An input is NaN or infinite.
    #[error("input {} is not finite", .input + 1)]
    Input {
        /// Index of the input; messages count from 1.
        input: usize,
    },
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
        }
    }

    /// Byte 21.
    fn contents(&self) -> u8 {
        let Self::Measured { velocities, torques, .. } = self else {
            return 0;
        };
        let bit = |present: bool, bit: u8| if present { bit } else { 0 };
        bit(velocities.is_some(), VELOCITIES) | bit(torques.is_some(), TORQUES)
    }

    /// Number of values of a kind with this byte 21; None if there is no such kind.
    fn values(kind: u8, contents: u8) -> Option<usize> {
        match kind {
            1 | 3 | 4 | 5 | 7 => Some(0),
            2 => Some(M),
            6 => Some(NY + N * contents.count_ones() as usize),
            8 => Some(3 * NY + 2 * N),
            _ => None,
        }
    }
}

impl<const N: usize, const M: usize, const NY: usize> Datagram<N, M, NY> {
    /// Writes the datagram into `buffer`; returns its bytes.
    ///
    /// # Errors
    /// [`DatagramError::TooLarge`] for more values than fit; [`DatagramError::Input`] for inputs that are not
    /// finite.
    pub fn encode<'a>(&self, buffer: &'a mut [u8; MAX_DATAGRAM]) -> Result<&'a [u8], DatagramError> {
        let [n, m, more] = sizes::<N, M, NY>()?;
        let (kind, contents) = (self.message.kind(), self.message.contents());
        buffer[..4].copy_from_slice(&MAGIC);
        (buffer[4], buffer[5], buffer[6], buffer[7]) = (version(contents, more), kind, n, m);
        buffer[8..12].copy_from_slice(&self.session.to_le_bytes());
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
            Message::Query | Message::Release | Message::Brake | Message::Inspect | Message::Lost => {}
        }
        let checksum = crc32fast::hash(&buffer[..end]);
        buffer[end..end + CHECKSUM].copy_from_slice(&checksum.to_le_bytes());
        Ok(&buffer[..end + CHECKSUM])
    }

    /// Reads a datagram. Any bytes may come in; none makes it panic.
    ///
    /// # Errors
    /// [`DatagramError`] for the first byte that is not as it must be.
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
        if !(FIRST_VERSION..=VERSION).contains(&bytes[4]) {
            return Err(DatagramError::Version(bytes[4]));
        }
        let (kind, contents) = (bytes[5], bytes[21]);
        if [bytes[6], bytes[7], bytes[22]] != [n, m, more] {
            let [n, m, more] = [bytes[6], bytes[7], bytes[22]].map(usize::from);
            return Err(DatagramError::Sizes { given: [n, m, n + more], needed: [N, M, NY] });
        }
        let unknown = |position: usize| DatagramError::Byte { position, value: bytes[position] };
        let values = Message::<N, M, NY>::values(kind, contents).ok_or(unknown(5))?;
        let possible = if kind == 6 { VELOCITIES | TORQUES } else { 0 };
        if contents & !possible != 0 {
            return Err(unknown(21));
        }
        // Each datagram is written in one way.
        if bytes[4] != version(contents, more) {
            return Err(DatagramError::Version(bytes[4]));
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
            session: u32::from_le_bytes(array(&bytes[8..])),
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
        _ => Message::TrueState(TrueState {
            positions: floats(bytes, 0),
            velocities: floats(bytes, NY),
            lowest: floats(bytes, NY + N),
            highest: floats(bytes, 2 * NY + N),
            fastest: floats(bytes, 3 * NY + N),
        }),
    })
}

/// The version that knows these contents, of a robot with so many more positions than velocities.
fn version(contents: u8, more: u8) -> u8 {
    match (contents, more) {
        (0, 0) => FIRST_VERSION,
        (_, 0) => SECOND_VERSION,
        _ => VERSION,
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

/// The first L bytes; zeros where there are fewer, which the checks of length exclude.
fn array<const L: usize>(bytes: &[u8]) -> [u8; L] {
    core::array::from_fn(|i| bytes.get(i).copied().unwrap_or(0))
}

fn floats<const L: usize>(bytes: &[u8], first: usize) -> [f64; L] {
    core::array::from_fn(|i| {
        let rest = bytes.get(8 * (first + i)..).unwrap_or(&[]);
        f64::from_le_bytes(array(rest))
    })
}
