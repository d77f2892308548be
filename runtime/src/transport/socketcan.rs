//! Transport to a robot on a CAN bus, through the SocketCAN interface of Linux.

use super::can_frame::{CanCodec, CanMessage, Frame, MeasurementSet};
use super::{Reading, Transport, TransportError};
use socketcan::{CanFrame, CanSocket, EmbeddedFrame, Frame as _, Socket, StandardId};
use std::io;

/// Largest number of frames that one reading takes from the socket. The limit ensures that a node that sends too many
/// messages cannot block the loop.
const MAX_FRAMES: usize = 1024;

/// Transport over a SocketCAN interface, with the frames of [`can_frame`](super::can_frame).
#[derive(Debug)]
pub struct CanTransport<const N: usize, const M: usize, const NY: usize = N> {
    socket: CanSocket,
    codec: CanCodec<N, M, NY>,
    measurements: MeasurementSet<N, NY>,
    sequence: u8,
}

impl<const N: usize, const M: usize, const NY: usize> CanTransport<N, M, NY> {
    /// Opens an interface, for example `can0`. Set it up with `ip link` before. Its queue must hold all frames of a period:
    /// `ip link set can0 txqueuelen 64`.
    ///
    /// # Errors
    /// [`io::Error`] if the interface does not exist.
    pub fn open(interface: &str, codec: CanCodec<N, M, NY>) -> io::Result<Self> {
        let socket = CanSocket::open(interface)?;
        socket.set_nonblocking(true)?;
        Ok(Self { socket, measurements: codec.new_set(), codec, sequence: 0 })
    }

    fn send(&self, message: &CanMessage) -> Result<(), TransportError> {
        let frame = self.codec.encode(message).map_err(|_| match message {
            CanMessage::Input { index, .. } => TransportError::Input { input: *index },
            _ => TransportError::Io(io::ErrorKind::InvalidInput),
        })?;
        let invalid = TransportError::Io(io::ErrorKind::InvalidData);
        let identifier = StandardId::new(frame.identifier).ok_or(invalid)?;
        let frame = CanFrame::new(identifier, frame.bytes()).ok_or(invalid)?;
        Ok(self.socket.write_frame(&frame)?)
    }
}

impl<const N: usize, const M: usize, const NY: usize> Transport<N, M, NY> for CanTransport<N, M, NY> {
    /// Returns the newest complete set of measurements.
    fn read(&mut self) -> Result<Option<Reading<N, NY>>, TransportError> {
        let mut newest = None;
        for _ in 0..MAX_FRAMES {
            let frame = match self.socket.read_frame() {
                Ok(frame) => frame,
                Err(e) if e.kind() == io::ErrorKind::WouldBlock => break,
                Err(e) => return Err(e.into()),
            };
            // Frames with 29-bit identifiers, remote frames and error frames do not belong to this robot.
            let Some(frame) = standard(&frame) else {
                continue;
            };
            if let Ok(message) = self.codec.decode(&frame) {
                newest = self.measurements.take(&message).or(newest);
            }
        }
        Ok(newest)
    }

    fn write(&mut self, inputs: &[f64; M]) -> Result<(), TransportError> {
        self.sequence = self.sequence.wrapping_add(1);
        for (index, value) in inputs.iter().enumerate() {
            self.send(&CanMessage::Input { index, value: *value, sequence: self.sequence })?;
        }
        Ok(())
    }

    fn release(&mut self) -> Result<(), TransportError> {
        self.send(&CanMessage::Release)
    }

    fn brake(&mut self) -> Result<(), TransportError> {
        self.send(&CanMessage::Brake)
    }
}

fn standard(frame: &CanFrame) -> Option<Frame> {
    match frame {
        CanFrame::Data(data) if !data.is_extended() => {
            Frame::new(u16::try_from(data.raw_id()).ok()?, data.data())
        }
        _ => None,
    }
}
