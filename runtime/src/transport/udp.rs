//! Controller's side of the UDP connection.

use super::datagram::{Datagram, MAX_DATAGRAM, Message, Push, TrueState};
use super::{Brakes, Reading, Transport, TransportError, require_finite};
use rand::TryRng;
use rand::rngs::SysRng;
use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, ToSocketAddrs, UdpSocket};
use std::time::{Duration, Instant};

/// Longest waiting time for an answer.
const LONGEST_TIMEOUT: Duration = Duration::from_secs(3600);
/// Number of attempts to release the brakes. The loop does not repeat this command, so this transport repeats it if it is
/// lost.
const RELEASE_ATTEMPTS: u32 = 20;

/// Transport to a robot over UDP, with the datagrams of [`datagram`](super::datagram).
///
/// A reading sends a query and waits for its answer. Late, foreign, damaged and duplicate datagrams do not match the query
/// and are dropped, so positions always belong to the present period. The first command or reading connects. The robot then
/// engages its brakes and obeys this controller instead of the previous controller.
#[derive(Debug)]
pub struct UdpTransport<const N: usize, const M: usize, const NY: usize = N> {
    socket: UdpSocket,
    timeout: Duration,
    sequence: u64,
    /// Number of the connection; `None` before the connection.
    connection: Option<u32>,
}

impl<const N: usize, const M: usize, const NY: usize> UdpTransport<N, M, NY> {
    /// A transport to a plant process, which may start later. `timeout` is the longest waiting time for an answer. If the
    /// plant runs in real time, choose a quarter of the period. If it runs in lock-step, it waits for the controller; choose
    /// several seconds.
    ///
    /// # Errors
    /// [`io::Error`] if address or socket are not available, if `timeout` is zero or above an hour, or if the robot has too
    /// many coordinates for a datagram.
    pub fn connect(address: impl ToSocketAddrs, timeout: Duration) -> io::Result<Self> {
        if timeout.is_zero() || timeout > LONGEST_TIMEOUT {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                format!("the timeout of a reading is {timeout:?}, but must be positive and at most one hour"),
            ));
        }
        let mut addresses = address.to_socket_addrs()?;
        let address = addresses.next().ok_or(io::ErrorKind::AddrNotAvailable)?;
        let any: IpAddr =
            if address.is_ipv4() { Ipv4Addr::UNSPECIFIED.into() } else { Ipv6Addr::UNSPECIFIED.into() };
        let socket = UdpSocket::bind((any, 0))?;
        socket.connect(address)?;
        socket.set_read_timeout(Some(timeout))?;
        // With a random start, answers to an earlier process at this port do not match.
        let sequence = SysRng.try_next_u64().map_err(io::Error::other)?;
        let transport = Self { socket, timeout, sequence, connection: None };
        let question = transport.question(0, Message::Query);
        question.encode(&mut [0; MAX_DATAGRAM]).map_err(io::Error::other)?;
        Ok(transport)
    }

    /// Requests the true state of a simulated robot, for tests and displays. Returns `None` if no answer arrives in time.
    ///
    /// # Errors
    /// [`TransportError::Io`] if the socket fails.
    pub fn inspect(&mut self) -> Result<Option<(TrueState<N, NY>, Brakes)>, TransportError> {
        let answer = self.ask(0, Message::Inspect)?;
        Ok(answer.and_then(|answer| match answer.message {
            Message::TrueState(state) => Some((state, answer.brakes)),
            _ => None,
        }))
    }

    /// Applies an external force to a simulated robot. If another transport controls the robot, this transport remains
    /// connected. Returns false if no answer arrives in time.
    ///
    /// # Errors
    /// [`TransportError::NoAnswer`] if the robot's side offers no connection in time. [`TransportError::Io`] if the socket
    /// fails.
    pub fn push(&mut self, push: Push<N>) -> Result<bool, TransportError> {
        let number = self.connection.map_or_else(|| self.offered_number(), Ok)?;
        Ok(self.ask(number, Message::Push(push))?.is_some())
    }

    /// Requests a connection and returns its number.
    ///
    /// # Errors
    /// [`TransportError::NoAnswer`] if no connection is offered in time.
    fn offered_number(&mut self) -> Result<u32, TransportError> {
        let answer = self.ask(0, Message::Connect)?;
        let offer = answer.filter(|answer| answer.message == Message::Connect);
        offer.map(|offer| offer.connection).ok_or(TransportError::NoAnswer)
    }

    fn connected_number(&mut self) -> Result<u32, TransportError> {
        let number = self.connection.map_or_else(|| self.offered_number(), Ok)?;
        self.connection = Some(number);
        Ok(number)
    }

    /// Sends a message as the controller of the robot, and returns the answer; `None` if no answer arrives in time.
    ///
    /// # Errors
    /// [`TransportError::Restarted`] if the robot's side has another controller.
    fn ask_connected(
        &mut self,
        message: Message<N, M, NY>,
    ) -> Result<Option<Datagram<N, M, NY>>, TransportError> {
        let number = self.connected_number()?;
        let answer = self.ask(number, message)?;
        if answer.is_some_and(|answer| answer.connection != number) {
            self.connection = None;
            return Err(TransportError::Restarted);
        }
        Ok(answer)
    }

    fn question(&self, connection: u32, message: Message<N, M, NY>) -> Datagram<N, M, NY> {
        Datagram { connection, sequence: self.sequence, brakes: Brakes::Unknown, message }
    }

    fn send(&mut self, connection: u32, message: Message<N, M, NY>) -> Result<(), TransportError> {
        self.sequence = self.sequence.wrapping_add(1);
        let mut buffer = [0; MAX_DATAGRAM];
        let datagram = self.question(connection, message);
        let bytes = datagram.encode(&mut buffer).map_err(|_| io::ErrorKind::InvalidInput)?;
        match self.socket.send(bytes) {
            // This error means that an earlier datagram found no receiver. The present datagram was not sent.
            Err(e) if e.kind() == io::ErrorKind::ConnectionRefused => {
                self.socket.send(bytes).map(drop)?;
            }
            sent => sent.map(drop)?,
        }
        Ok(())
    }

    /// The answer to a message; `None` if no answer arrives in time.
    fn ask(
        &mut self,
        connection: u32,
        message: Message<N, M, NY>,
    ) -> Result<Option<Datagram<N, M, NY>>, TransportError> {
        self.send(connection, message)?;
        let deadline = Instant::now() + self.timeout;
        let mut remaining = self.timeout;
        loop {
            self.socket.set_read_timeout(Some(remaining))?;
            // The buffer has one byte more than the longest datagram. Otherwise a too long datagram would be cut to a valid
            // length.
            let mut buffer = [0; MAX_DATAGRAM + 1];
            let length = match self.socket.recv(&mut buffer) {
                Ok(length) => length,
                Err(e) if is_timeout(&e) => return Ok(None),
                Err(e) if e.kind() == io::ErrorKind::Interrupted => 0,
                Err(e) => return Err(e.into()),
            };
            if let Ok(answer) = Datagram::decode(&buffer[..length])
                && answer.sequence == self.sequence
            {
                return Ok(Some(answer));
            }
            remaining = deadline.saturating_duration_since(Instant::now());
            if remaining.is_zero() {
                return Ok(None);
            }
        }
    }
}

impl<const N: usize, const M: usize, const NY: usize> Transport<N, M, NY> for UdpTransport<N, M, NY> {
    fn read(&mut self) -> Result<Option<Reading<N, NY>>, TransportError> {
        let answer = self.ask_connected(Message::Query)?;
        Ok(answer.and_then(|answer| match answer.message {
            Message::Measured { positions, velocities, torques } => {
                Some(Reading { positions, velocities, torques, brakes: answer.brakes })
            }
            _ => None,
        }))
    }

    fn write(&mut self, inputs: &[f64; M]) -> Result<(), TransportError> {
        require_finite(inputs)?;
        let number = self.connected_number()?;
        self.send(number, Message::Inputs(*inputs))
    }

    /// Releases the brakes and waits for the confirmation. Repeats the command if the confirmation is missing.
    fn release(&mut self) -> Result<(), TransportError> {
        for _ in 0..RELEASE_ATTEMPTS {
            let answer = self.ask_connected(Message::Release)?;
            if answer.is_some_and(|answer| answer.brakes == Brakes::Released) {
                return Ok(());
            }
        }
        Err(TransportError::Io(io::ErrorKind::TimedOut))
    }

    fn brake(&mut self) -> Result<(), TransportError> {
        let number = self.connected_number()?;
        self.send(number, Message::Brake)
    }
}

/// Whether the error is a timeout. The kind of this error depends on the operating system.
pub(super) fn is_timeout(e: &io::Error) -> bool {
    matches!(e.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut)
}
