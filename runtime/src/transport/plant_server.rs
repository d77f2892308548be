//! The robot's side of the UDP connection: a process with a simulated robot (plant process).

use super::Brakes;
use super::datagram::{Datagram, MAX_DATAGRAM, Message, Push, TrueState};
use super::udp::is_timeout;
use crate::dynamics::Dynamics;
use crate::plant::{Plant, PlantError, wrench_forces};
use rand::rngs::SysRng;
use rand::{RngExt, SeedableRng, TryRng};
use rand_chacha::ChaCha8Rng;
use std::io;
use std::net::{SocketAddr, ToSocketAddrs, UdpSocket};
use std::ops::Range;
use std::sync::Arc;
use std::time::{Duration, Instant};
use thiserror::Error;

/// Time base of the plant in a [`PlantServer`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pace {
    /// Each query advances the plant by one period, independently of the speed of the machine. Without a
    /// controller the plant does not move.
    LockStep,
    /// The plant moves with the monotonic clock.
    RealTime,
}

/// Settings of a [`PlantServer`].
#[derive(Debug, Clone, PartialEq)]
pub struct ServerOptions {
    /// Period of the plant (s).
    pub period: f64,
    /// Time base of the plant.
    pub pace: Pace,
    /// Number of consecutive periods without inputs after which the plant engages its brakes, like the watchdog of a drive.
    pub watchdog_periods: u32,
    /// Probability that a datagram is lost, in each direction.
    pub loss: f64,
    /// Range of periods in which all datagrams are lost, counted from the first query.
    pub silence: Range<u64>,
    /// Seed of the random losses.
    pub seed: u64,
}

impl Default for ServerOptions {
    /// A period of 20 ms in real time, a watchdog of 5 periods, and no losses.
    fn default() -> Self {
        Self { period: 0.02, pace: Pace::RealTime, watchdog_periods: 5, loss: 0.0, silence: 0..0, seed: 0 }
    }
}

/// Error of a plant process.
#[derive(Debug, Error)]
pub enum ServerError {
    /// The socket failed.
    #[error("the socket failed: {0}")]
    Io(#[from] io::Error),
    /// The plant could not be restarted after its simulation failed.
    #[error(transparent)]
    Plant(#[from] PlantError),
    /// An option is out of range.
    #[error("server option {option} is {value}, but must be {range}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// Value of the option that is out of range.
        value: f64,
        /// Allowed range of the option, as text.
        range: &'static str,
    },
}

/// Function that returns the Jacobian of a frame for positions, in the axes of the world. The first three rows belong to
/// the linear velocity of the origin, the last three rows to the angular velocity.
type Frame<const N: usize, const NY: usize> = Arc<dyn Fn(&[f64; NY]) -> [[f64; N]; 6] + Send + Sync>;

/// Connection to a controller, with the sequence number of the last accepted datagram.
#[derive(Debug, Clone, Copy)]
struct Connection {
    controller: SocketAddr,
    number: u32,
    sequence: u64,
}

impl Connection {
    /// Whether a datagram belongs to this connection and is newer than the last accepted datagram. Returns true at most once
    /// for each datagram, because it stores the sequence number.
    fn takes<const N: usize, const M: usize, const NY: usize>(
        &mut self,
        question: &Datagram<N, M, NY>,
        from: SocketAddr,
    ) -> bool {
        // The difference is a signed number, so that 0 follows the largest number.
        let rises = question.sequence.wrapping_sub(self.sequence).cast_signed() > 0;
        let taken = rises && self.controller == from && self.number == question.connection;
        if taken {
            self.sequence = question.sequence;
        }
        taken
    }
}

/// Largest number of periods that a server in real time simulates at once. After a longer pause of the machine, the plant
/// engages its brakes and continues from its last state.
const MAX_CATCH_UP: u32 = 1000;

impl ServerOptions {
    fn check(&self) -> Result<(), ServerError> {
        let refuse = |option, value, range| Err(ServerError::Option { option, value, range });
        if !(1e-6..=60.0).contains(&self.period) {
            return refuse("period", self.period, "1e-6 to 60 s");
        }
        if !(0.0..=1.0).contains(&self.loss) {
            return refuse("loss", self.loss, "a probability, 0 to 1");
        }
        Ok(())
    }
}

/// A server with a simulated robot (plant) that controllers connect to over UDP. The plant starts with engaged brakes. It
/// obeys the controller that connected last, and executes each command once, see [`datagram`](super::datagram). Any program
/// that can reach the port can connect. Therefore bind the server to this machine (`127.0.0.1`) or to a separate network.
///
/// No datagram ends the server. If the simulation fails, for example because of an input of 1e308 N m, this counts as a
/// breakdown of the robot. The plant then restarts at rest at its last position, with engaged brakes and without a
/// controller. Controllers get [`TransportError::Restarted`](super::TransportError::Restarted).
/// [`breakdowns`](Self::breakdowns) returns the number of breakdowns.
pub struct PlantServer<D, const N: usize, const M: usize, const NY: usize = N> {
    plant: Plant<D, N, M, NY>,
    socket: UdpSocket,
    options: ServerOptions,
    frames: Vec<Frame<N, NY>>,
    connection: Option<Connection>,
    offered: Option<Connection>,
    losses: ChaCha8Rng,
    /// Inputs that were received since the last step of the plant; `None` if no inputs were received.
    received: Option<[f64; M]>,
    periods: u64,
    /// Number of consecutive periods without inputs.
    silent_periods: u32,
    /// Instant up to which the plant has moved. It is used only in real time.
    reached: Instant,
    observed: TrueState<N, NY>,
    breakdowns: u64,
    last_breakdown: Option<PlantError>,
}

impl<D: Dynamics<N, M, NY>, const N: usize, const M: usize, const NY: usize> PlantServer<D, N, M, NY> {
    /// Binds a socket to `address` and engages the brakes of the plant. Port 0 selects any free port.
    ///
    /// # Errors
    /// [`ServerError::Option`] for an option out of range. [`ServerError::Io`] if the socket cannot be bound.
    pub fn bind(
        mut plant: Plant<D, N, M, NY>,
        address: impl ToSocketAddrs,
        options: ServerOptions,
    ) -> Result<Self, ServerError> {
        options.check()?;
        plant.brake();
        let (positions, velocities) = plant.state();
        Ok(Self {
            socket: UdpSocket::bind(address)?,
            frames: Vec::new(),
            connection: None,
            offered: None,
            losses: ChaCha8Rng::seed_from_u64(options.seed),
            received: None,
            periods: 0,
            silent_periods: 0,
            reached: Instant::now(),
            observed: TrueState {
                positions,
                velocities,
                lowest: positions,
                highest: positions,
                fastest: velocities.map(f64::abs),
            },
            breakdowns: 0,
            last_breakdown: None,
            plant,
            options,
        })
    }

    /// Adds a frame for [`Push::Frame`]. Frames are numbered from 0 in the order of these calls.
    ///
    /// - `jacobian`: function `frame_…_jacobian` of the generated module, which returns the Jacobian of the frame in the axes
    ///   of the world
    #[must_use]
    pub fn with_frame(
        mut self,
        jacobian: impl Fn(&[f64; NY]) -> [[f64; N]; 6] + Send + Sync + 'static,
    ) -> Self {
        self.frames.push(Arc::new(jacobian));
        self
    }

    /// Address of the server's socket.
    ///
    /// # Errors
    /// [`io::Error`] if the system does not report the address.
    pub fn local_address(&self) -> io::Result<SocketAddr> {
        self.socket.local_addr()
    }

    /// The plant.
    pub fn plant(&self) -> &Plant<D, N, M, NY> {
        &self.plant
    }

    /// Number of breakdowns of the plant.
    pub fn breakdowns(&self) -> u64 {
        self.breakdowns
    }

    /// Error of the last breakdown; `None` if the plant has never broken down.
    pub fn last_breakdown(&self) -> Option<&PlantError> {
        self.last_breakdown.as_ref()
    }

    /// Answers datagrams until no datagram arrives for the time `idle`.
    ///
    /// # Errors
    /// The errors of [`Self::serve_one`].
    pub fn serve(&mut self, idle: Duration) -> Result<(), ServerError> {
        let mut last = Instant::now();
        while last.elapsed() < idle {
            if self.serve_one()? {
                last = Instant::now();
            }
        }
        Ok(())
    }

    /// Waits for a datagram for at most one period, and answers it. Returns true if a valid datagram arrived.
    ///
    /// # Errors
    /// [`ServerError::Io`] if the socket fails. [`ServerError::Plant`] if the plant cannot be restarted after a breakdown.
    pub fn serve_one(&mut self) -> Result<bool, ServerError> {
        let wait = Duration::from_secs_f64(self.options.period.clamp(1e-4, 1.0));
        self.socket.set_read_timeout(Some(wait))?;
        let mut buffer = [0; MAX_DATAGRAM + 1];
        let received = self.socket.recv_from(&mut buffer);
        if self.options.pace == Pace::RealTime {
            self.catch_up()?;
        }
        let (length, from) = match received {
            Ok(received) => received,
            // The server continues if a controller has gone.
            Err(e) if is_timeout(&e) || e.kind() == io::ErrorKind::ConnectionRefused => {
                return Ok(false);
            }
            Err(e) if e.kind() == io::ErrorKind::Interrupted => return Ok(false),
            Err(e) => return Err(e.into()),
        };
        let Ok(question) = Datagram::decode(&buffer[..length]) else {
            return Ok(false);
        };
        let mut buffer = [0; MAX_DATAGRAM];
        if let Some(answer) = self.respond(&question, from)?
            && let Ok(bytes) = answer.encode(&mut buffer)
        {
            // A datagram that cannot be sent counts as lost.
            let _ = self.socket.send_to(bytes, from);
        }
        Ok(true)
    }

    /// Processes a datagram that did not arrive over the socket of this server. Returns the answer; `None` if the message has
    /// no answer.
    ///
    /// # Errors
    /// [`ServerError::Plant`] if the plant cannot be restarted after a breakdown. [`ServerError::Io`] if the operating
    /// system provides no random number.
    pub fn respond(
        &mut self,
        question: &Datagram<N, M, NY>,
        from: SocketAddr,
    ) -> Result<Option<Datagram<N, M, NY>>, ServerError> {
        let message = self.answer(question, from)?;
        let offered = self.offered.filter(|_| message == Some(Message::Connect));
        let connection = offered.or(self.connection).map_or(0, |connection| connection.number);
        Ok(message.map(|message| Datagram {
            connection,
            sequence: question.sequence,
            brakes: self.brakes(),
            message,
        }))
    }

    fn answer(
        &mut self,
        question: &Datagram<N, M, NY>,
        from: SocketAddr,
    ) -> Result<Option<Message<N, M, NY>>, ServerError> {
        let lost = self.is_lost();
        let obeyed = self.obeys(question, from);
        let lock_step = self.options.pace == Pace::LockStep;
        if obeyed && lock_step && question.message == Message::Query {
            self.advance()?;
        }
        Ok(match question.message {
            Message::Inspect => Some(Message::TrueState(self.observed)),
            Message::Connect | Message::Query | Message::Release | Message::Push(_) if lost => {
                lock_step.then_some(Message::Lost)
            }
            Message::Connect => {
                let number = SysRng.try_next_u32().map_err(io::Error::other)?.max(1);
                self.offered = Some(Connection { controller: from, number, sequence: question.sequence });
                Some(Message::Connect)
            }
            Message::Query | Message::Release | Message::Push(_) => {
                if obeyed {
                    self.obey(&question.message);
                }
                Some(self.measured())
            }
            Message::Inputs(_) | Message::Brake => {
                if obeyed && !lost {
                    self.obey(&question.message);
                }
                None
            }
            // These kinds are answers, which a server ignores.
            Message::Measured { .. } | Message::Lost | Message::TrueState(_) => None,
        })
    }

    /// Whether a command is new and from the controller. The first command with an offered number makes its sender the
    /// controller.
    fn obeys(&mut self, question: &Datagram<N, M, NY>, from: SocketAddr) -> bool {
        if matches!(question.message, Message::Inspect | Message::Connect) {
            return false;
        }
        if self.connection.as_mut().is_some_and(|known| known.takes(question, from)) {
            return true;
        }
        let offered = self.offered.take_if(|offered| offered.takes(question, from));
        let is_push = matches!(question.message, Message::Push(_));
        if offered.is_some() && !is_push {
            self.plant.brake();
            self.received = None;
            self.connection = offered;
        }
        offered.is_some()
    }

    fn obey(&mut self, command: &Message<N, M, NY>) {
        match *command {
            Message::Release => {
                self.plant.release();
                self.silent_periods = 0;
            }
            Message::Inputs(inputs) => self.received = Some(inputs),
            Message::Brake => self.plant.brake(),
            Message::Push(Push::Joints { duration, forces }) => self.plant.push(duration, move |_| forces),
            Message::Push(Push::Frame { duration, frame, wrench }) => {
                if let Some(jacobian) = self.frames.get(usize::from(frame)).cloned() {
                    self.plant.push(duration, move |y| wrench_forces(&jacobian(y), &wrench));
                }
            }
            _ => {}
        }
    }

    fn measured(&self) -> Message<N, M, NY> {
        let measurement = self.plant.measure();
        Message::Measured {
            positions: measurement.positions,
            velocities: measurement.velocities,
            torques: measurement.torques,
        }
    }

    fn is_lost(&mut self) -> bool {
        let lost = self.losses.random::<f64>() < self.options.loss;
        lost || self.options.silence.contains(&self.periods)
    }

    fn brakes(&self) -> Brakes {
        if self.plant.is_braked() { Brakes::Engaged } else { Brakes::Released }
    }

    fn catch_up(&mut self) -> Result<(), ServerError> {
        let period = Duration::from_secs_f64(self.options.period);
        for _ in 0..MAX_CATCH_UP {
            if self.reached + period > Instant::now() {
                return Ok(());
            }
            self.reached += period;
            self.advance()?;
        }
        self.reached = Instant::now();
        Ok(())
    }

    fn advance(&mut self) -> Result<(), ServerError> {
        let period = self.options.period;
        let moved = if let Some(inputs) = self.received.take() {
            self.silent_periods = 0;
            self.plant.apply(&inputs, period)
        } else {
            self.silent_periods = self.silent_periods.saturating_add(1);
            if self.silent_periods > self.options.watchdog_periods {
                self.plant.brake();
            }
            self.plant.hold(period)
        };
        if let Err(fault) = moved {
            self.take_up_again(fault)?;
        }
        self.periods = self.periods.saturating_add(1);
        self.observe();
        Ok(())
    }

    /// Restarts the plant at its last position after an error.
    fn take_up_again(&mut self, fault: PlantError) -> Result<(), ServerError> {
        let (positions, _) = self.plant.state();
        self.plant.reset(positions, [0.0; N])?;
        self.plant.brake();
        (self.connection, self.offered) = (None, None);
        self.breakdowns += 1;
        self.last_breakdown = Some(fault);
        Ok(())
    }

    fn observe(&mut self) {
        let (positions, velocities) = self.plant.state();
        let seen = &mut self.observed;
        (seen.positions, seen.velocities) = (positions, velocities);
        for i in 0..NY {
            seen.lowest[i] = seen.lowest[i].min(positions[i]);
            seen.highest[i] = seen.highest[i].max(positions[i]);
        }
        for i in 0..N {
            seen.fastest[i] = seen.fastest[i].max(velocities[i].abs());
        }
    }
}
