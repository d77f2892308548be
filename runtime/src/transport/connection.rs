//! Trait for connections to a robot, with readings and errors.

use std::{fmt, io};
use thiserror::Error;

/// State of the brakes that the robot reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Brakes {
    /// The robot does not report the state.
    #[default]
    Unknown,
    /// All brakes are released.
    Released,
    /// At least one brake is engaged.
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

/// A measurement from the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading<const N: usize, const NY: usize = N> {
    /// Measured positions [rad or m] in the order, units and directions of the coordinates of the model. The values are not
    /// checked.
    pub positions: [f64; NY],
    /// Measured velocities of the coordinates at the same time [rad/s or m/s]; `None` if velocities are not measured. The
    /// loop compares the velocities with the positions, and uses them instead of differences of positions.
    pub velocities: Option<[f64; N]>,
    /// Measured drive forces at the joints, after the gear and with the sign of the joint forces B u of the
    /// inputs u [N m or N]; `None` if forces are not measured. Controllers and the log use the forces, but
    /// the loop does not.
    pub torques: Option<[f64; N]>,
    /// State of the brakes at the time of the measurement.
    pub brakes: Brakes,
}

impl<const N: usize, const NY: usize> Reading<N, NY> {
    /// A reading that only contains positions.
    #[must_use]
    pub fn of(positions: [f64; NY], brakes: Brakes) -> Self {
        Self { positions, velocities: None, torques: None, brakes }
    }
}

/// Error of a transport.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum TransportError {
    /// The program on the robot's side has restarted since the last reading, or another controller has
    /// connected to it. Brakes, positions and inputs may have changed.
    #[error("the program at the robot restarted, or another controller is connected")]
    Restarted,
    /// The program on the robot's side does not answer.
    #[error(
        "the program at the robot does not answer. Check that it runs, has the same version and has the given address"
    )]
    NoAnswer,
    /// The operating system failed to send or receive.
    #[error("sending or receiving failed: {0}")]
    Io(io::ErrorKind),
    /// The motion of the simulated robot over a period cannot be computed.
    #[error(
        "the motion of the simulated robot over a period cannot be computed. Check its model and its options"
    )]
    Simulation,
    /// An input is not finite, or too large for its encoding. Nothing was sent.
    #[error("input {} is not finite, or too large for its encoding. Nothing was sent", .input + 1)]
    Input {
        /// Index of the input, from 0. Messages count from 1.
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

/// Connection to a robot with `N` velocity entries, `M` inputs and `NY` position entries. Only robots with
/// quaternions have NY ≠ N.
///
/// A real-time thread calls the methods. Therefore the methods must not allocate, and may block only for a fraction of the
/// period.
pub trait Transport<const N: usize, const M: usize, const NY: usize = N> {
    /// Reads the current positions. Returns `None` if no new positions have arrived in time. A reading is
    /// returned only once.
    ///
    /// # Errors
    /// [`TransportError::Restarted`] once after each restart of the program on the robot's side. The loop then brakes. Other
    /// errors if the connection fails. The loop treats these errors like a missing reading and continues.
    fn read(&mut self) -> Result<Option<Reading<N, NY>>, TransportError>;

    /// Sends inputs [N m, N or A]. The robot holds these inputs until the next inputs arrive. This method never releases a
    /// brake.
    ///
    /// # Errors
    /// [`TransportError`] if the connection fails. The loop continues, and the robot holds its inputs.
    fn write(&mut self, inputs: &[f64; M]) -> Result<(), TransportError>;

    /// Releases the brakes and switches the drives on. Before this call, the loop has written inputs that hold the robot.
    ///
    /// # Errors
    /// [`TransportError`] if the connection fails.
    fn release(&mut self) -> Result<(), TransportError>;

    /// Engages the brakes and then switches the drives off. The loop repeats this call in every period until
    /// [`Reading::brakes`] reports engaged brakes, at most
    /// [`brake_periods`](crate::control_loop::LoopSettings::brake_periods) times.
    ///
    /// # Errors
    /// [`TransportError`] if the connection fails.
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
