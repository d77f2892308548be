//! Start of the loop: first reading, check of the start position, and release of the brakes.

use super::controller::Controller;
use super::guard::{EncoderFault, EncoderGuard};
use super::law::JointLaw;
use super::monitor::check_positions;
use super::reference::Reference;
use super::report::{End, Refusal};
use super::run::{ControlLoop, Phase};
use super::unwrapped::Unwrapped;
use super::velocity_filter::VelocityFilter;
use crate::clock::Clock;
use crate::dynamics::{DependentJoint, plain_entries};
use crate::trajectory::{Sample, Trajectory};
use crate::transport::{Brakes, Reading, Transport};

impl<L, R, C, T, K, const N: usize, const M: usize, const NY: usize> ControlLoop<L, R, C, T, K, N, M, NY>
where
    L: JointLaw<N, M, NY>,
    R: Trajectory<N, NY>,
    C: Controller<N, M, NY>,
    T: Transport<N, M, NY>,
    K: Clock,
{
    /// Reads the position, checks that the robot may start there, writes the inputs that hold the robot, and
    /// releases the brakes. [`run`](Self::run) calls this method. Call it only if you run the periods
    /// yourself.
    ///
    /// # Errors
    /// [`Refusal`] with the reason why the loop does not start. The loop then commands the brakes.
    pub fn start(&mut self) -> Result<(), Refusal> {
        let started = self.try_start();
        if let Err(refusal) = started {
            self.brake();
            self.state.phase = Phase::Ended(End::Refused(refusal));
        }
        started
    }

    fn try_start(&mut self) -> Result<(), Refusal> {
        let positions = self.first_reading()?;
        let measured = Unwrapped::at(positions, &self.fallback);
        let dependent = |joint: &DependentJoint<N>, y: &[f64; N], v: &[f64; N]| {
            self.fallback.dependent_motion_at_time(-self.release_time(), joint, y, v)
        };
        check_positions(&self.settings, &self.joints, &measured.coordinates, &dependent)
            .map_err(Refusal::Limit)?;
        let start = Unwrapped::at(self.trajectory.sample(0.0).positions, &self.fallback);
        let way = self.fallback.difference(&start.positions, &positions);
        // For a joint with a quaternion, the report shows the distance from the start.
        let told = start.moved_to(&positions, &self.fallback).coordinates;
        for joint in 0..N {
            let distance = way[joint].abs();
            // This form rejects a trajectory with NaN.
            let near = distance <= self.settings.start_tolerance[joint];
            if !near {
                return Err(Refusal::Start {
                    joint,
                    name: self.joints[joint],
                    position: told[joint],
                    start: start.coordinates[joint],
                });
            }
        }
        let inputs = self.holding_inputs(&positions)?;
        self.controller.reset(&positions, &inputs);
        self.state.inputs = inputs;
        self.first_warm_up(&positions);
        self.transport.write(&inputs).map_err(Refusal::Transport)?;
        self.state.brakes = Brakes::Unknown;
        self.transport.release().map_err(Refusal::Transport)?;
        let time = -self.release_time();
        let (settings, state) = (&self.settings, &mut self.state);
        state.guard = EncoderGuard::new(settings.guard, measured.coordinates, start.coordinates)
            .with_names(self.joints);
        state.filter = VelocityFilter::new(settings.velocity_time_constant, measured.coordinates);
        (state.believed, state.desired) = (measured, start);
        state.reference = Reference::Running { time };
        (state.unmeasured, state.failures, state.unwritten) = (0, 0, 0);
        (state.origin, state.index) = (self.clock.now().saturating_add(self.period), 0);
        state.phase = Phase::Running;
        Ok(())
    }

    /// Engages the brakes and reads until a reading is finite.
    fn first_reading(&mut self) -> Result<[f64; NY], Refusal> {
        let mut refusal = Refusal::NoMeasurement;
        for _ in 0..=self.settings.start_periods {
            if self.stop.is_raised() {
                return Err(Refusal::Requested);
            }
            // The loop also waits after errors. For example, a robot that was just switched on reports its restart here.
            refusal = match self.transport.brake().and_then(|()| self.transport.read()) {
                Ok(Some(reading)) => match self.judge_first(&reading) {
                    Ok(()) => return Ok(reading.positions),
                    Err(fault @ EncoderFault::Attitude(_)) => return Err(Refusal::Encoder(fault)),
                    Err(fault) => Refusal::Encoder(fault),
                },
                Ok(None) => {
                    self.state.counts.missing += 1;
                    Refusal::NoMeasurement
                }
                Err(error) => {
                    self.state.counts.transport_errors += 1;
                    Refusal::Transport(error)
                }
            };
            let next = self.clock.now().saturating_add(self.period);
            self.clock.sleep_until(next);
        }
        Err(refusal)
    }

    fn judge_first(&mut self, reading: &Reading<N, NY>) -> Result<(), EncoderFault> {
        self.state.brakes = reading.brakes;
        self.state.measures = [reading.velocities.is_some(), reading.torques.is_some()];
        let mut plain = plain_entries(self.fallback.quaternion_joints(), N);
        if let Some((joint, _)) = plain.find(|(_, position)| !reading.positions[*position].is_finite()) {
            self.state.counts.not_finite += 1;
            return Err(EncoderFault::NotFinite { joint, name: self.joints[joint] });
        }
        self.fallback.check_attitudes(&reading.positions).map_err(EncoderFault::Attitude)
    }

    fn holding_inputs(&self, positions: &[f64; NY]) -> Result<[f64; M], Refusal> {
        let rest = Sample::at_rest(*positions);
        let inputs = self.fallback.inputs_at_time(-self.release_time(), &rest, positions, &[0.0; N]);
        let inputs = inputs.unwrap_or([f64::NAN; M]);
        for (input, (needed, [low, high])) in inputs.iter().zip(self.settings.input_limits).enumerate() {
            let possible = *needed >= low && *needed <= high;
            if !possible {
                let limit = if *needed < low { low } else { high };
                return Err(Refusal::Torque { input, name: self.inputs[input], needed: *needed, limit });
            }
        }
        Ok(inputs)
    }
}
