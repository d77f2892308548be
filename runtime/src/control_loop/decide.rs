//! Decisions of the loop in a period: plausibility of the measurement, choice of the inputs, and stop.

use super::controller::{Controller, ControllerFault, Cycle};
use super::guard::EncoderFault;
use super::law::JointLaw;
use super::monitor::{Situation, check_state, limit_inputs};
use super::report::{Counts, End, Source, StopReason};
use super::run::{ControlLoop, Phase};
use super::stage::STAGES;
use super::unwrapped::Unwrapped;
use crate::clock::Clock;
use crate::dynamics::DependentJoint;
use crate::input_limits::limit_torques;
use crate::trajectory::{Sample, Trajectory};
use crate::transport::{Brakes, Reading, Transport, TransportError};
use std::time::Duration;

/// A reading with the result of the plausibility check.
pub(super) struct Judged<const N: usize, const NY: usize> {
    /// The reading; its positions are NaN if no reading arrived.
    pub reading: Reading<N, NY>,
    /// Plausible part of the reading; `None` if the reading is missing or not plausible.
    pub believed: Option<Measured<N, NY>>,
}

/// Plausible part of a reading.
#[derive(Clone, Copy)]
pub(super) struct Measured<const N: usize, const NY: usize> {
    pub positions: [f64; NY],
    pub velocities: Option<[f64; N]>,
    /// Torques; `None` if they are missing or not finite. The loop also runs without torques.
    pub torques: Option<[f64; N]>,
}

/// Proposed inputs, before they are clamped to their limits.
pub(super) struct Proposal<const M: usize> {
    pub inputs: [f64; M],
    pub source: Source,
    pub iterations: u32,
}

impl<L, R, C, T, K, const N: usize, const M: usize, const NY: usize> ControlLoop<L, R, C, T, K, N, M, NY>
where
    L: JointLaw<N, M, NY>,
    R: Trajectory<N, NY>,
    C: Controller<N, M, NY>,
    T: Transport<N, M, NY>,
    K: Clock,
{
    /// Reads and checks a measurement. Brakes if there was no plausible measurement for too long.
    pub(super) fn read(&mut self, periods: u32) -> Judged<N, NY> {
        let missing = Judged { reading: Reading::of([f64::NAN; NY], Brakes::Unknown), believed: None };
        let reading = match self.transport.read() {
            Ok(Some(reading)) => reading,
            Ok(None) => {
                self.state.counts.missing += 1;
                self.go_unmeasured(periods, StopReason::NoMeasurement);
                return missing;
            }
            Err(TransportError::Restarted) => {
                self.engage(End::Stopped(StopReason::Restarted));
                return missing;
            }
            Err(error) => {
                self.state.counts.missing += 1;
                self.state.counts.transport_errors += 1;
                self.go_unmeasured(periods, StopReason::Transport(error));
                return missing;
            }
        };
        self.state.brakes = reading.brakes;
        if reading.brakes == Brakes::Engaged && self.state.reference.time() >= 0.0 {
            self.engage(End::Stopped(StopReason::BrakedByRobot));
        }
        let (_, age) = self.state.guard.believed();
        let believed = match self.judge(&reading) {
            Ok(moved) => {
                self.state.unmeasured = 0;
                self.state.believed = moved;
                self.estimate_velocities(&reading, age);
                Some(Measured {
                    positions: reading.positions,
                    velocities: reading.velocities,
                    torques: reading.torques.filter(is_finite),
                })
            }
            Err(fault) => {
                self.state.counts.take_encoder_fault(&fault);
                self.go_unmeasured(periods, StopReason::Encoder(fault));
                None
            }
        };
        Judged { reading, believed }
    }

    /// Returns the unwrapped positions of a reading if the guard accepts it.
    fn judge(&mut self, reading: &Reading<N, NY>) -> Result<Unwrapped<N, NY>, EncoderFault> {
        let moved = self.state.believed.moved_to(&reading.positions, &self.fallback);
        self.fallback.check_attitudes(&reading.positions).map_err(EncoderFault::Attitude)?;
        let desired = &self.state.desired.coordinates;
        self.state.guard.check(&moved.coordinates, reading.velocities.as_ref(), desired)?;
        Ok(moved)
    }

    /// Updates the velocity estimate: with measured velocities, or with positions that are `age` seconds
    /// after the last ones.
    fn estimate_velocities(&mut self, reading: &Reading<N, NY>, age: f64) {
        let (filter, coordinates) = (&mut self.state.filter, &self.state.believed.coordinates);
        // Both updates get values that passed the guard, so numbers are finite and differences do not overflow.
        let _ = match &reading.velocities {
            Some(velocities) => filter.update_measured(coordinates, velocities),
            None => filter.update(coordinates, age),
        };
    }

    fn go_unmeasured(&mut self, periods: u32, reason: StopReason) {
        self.state.unmeasured = self.state.unmeasured.saturating_add(periods);
        if self.state.unmeasured > self.settings.hold_periods {
            self.engage(End::Stopped(reason));
        }
    }

    /// Inputs from the controller or its fallbacks; always finite.
    pub(super) fn propose(
        &mut self,
        desired: &Sample<N, NY>,
        measured: Option<Measured<N, NY>>,
        periods: u32,
    ) -> Proposal<M> {
        match self.state.phase {
            Phase::Running => self.follow_controller(desired, measured, periods),
            Phase::Stopping(_) => self.fall_back(desired, measured),
            _ => self.hold(),
        }
    }

    fn follow_controller(
        &mut self,
        desired: &Sample<N, NY>,
        measured: Option<Measured<N, NY>>,
        periods: u32,
    ) -> Proposal<M> {
        let cycle = Cycle {
            time: self.state.reference.time(),
            periods,
            positions: measured.map(|m| m.positions),
            velocities: measured.and_then(|m| m.velocities),
            torques: measured.and_then(|m| m.torques),
            last_inputs: self.state.inputs,
        };
        let fault = match self.controller.step(&cycle) {
            Ok(command) if is_finite(&command.inputs) => {
                self.state.failures = 0;
                return Proposal {
                    inputs: command.inputs,
                    source: Source::Controller,
                    iterations: command.iterations,
                };
            }
            Ok(_) => ControllerFault::NotFinite,
            Err(fault) => fault,
        };
        // A lost reading is not a fault of the controller. Another setting limits the number of lost readings.
        let lost = measured.is_none() && fault == ControllerFault::NoMeasurement;
        self.state.counts.controller_faults += u64::from(!lost);
        self.state.failures = self.state.failures.saturating_add(periods);
        if !lost && self.state.failures > self.settings.fallback_periods {
            self.slow_down(StopReason::Controller(fault));
        }
        self.follow_plan().unwrap_or_else(|| self.fall_back(desired, measured))
    }

    fn follow_plan(&self) -> Option<Proposal<M>> {
        let failures = self.state.failures;
        if failures > self.settings.plan_periods {
            return None;
        }
        let inputs = self.controller.planned(failures)?;
        is_finite(&inputs).then_some(Proposal { inputs, source: Source::Plan, iterations: 0 })
    }

    fn fall_back(&self, desired: &Sample<N, NY>, measured: Option<Measured<N, NY>>) -> Proposal<M> {
        let velocities = self.state.filter.velocities();
        let inputs = measured.and_then(|m| {
            let inputs = self.fallback.inputs_at_time(self.time(), desired, &m.positions, velocities);
            inputs.ok().filter(is_finite)
        });
        inputs.map_or_else(
            || self.hold(),
            |inputs| Proposal { inputs, source: Source::Fallback, iterations: 0 },
        )
    }

    fn hold(&self) -> Proposal<M> {
        Proposal { inputs: self.state.inputs, source: Source::Held, iterations: 0 }
    }

    /// Limits the inputs. Brakes if the state is outside its limits or the motion has ended.
    pub(super) fn check(&mut self, mut inputs: [f64; M]) -> [f64; M] {
        let limited = limit_inputs(&mut inputs, &self.settings.input_limits);
        let beyond = limit_torques(
            &mut inputs,
            self.settings.torque_speed,
            &self.settings.input_limits,
            &self.velocities(),
        );
        self.state.counts.limited_inputs += limited + beyond;
        let (positions, age) = self.state.guard.believed();
        let velocities = self.state.filter.velocities();
        let (believed, desired) = (&self.state.believed.positions, &self.state.desired.positions);
        let error = self.fallback.difference(desired, believed);
        let dependent = |joint: &DependentJoint<N>, y: &[f64; N], v: &[f64; N]| {
            self.fallback.dependent_motion_at_time(self.time(), joint, y, v)
        };
        let situation =
            Situation { positions: &positions, velocities, age, error: &error, dependent: &dependent };
        let checked = check_state(&self.settings, &self.joints, &situation);
        if let Err(fault) = checked {
            self.engage(End::Stopped(StopReason::Limit(fault)));
        } else if let Some(end) = self.end_of_motion() {
            self.engage(end);
        }
        inputs
    }

    /// End of the run, if the reference has stopped and the robot is at rest; `None` before. The wait for the robot
    /// takes at most `stop_time`. After a complete trajectory, the wait begins after `settling_time`.
    fn end_of_motion(&self) -> Option<End> {
        let (standing, end) = match self.state.phase {
            Phase::Running => {
                let over = self.trajectory.duration() + self.settings.settling_time;
                (self.state.reference.time() - over, End::Finished)
            }
            Phase::Stopping(reason) => (self.state.reference.standing()?, End::Stopped(reason)),
            _ => return None,
        };
        let velocities = self.state.filter.velocities().iter();
        let at_rest = velocities.zip(&self.settings.standstill_speed).all(|(v, limit)| v.abs() <= *limit);
        (standing >= 0.0 && (at_rest || standing >= self.settings.stop_time)).then_some(end)
    }

    /// Starts a controlled stop along the path.
    pub(super) fn slow_down(&mut self, reason: StopReason) {
        if self.state.phase == Phase::Running {
            self.state.phase = Phase::Stopping(reason);
            self.state.reference.stop(self.settings.stop_time);
        }
    }

    pub(super) fn velocities(&self) -> [f64; N] {
        let estimate = self.controller.estimate();
        estimate.map_or(*self.state.filter.velocities(), |e| e.velocities)
    }
}

impl Counts {
    pub(super) fn take_encoder_fault(&mut self, fault: &EncoderFault) {
        match fault {
            EncoderFault::NotFinite { .. } | EncoderFault::Attitude(_) => self.not_finite += 1,
            EncoderFault::Jump { .. } => self.jumps += 1,
            EncoderFault::Frozen { .. } => self.frozen += 1,
            EncoderFault::Velocity { .. } => self.velocity_faults += 1,
        }
    }

    pub(super) fn take_source(&mut self, source: Source) {
        match source {
            Source::Controller => self.controller += 1,
            Source::Plan => self.plan += 1,
            Source::Fallback => self.fallback += 1,
            Source::Held => self.held += 1,
            Source::Late | Source::Brake => {}
        }
    }

    pub(super) fn take_times(&mut self, stages: &[Duration; STAGES], budgets: &[Duration; STAGES]) {
        for i in 0..STAGES {
            self.longest[i] = self.longest[i].max(stages[i]);
            self.budget_overruns[i] += u64::from(stages[i] > budgets[i]);
        }
    }
}

fn is_finite<const L: usize>(values: &[f64; L]) -> bool {
    values.iter().all(|u| u.is_finite())
}
