//! Report of a run, with the reason for its end.

use super::controller::ControllerFault;
use super::guard::EncoderFault;
use super::lateness::Lateness;
use super::monitor::LimitFault;
use super::stage::STAGES;
use crate::dynamics::Named;
use crate::transport::{Brakes, TransportError};
use gelenk_adaptation::JointState;
use std::fmt;
use std::time::Duration;
use thiserror::Error;

/// Source of the inputs of a period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// The inputs of the controller.
    Controller,
    /// The last plan of the controller, shifted.
    Plan,
    /// The inputs of the fallback law.
    Fallback,
    /// The previous inputs, because no other inputs were available.
    Held,
    /// No inputs were written, because the deadline was missed. The robot holds its inputs.
    Late,
    /// The brakes were commanded.
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

/// Reason why the loop stopped the robot.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum StopReason {
    /// A signal or another thread requested the stop.
    #[error("a stop was requested")]
    Requested,
    /// The controller failed for too many periods.
    #[error("the controller failed: {0}")]
    Controller(ControllerFault),
    /// No reading arrived for too many consecutive periods.
    #[error("no measurement arrived for more than `hold_periods` periods")]
    NoMeasurement,
    /// Reading or writing failed for too many consecutive periods.
    #[error("{0}")]
    Transport(TransportError),
    /// No plausible reading arrived for too many consecutive periods.
    #[error("{0}")]
    Encoder(EncoderFault),
    /// Too many consecutive deadlines were missed.
    #[error("more than `hold_periods` deadlines in a row were missed")]
    DeadlineMissed,
    /// The robot violated a limit.
    #[error("{0}")]
    Limit(LimitFault),
    /// The program on the robot's side has restarted, or another controller is connected.
    #[error("the program at the robot restarted during the motion, or another controller is connected")]
    Restarted,
    /// The brakes were engaged, but not by this loop.
    #[error("the robot engaged its brakes by itself")]
    BrakedByRobot,
}

/// Reason why the loop did not start. The loop commands the brakes in this case.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum Refusal {
    /// No measurement arrived.
    #[error("no measurement arrived within `start_periods`: check that the robot is on and connected")]
    NoMeasurement,
    /// No plausible measurement arrived.
    #[error("{0}")]
    Encoder(EncoderFault),
    /// A stop was requested before the start.
    #[error("a stop was requested before the start")]
    Requested,
    /// The robot is outside its limits.
    #[error("{0}")]
    Limit(LimitFault),
    /// The robot is too far from the start of the trajectory.
    #[error(
        "joint {} is at {position:.4} rad (or m), but the trajectory begins at {start:.4}. Move the robot there first",
        Named(.name)
    )]
    Start {
        /// Index of the coordinate.
        joint: usize,
        /// Name of the joint.
        name: &'static str,
        /// Measured position [rad or m].
        position: f64,
        /// Position at which the trajectory begins [rad or m].
        start: f64,
    },
    /// The inputs cannot hold the robot at its present position within their limits.
    #[error(
        "input {} would need {needed:.4} to hold the robot at its present position, beyond its limit {limit:.4}",
        Named(.name)
    )]
    Torque {
        /// Index of the input.
        input: usize,
        /// Name of the input.
        name: &'static str,
        /// Value of the input that would hold the robot [N m, N or A]; NaN if the fallback law returns an error.
        needed: f64,
        /// Violated limit of the input [N m, N or A].
        limit: f64,
    },
    /// The transport failed.
    #[error("{0}")]
    Transport(TransportError),
}

/// End of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// The loop is still running.
    Running,
    /// The trajectory was completed.
    Finished,
    /// The loop stopped before the end of the trajectory.
    Stopped(StopReason),
    /// The loop did not start.
    Refused(Refusal),
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Running => write!(f, "running"),
            Self::Finished => write!(f, "finished"),
            Self::Stopped(reason) => write!(f, "stopped: {reason}"),
            Self::Refused(refusal) => write!(f, "the start was refused: {refusal}"),
        }
    }
}

/// Numbers of periods, faults and other events of one run.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Counts {
    /// Periods of the loop, including braking.
    pub periods: u64,
    /// Periods with inputs from the controller.
    pub controller: u64,
    /// Periods with inputs from the shifted plan.
    pub plan: u64,
    /// Periods with inputs from the fallback law.
    pub fallback: u64,
    /// Periods with the previous inputs.
    pub held: u64,
    /// Number of missed deadlines. A deadline is missed if the inputs of a period were not written before the
    /// next period. Skipped periods are included.
    pub deadline_misses: u64,
    /// Largest number of consecutive missed deadlines.
    pub longest_miss: u64,
    /// Periods without a reading.
    pub missing: u64,
    /// Readings with NaN, infinity or a quaternion that is not an attitude.
    pub not_finite: u64,
    /// Readings in which a position jumped.
    pub jumps: u64,
    /// Readings in which a position remained constant during desired motion.
    pub frozen: u64,
    /// Readings whose velocities contradicted their positions or were not finite.
    pub velocity_faults: u64,
    /// Inputs that were clamped to a limit.
    pub limited_inputs: u64,
    /// Controller steps that failed or returned numbers that are not finite. Steps that failed because the
    /// measurement was missing are not included.
    pub controller_faults: u64,
    /// Failed reads, writes and brake commands of the transport.
    pub transport_errors: u64,
    /// Stages that exceeded their time budget, indexed by [`Stage`](super::Stage).
    pub budget_overruns: [u64; STAGES],
    /// Longest time of each stage.
    pub longest: [Duration; STAGES],
    /// Longest lateness of a wake-up.
    pub latest_wake: Duration,
    /// Lateness of all wake-ups.
    pub lateness: Lateness,
    /// Number of warm-ups of the controller.
    pub warm_ups: u64,
    /// Number of warm-ups that exceeded their time ([`LoopSettings::warm_up`](super::LoopSettings::warm_up)). The
    /// number is at most 1, because the loop then disables later warm-ups.
    pub late_warm_ups: u64,
}

/// Report of a run, also during the run ([`ControlLoop::report`](super::ControlLoop::report)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopReport<const N: usize> {
    /// End of the run.
    pub end: End,
    /// State of the brakes that the robot reported after the last brake command of the loop. If they are not
    /// engaged after a run, check the robot.
    pub brakes: Brakes,
    /// Numbers of periods, faults and other events of the run.
    pub counts: Counts,
    /// Names of the joints.
    pub joints: [&'static str; N],
    /// Learned friction of each joint at the end; `None` for joints whose friction is not learned.
    pub learned: [Option<JointState>; N],
}

impl<const N: usize> fmt::Display for LoopReport<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let c = &self.counts;
        let is_sure = self.brakes == Brakes::Engaged || self.end == End::Running;
        let look = if is_sure { "" } else { "; check the robot" };
        writeln!(f, "{}; brakes {}{look}", self.end, self.brakes)?;
        writeln!(
            f,
            "{} periods: inputs from the controller in {}, the plan in {}, the fallback law in {}, unchanged in {}. {} deadlines \
             missed, at most {} in a row",
            c.periods, c.controller, c.plan, c.fallback, c.held, c.deadline_misses, c.longest_miss
        )?;
        write!(
            f,
            "{} readings missing, {} not finite, {} jumped, {} unchanged, {} with implausible velocities. {} inputs limited, {} \
             controller faults, {} transport errors",
            c.missing,
            c.not_finite,
            c.jumps,
            c.frozen,
            c.velocity_faults,
            c.limited_inputs,
            c.controller_faults,
            c.transport_errors
        )?;
        for (name, state) in self.joints.iter().zip(&self.learned) {
            let Some(state) = state else { continue };
            let (name, trust) = (Named(name), state.trust.name());
            write!(
                f,
                "\nfriction of joint {name}: state `{trust}` since {:.2} s. Learned coefficients ± half width of the 90 % interval:",
                state.since
            )?;
            for term in state.terms() {
                write!(f, " {} {:.3} ± {:.3}", term.name, term.learned, term.half_width)?;
            }
        }
        if c.late_warm_ups > 0 {
            write!(
                f,
                "\nwarm-ups of the processor caches exceeded the time `warm_up` and were disabled after warm-up {}",
                c.warm_ups
            )?;
        }
        if c.lateness.any() {
            write!(f, "\nlateness of wake-ups:\n{}", c.lateness)?;
        }
        Ok(())
    }
}
