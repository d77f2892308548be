//! The control loop: timing and order of its steps.

use super::controller::{Controller, LearnedJoint};
use super::guard::EncoderGuard;
use super::law::JointLaw;
use super::log::{LogRecord, LogSink};
use super::reference::Reference;
use super::report::{Counts, End, LoopReport, Source, StopReason};
use super::settings::{LoopSettings, SettingError, require};
use super::stage::{STAGES, Stage};
use super::stop_request::StopRequest;
use super::unwrapped::Unwrapped;
use super::velocity_filter::VelocityFilter;
use crate::clock::Clock;
use crate::trajectory::Trajectory;
use crate::transport::{Brakes, Reading, Transport};
use std::time::Duration;

/// Phase of the loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Phase {
    /// The loop has not started. The brakes are engaged if the loop has commanded them.
    Idle,
    /// The robot follows the trajectory.
    Running,
    /// The robot slows down along the path, and then brakes for this reason.
    Stopping(StopReason),
    /// The loop repeats the brake command for at most `left` more periods.
    Braking { end: End, left: u32 },
    /// The run has ended.
    Ended(End),
}

/// State that changes during a run.
#[derive(Debug, Clone)]
pub(super) struct State<const N: usize, const M: usize, const NY: usize> {
    pub phase: Phase,
    /// Clock time at the start of period 0.
    pub origin: Duration,
    /// Number of the current period.
    pub index: u64,
    pub reference: Reference,
    pub guard: EncoderGuard<N>,
    /// Last plausible positions.
    pub believed: Unwrapped<N, NY>,
    /// Last desired positions.
    pub desired: Unwrapped<N, NY>,
    pub filter: VelocityFilter<N>,
    /// Inputs that the robot holds.
    pub inputs: [f64; M],
    /// Consecutive periods without a plausible measurement.
    pub unmeasured: u32,
    /// Consecutive periods without a successful controller step.
    pub failures: u32,
    /// Consecutive periods in which no inputs were written to the robot.
    pub unwritten: u64,
    pub brakes: Brakes,
    /// Whether velocities (0) and torques (1) were measured at the start. Only measured quantities have columns in
    /// the log.
    pub(super) measures: [bool; 2],
    /// Whether warm-ups are enabled; false after a warm-up that exceeded its time.
    pub(super) warms_up: bool,
    pub counts: Counts,
}

/// Control loop that drives a robot along a trajectory at a fixed rate. The [module](super) documents the
/// reaction to each fault.
///
/// The type parameters are the fallback law `L`, the trajectory `R`, the controller `C`, the transport `T` and
/// the clock `K`. The loop owns these objects. To keep a transport or controller, pass a `&mut` reference.
pub struct ControlLoop<L, R, C, T, K, const N: usize, const M: usize, const NY: usize = N>
where
    L: JointLaw<N, M, NY>,
    R: Trajectory<N, NY>,
    C: Controller<N, M, NY>,
    T: Transport<N, M, NY>,
    K: Clock,
{
    pub(super) settings: LoopSettings<N, M>,
    pub(super) period: Duration,
    /// Period of the loop (s).
    pub(super) seconds: f64,
    /// Names of joints and inputs, for messages.
    pub(super) joints: [&'static str; N],
    pub(super) inputs: [&'static str; M],
    pub(super) fallback: L,
    pub(super) trajectory: R,
    pub(super) controller: C,
    pub(super) transport: T,
    pub(super) clock: K,
    log: Option<LogSink<N, M, NY>>,
    pub(super) stop: StopRequest,
    pub(super) state: State<N, M, NY>,
}

impl<L, R, C, T, K, const N: usize, const M: usize, const NY: usize> ControlLoop<L, R, C, T, K, N, M, NY>
where
    L: JointLaw<N, M, NY>,
    R: Trajectory<N, NY>,
    C: Controller<N, M, NY>,
    T: Transport<N, M, NY>,
    K: Clock,
{
    /// Constructs a loop without accessing the robot. The law `fallback` is used for the controlled stop, and if
    /// the controller fails. It is usually a [`JointPd`](super::JointPd). If the duration of the trajectory is
    /// infinite, the loop runs until a stop is requested.
    ///
    /// # Errors
    /// [`SettingError`] for settings out of range, and for a trajectory whose duration is NaN.
    pub fn new(
        settings: LoopSettings<N, M>,
        fallback: L,
        trajectory: R,
        controller: C,
        transport: T,
        clock: K,
    ) -> Result<Self, SettingError> {
        let (joints, inputs) = (fallback.joint_names(), fallback.input_names());
        settings.check(&joints, &inputs)?;
        settings.check_quaternions(fallback.quaternion_joints())?;
        require("trajectory.duration", trajectory.duration(), "a number (s)", |x| !x.is_nan())?;
        let period = settings.period();
        let start = Unwrapped::at(trajectory.sample(0.0).positions, &fallback);
        let coordinates = start.coordinates;
        let state = State {
            phase: Phase::Idle,
            origin: Duration::ZERO,
            index: 0,
            reference: Reference::Running { time: 0.0 },
            guard: EncoderGuard::new(settings.guard, coordinates, coordinates).with_names(joints),
            believed: start,
            desired: start,
            filter: VelocityFilter::new(settings.velocity_time_constant, coordinates),
            inputs: [0.0; M],
            unmeasured: 0,
            failures: 0,
            unwritten: 0,
            brakes: Brakes::Unknown,
            measures: [false; 2],
            warms_up: settings.warm_up > 0.0,
            counts: Counts::default(),
        };
        Ok(Self {
            period,
            seconds: period.as_secs_f64(),
            settings,
            joints,
            inputs,
            fallback,
            trajectory,
            controller,
            transport,
            clock,
            log: None,
            stop: StopRequest::new(),
            state,
        })
    }

    /// Sets a log, which gets a record of every period.
    #[must_use]
    pub fn with_log(mut self, log: LogSink<N, M, NY>) -> Self {
        self.log = Some(log);
        self
    }

    /// Sets a stop request, which the loop checks in every period.
    #[must_use]
    pub fn with_stop_request(mut self, stop: StopRequest) -> Self {
        self.stop = stop;
        self
    }

    /// The transport, for example to inspect a simulated robot.
    pub fn transport(&self) -> &T {
        &self.transport
    }

    /// The controller.
    pub fn controller(&self) -> &C {
        &self.controller
    }

    /// Starts the robot, runs all periods, brakes, and returns the report of the run.
    pub fn run(&mut self) -> LoopReport<N> {
        if self.start().is_ok() {
            while self.period() {}
        }
        self.report()
    }

    /// Report with the counts so far.
    #[must_use]
    pub fn report(&self) -> LoopReport<N> {
        let end = match self.state.phase {
            Phase::Idle | Phase::Running | Phase::Stopping(_) => End::Running,
            Phase::Braking { end, .. } | Phase::Ended(end) => end,
        };
        let learned = self.learned().map(|joint| joint.map(|joint| joint.state));
        let (brakes, counts) = (self.state.brakes, self.state.counts);
        LoopReport { end, brakes, counts, joints: self.joints, learned }
    }

    /// Sleeps until the next period and runs it. Returns false after the end of the run.
    pub fn period(&mut self) -> bool {
        if matches!(self.state.phase, Phase::Idle | Phase::Ended(_)) {
            return false;
        }
        let wake = self.beginning_of(self.state.index);
        self.warm_up_before(wake);
        self.clock.sleep_until(wake);
        let begin = self.clock.now();
        let lateness = begin.saturating_sub(wake);
        // Whole periods that the sleep missed are skipped. The times of later periods do not change.
        let skipped = (lateness.as_nanos() / self.period.as_nanos()) as u64;
        self.state.index += skipped;
        let counts = &mut self.state.counts;
        counts.periods += 1;
        counts.latest_wake = counts.latest_wake.max(lateness);
        counts.lateness.add(lateness);
        let mut watch = Stopwatch::new(begin);
        let record = match self.state.phase {
            Phase::Braking { end, left } => self.brake_again(end, left),
            _ => self.drive(skipped, &mut watch),
        };
        let learned = if self.log.is_some() { self.learned() } else { [None; N] };
        if let Some(log) = &mut self.log {
            let learned = learned.map(|joint| joint.map(|joint| (joint.friction, joint.state.trust)));
            log.push(LogRecord {
                learned,
                lateness: nanoseconds(lateness),
                stages: core::array::from_fn(|i| nanoseconds(watch.stages[i])),
                ..record
            });
        }
        watch.lap(Stage::Log, self.clock.now());
        self.state.index += 1;
        self.state.counts.take_times(&watch.stages, &self.settings.budgets);
        !matches!(self.state.phase, Phase::Ended(_))
    }

    /// Runs one period of control. The deadline is the beginning of the next period.
    fn drive(&mut self, skipped: u64, watch: &mut Stopwatch) -> LogRecord<N, M, NY> {
        let deadline = self.beginning_of(self.state.index + 1);
        let periods = u32::try_from(skipped).unwrap_or(u32::MAX).saturating_add(1);
        self.miss(skipped);
        let time = self.time();
        let span = f64::from(periods) * self.seconds;
        self.state.reference.advance(time, span);
        self.state.guard.elapse(span);
        if self.stop.is_raised() && self.state.phase == Phase::Running {
            self.slow_down(StopReason::Requested);
        }
        // During a stop, the motion stays on the path on which the stop began.
        if self.state.phase == Phase::Running {
            self.trajectory.begin_period(self.state.reference.time());
        }
        let desired = self.state.reference.sample(&self.trajectory);
        self.state.desired = self.state.desired.moved_to(&desired.positions, &self.fallback);
        let reading = self.read(periods);
        watch.lap(Stage::Read, self.clock.now());
        let proposal = self.propose(&desired, reading.believed, periods);
        watch.lap(Stage::Control, self.clock.now());
        let inputs = self.check(proposal.inputs);
        watch.lap(Stage::Check, self.clock.now());
        let mut source = proposal.source;
        if self.is_driving() {
            let late = self.clock.now() >= deadline;
            if !self.write(&inputs, late) {
                source = Source::Late;
            }
        }
        watch.lap(Stage::Write, self.clock.now());
        if self.is_driving() {
            self.state.counts.take_source(source);
        } else {
            source = Source::Brake;
        }
        LogRecord {
            time,
            positions: reading.reading.positions,
            velocities: self.velocities(),
            measured_velocities: self.logged(0, reading.reading.velocities),
            measured_torques: self.logged(1, reading.reading.torques),
            desired: desired.positions,
            inputs: self.state.inputs,
            source,
            believed: reading.believed.is_some(),
            iterations: proposal.iterations,
            lateness: 0,
            stages: [0; 4],
            learned: [None; N],
        }
    }

    /// Writes the inputs. Returns true if they were written. Late inputs are not written, because they were
    /// computed for a period that is over.
    fn write(&mut self, inputs: &[f64; M], late: bool) -> bool {
        if late {
            self.miss(1);
            return false;
        }
        if let Err(error) = self.transport.write(inputs) {
            self.state.counts.transport_errors += 1;
            self.leave_unwritten(1, StopReason::Transport(error));
            return false;
        }
        self.state.unwritten = 0;
        self.state.inputs = *inputs;
        true
    }

    fn miss(&mut self, periods: u64) {
        if periods > 0 {
            self.state.counts.deadline_misses += periods;
            self.leave_unwritten(periods, StopReason::DeadlineMissed);
            let counts = &mut self.state.counts;
            counts.longest_miss = counts.longest_miss.max(self.state.unwritten);
        }
    }

    fn leave_unwritten(&mut self, periods: u64, reason: StopReason) {
        self.state.unwritten += periods;
        if self.state.unwritten > u64::from(self.settings.hold_periods) {
            self.engage(End::Stopped(reason));
        }
    }

    /// Engages the brakes now, and commands them again in the following periods. Has no effect if the brakes
    /// are already commanded.
    pub(super) fn engage(&mut self, end: End) {
        if self.is_driving() {
            let left = self.settings.brake_periods;
            self.state.phase = Phase::Braking { end, left };
            self.state.inputs = [0.0; M];
            self.brake();
        }
    }

    pub(super) fn brake(&mut self) {
        if self.transport.brake().is_err() {
            self.state.counts.transport_errors += 1;
        }
    }

    fn brake_again(&mut self, end: End, left: u32) -> LogRecord<N, M, NY> {
        self.brake();
        let arrived = self.transport.read().unwrap_or_else(|_| {
            self.state.counts.transport_errors += 1;
            None
        });
        // A brake state that was read before the brake command does not show the present state.
        let reading = arrived.unwrap_or(Reading::of([f64::NAN; NY], Brakes::Unknown));
        self.state.brakes = reading.brakes;
        self.state.phase = if self.state.brakes == Brakes::Engaged || left == 0 {
            Phase::Ended(end)
        } else {
            Phase::Braking { end, left: left - 1 }
        };
        LogRecord {
            time: self.time(),
            positions: reading.positions,
            velocities: *self.state.filter.velocities(),
            measured_velocities: self.logged(0, reading.velocities),
            measured_torques: self.logged(1, reading.torques),
            desired: self.state.reference.sample(&self.trajectory).positions,
            inputs: [0.0; M],
            source: Source::Brake,
            believed: false,
            iterations: 0,
            lateness: 0,
            stages: [0; 4],
            learned: [None; N],
        }
    }

    /// Learned friction at the last positions and velocities.
    fn learned(&self) -> [Option<LearnedJoint>; N] {
        self.controller.learned(&self.state.believed.positions, &self.velocities())
    }

    /// Value of quantity 0 (velocities) or 1 (torques) for the log; `None` if the robot does not measure this
    /// quantity, NaN if the value is missing in this period.
    fn logged(&self, quantity: usize, values: Option<[f64; N]>) -> Option<[f64; N]> {
        self.state.measures[quantity].then(|| values.unwrap_or([f64::NAN; N]))
    }

    /// Whether the loop writes inputs and does not command the brakes.
    pub(super) fn is_driving(&self) -> bool {
        matches!(self.state.phase, Phase::Running | Phase::Stopping(_))
    }

    fn beginning_of(&self, index: u64) -> Duration {
        let nanos = nanoseconds(self.period).saturating_mul(index);
        self.state.origin.saturating_add(Duration::from_nanos(nanos))
    }

    /// Time since the start of the trajectory (s), negative while the brakes are released.
    pub(super) fn time(&self) -> f64 {
        self.state.index as f64 * self.seconds - self.release_time()
    }

    /// Release time (s), rounded to whole periods so that the trajectory starts at the beginning of a period.
    pub(super) fn release_time(&self) -> f64 {
        (self.settings.release_time / self.seconds).ceil() * self.seconds
    }
}

/// Engages the brakes if the loop ends early, also by a panic.
impl<L, R, C, T, K, const N: usize, const M: usize, const NY: usize> Drop
    for ControlLoop<L, R, C, T, K, N, M, NY>
where
    L: JointLaw<N, M, NY>,
    R: Trajectory<N, NY>,
    C: Controller<N, M, NY>,
    T: Transport<N, M, NY>,
    K: Clock,
{
    fn drop(&mut self) {
        if !matches!(self.state.phase, Phase::Idle | Phase::Ended(_)) {
            self.brake();
        }
    }
}

/// Measured duration of each stage of a period.
struct Stopwatch {
    last: Duration,
    stages: [Duration; STAGES],
}

impl Stopwatch {
    fn new(now: Duration) -> Self {
        Self { last: now, stages: [Duration::ZERO; STAGES] }
    }

    fn lap(&mut self, stage: Stage, now: Duration) {
        self.stages[stage as usize] = now.saturating_sub(self.last);
        self.last = now;
    }
}

fn nanoseconds(span: Duration) -> u64 {
    u64::try_from(span.as_nanos()).unwrap_or(u64::MAX)
}
