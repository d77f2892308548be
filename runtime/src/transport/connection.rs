//! The trait of connections to a robot, its readings and errors.

use std::{fmt, io};
use thiserror::Error;

/// Where the brakes are, as far as the robot tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Brakes {
    /// The robot does not say.
    #[default]
    Unknown,
    /// All are released.
    Released,
    /// At least one is engaged.
    Engaged,
}

impl fmt::Display for Brakes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unknown => "unknown",
            Self::Released => "released",
            Self::Engaged => "engaged",
        })
    }
}

/// A measurement that arrived from the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading<const N: usize, const NY: usize = N> {
    /// Positions in the order, units and sense of the model's coordinates [rad or m]; not yet checked in any
    /// way.
    pub positions: [f64; NY],
    /// Velocities of the coordinates at the same instant, if the drives measure them [rad/s or m/s]. The
    /// loop compares them with the positions, and then uses them instead of differences.
    pub velocities: Option<[f64; N]>,
    /// Forces of the drives at their joints, after the gear and positive as B u is, if they are measured
    /// [N m or N]. For controllers and the log; the loop itself decides nothing by them.
    pub torques: Option<[f64; N]>,
    /// Brakes at the time of the measurement.
    pub brakes: Brakes,
}

impl<const N: usize, const NY: usize> Reading<N, NY> {
    /// The reading of a robot that measures positions alone.
    #[must_use]
    pub fn of(positions: [f64; NY], brakes: Brakes) -> Self {
        Self { positions, velocities: None, torques: None, brakes }
    }
}

/// Error of a transport.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum TransportError {
    /// The robot's side started anew since the last reading, or another controller has connected to it: its brakes,
    /// positions and inputs are not what they were.
    #[error("the robot's side restarted, or has another controller")]
    Restarted,
    /// Nobody answers where the robot should be.
    #[error(
        "nobody answers: check that the robot's side runs, its address, and that it has the same version"
    )]
    NoAnswer,
    /// The operating system failed to send or receive.
    #[error("transport: {0}")]
    Io(io::ErrorKind),
    /// The simulated robot cannot go on.
    #[error("the simulated robot cannot go on")]
    Simulation,
    /// An input is not finite, or too large to be encoded; nothing was sent.
    #[error("input {} cannot be encoded", .input + 1)]
    Input {
        /// Index of the input; messages count from 1.
        input: usize,
    },
}

pub(super) fn require_finite(inputs: &[f64]) -> Result<(), TransportError> {
    let not_finite = inputs.iter().position(|u| !u.is_finite());
    not_finite.map_or(Ok(()), |input| Err(TransportError::Input { input }))
}

impl From<io::Error> for TransportError {
    fn from(e: io::Error) -> Self {
        e.kind().into()
    }
}

impl From<io::ErrorKind> for TransportError {
    fn from(kind: io::ErrorKind) -> Self {
        match kind {
            io::ErrorKind::ConnectionRefused => Self::NoAnswer,
            _ => Self::Io(kind),
        }
    }
}

/// Connection to a robot with `N` measured coordinates and `M` inputs; of one with quaternions with `NY` measured
/// positions.
///
/// No method may allocate, or block for longer than a fraction of the period: a real-time thread calls them.
pub trait Transport<const N: usize, const M: usize, const NY: usize = N> {
    /// Positions now. `None` if nothing arrived in time, or nothing new; a reading is never returned
    /// twice.
    ///
    /// # Errors
    /// [`TransportError::Restarted`] once after each restart of the robot's side; others where the connection
    /// fails. The loop treats those like a missing reading and goes on asking.
    fn read(&mut self) -> Result<Option<Reading<N, NY>>, TransportError>;

    /// Sends inputs; the robot holds them until the next ones. Never releases a brake.
    ///
    /// # Errors
    /// The connection fails. The loop goes on: the robot holds its inputs.
    fn write(&mut self, inputs: &[f64; M]) -> Result<(), TransportError>;

    /// Releases the brakes and switches the drives on. The loop writes the inputs that hold the robot before
    /// it calls this.
    ///
    /// # Errors
    /// Where the connection fails.
    fn release(&mut self) -> Result<(), TransportError>;

    /// Engages the brakes and switches the drives off, in this order where both take time. The loop calls it
    /// again every period until [`Reading::brakes`] confirms it.
    ///
    /// # Errors
    /// Where the connection fails.
    fn brake(&mut self) -> Result<(), TransportError>;
}

impl<const N: usize, const M: usize, const NY: usize, T: Transport<N, M, NY> + ?Sized> Transport<N, M, NY>
    for &mut T
{
    fn read(&mut self) -> Result<Option<Reading<N, NY>>, TransportError> {
        (**self).read()
    }

    fn write(&mut self, inputs: &[f64; M]) -> Result<(), TransportError> {
        (**self).write(inputs)
    }

    fn release(&mut self) -> Result<(), TransportError> {
        (**self).release()
    }

    fn brake(&mut self) -> Result<(), TransportError> {
        (**self).brake()
    }
}
