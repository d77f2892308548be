//! Record of a run, and the reason for its end.

use super::controller::ControllerFault;
use super::guard::EncoderFault;
use super::lateness::Lateness;
use super::monitor::LimitFault;
use super::stage::STAGES;
use crate::dynamics::Named;
use crate::transport::{Brakes, TransportError};
use std::fmt;
use std::time::Duration;
use thiserror::Error;

/// Where the inputs of a period came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// The controller.
    Controller,
    /// The controller's last plan, shifted.
    Plan,
    /// The law that the loop falls back on.
    Fallback,
    /// The period before: nothing better was there.
    Held,
    /// Nothing was written: the deadline was missed, and the robot holds its inputs.
    Late,
    /// The brakes.
    Brake,
}

impl Source {
    /// Name in the log.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Controller => "controller",
            Self::Plan => "plan",
            Self::Fallback => "fallback",
            Self::Held => "held",
            Self::Late => "late",
            Self::Brake => "brake",
        }
    }
}

/// Why the loop stopped the robot.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum StopReason {
    /// A signal or another thread asked for it.
    #[error("asked to stop")]
    Requested,
    /// The controller failed for too long.
    #[error("controller: {0}")]
    Controller(ControllerFault),
    /// Too many periods in a row without a reading.
    #[error("no measurement arrived for more than `hold_periods`")]
    NoMeasurement,
    /// Too many periods in a row in which the transport could neither read nor write.
    #[error("{0}")]
    Transport(TransportError),
    /// Too many periods in a row without a believable reading.
    #[error("{0}")]
    Encoder(EncoderFault),
    /// Too many deadlines in a row were missed.
    #[error("more than `hold_periods` deadlines missed in a row")]
    DeadlineMissed,
    /// A limit was reached.
    #[error("{0}")]
    Limit(LimitFault),
    /// The robot's side restarted.
    #[error("the robot's side restarted during the motion, or has another controller")]
    Restarted,
    /// The brakes were engaged, but not by this loop.
    #[error("the robot engaged its brakes by itself")]
    BrakedByRobot,
}

/// Why the loop did not start; the brakes stay engaged.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum Refusal {
    /// Nothing was read.
    #[error("no measurement arrived within `start_periods`: check that the robot is on, and its connection")]
    NoMeasurement,
    /// Nothing believable was read.
    #[error("{0}")]
    Encoder(EncoderFault),
    /// Somebody asked to stop before the start.
    #[error("asked to stop before the start")]
    Requested,
    /// The robot is outside its limits.
    #[error("{0}")]
    Limit(LimitFault),
    /// The robot is not where the trajectory begins.
    #[error(
        "joint {} is at {position:.4}, but the trajectory begins at {start:.4}: move the robot there first",
        Named(.name)
    )]
    Start {
        /// Index of the coordinate.
        joint: usize,
        /// Its name.
        name: &'static str,
        /// Measured position [rad or m].
        position: f64,
        /// Position at which the trajectory begins [rad or m].
        start: f64,
    },
    /// The inputs cannot hold the robot where it is.
    #[error(
        "input {} would need {needed:.4} to hold the robot, more than its limit {limit:.4}",
        Named(.name)
    )]
    Torque {
        /// Index of the input.
        input: usize,
        /// Its name.
        name: &'static str,
        /// The input that would hold the robot, in the input's unit; NaN if the model has no answer.
        needed: f64,
        /// The largest input that is allowed.
        limit: f64,
    },
    /// The robot could not be reached.
    #[error("{0}")]
    Transport(TransportError),
}

/// How the loop ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// Not yet.
    Running,
    /// At the end of the trajectory.
    Finished,
    /// Before it.
    Stopped(StopReason),
    /// It never started.
    Refused(Refusal),
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Running => write!(f, "running"),
            Self::Finished => write!(f, "finished"),
            Self::Stopped(reason) => write!(f, "stopped: {reason}"),
            Self::Refused(refusal) => write!(f, "refused to start: {refusal}"),
        }
    }
}

/// Counts of one run.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Counts {
    /// Periods that the loop saw, braking included.
    pub periods: u64,
    /// Periods controlled by the controller.
    pub controller: u64,
    /// Periods on the shifted plan.
    pub plan: u64,
    /// Periods of the law that the loop falls back on.
    pub fallback: u64,
    /// Periods with the inputs of the period before.
    pub held: u64,
    /// Deadlines missed: periods whose inputs were not written before the next began, slept through ones
    /// included.
    pub deadline_misses: u64,
    /// The longest row of missed deadlines.
    pub longest_miss: u64,
    /// Readings that did not arrive.
    pub missing: u64,
    /// Readings with NaN or infinity.
    pub not_finite: u64,
    /// Readings that jumped.
    pub jumps: u64,
    /// Readings that stayed the same while motion was desired.
    pub frozen: u64,
    /// Readings whose measured velocities contradicted their positions, or were no numbers.
    pub velocity_faults: u64,
    /// Inputs that were cut off at their limit.
    pub limited_inputs: u64,
    /// Steps of the controller that failed or gave numbers that are not finite. Those that lacked a measurement are
    /// not among them.
    pub controller_faults: u64,
    /// Writes, readings and brake commands that the transport could not do.
    pub transport_errors: u64,
    /// Stages that took longer than their budget, by [`Stage`](super::Stage).
    pub budget_overruns: [u64; STAGES],
    /// Longest time of each stage.
    pub longest: [Duration; STAGES],
    /// Longest lateness of a wake-up.
    pub latest_wake: Duration,
    /// Lateness of all wake-ups.
    pub lateness: Lateness,
    /// Periods before which the controller was computed once for the caches.
    pub warm_ups: u64,
    /// Warm-ups that took longer than their time ([`LoopSettings::warm_up`](super::LoopSettings::warm_up)):
    /// at most one, since the loop then leaves them out.
    pub late_warm_ups: u64,
}

/// Result of [`ControlLoop::run`](super::ControlLoop::run), or counts so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopReport {
    /// How it ended.
    pub end: End,
    /// Brakes as the robot reported them after the loop's last command for them. Anything but engaged after a run
    /// needs a look at the robot.
    pub brakes: Brakes,
    /// The counts of the run.
    pub counts: Counts,
}

impl fmt::Display for LoopReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let c = &self.counts;
        let is_sure = self.brakes == Brakes::Engaged || self.end == End::Running;
        let look = if is_sure { "" } else { ": look at the robot" };
        writeln!(f, "{}; brakes {}{look}", self.end, self.brakes)?;
        writeln!(
            f,
            "{} periods: {} controller, {} plan, {} fallback, {} held; {} deadlines missed (at most {} in a row)",
            c.periods, c.controller, c.plan, c.fallback, c.held, c.deadline_misses, c.longest_miss
        )?;
        write!(
            f,
            "{} readings missing, {} not finite, {} jumped, {} unchanged, {} contradicted by their velocities; \
             {} inputs limited; {} controller faults; {} transport errors",
            c.missing,
            c.not_finite,
            c.jumps,
            c.frozen,
            c.velocity_faults,
            c.limited_inputs,
            c.controller_faults,
            c.transport_errors
        )?;
        if c.late_warm_ups > 0 {
            write!(
                f,
                "\nwarm-ups of the controller's caches took too long, and were left out after {}",
                c.warm_ups
            )?;
        }
        if c.lateness.any() {
            write!(f, "\nlateness of wake-ups:\n{}", c.lateness)?;
        }
        Ok(())
    }
}
