//! Simulated robot (plant) for tests of controllers. The motion is exact. Inputs and measurements can have errors.
//!
//! ```text
//!     M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u_applied        u_applied constant over a period
//! ```
//!
//! For robots with quaternions, positions are integrated as `ẏ = T(y) v` with the same error control.
//! Quaternions are normalized after every period.
//!
//! The model of the plant can differ from the model of the controller. It can be any [`Dynamics`], for example with
//! other masses or other friction, and with an exact `sign` instead of a smooth function. [`PlantOptions`] lists
//! the errors of inputs and measurements. For driven joints use a [`DrivenRobot`](crate::driven::DrivenRobot) with
//! their motion. Its time is the time of the plant since the last [`reset`](Plant::reset).

mod dry_friction;
mod integrator;
mod options;

pub use options::{PlantError, PlantOptions};

use crate::dynamics::{Dynamics, jumps_with, plain_entries};
use crate::input_limits::limit_torques;
use dry_friction::{Joints, Mode, PushForce};
use integrator::{Integrator, MAX_PERIOD_STEPS, Motion};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::StandardNormal;
use std::collections::VecDeque;
use std::sync::Arc;

/// Largest number of changes between sticking and sliding in one period.
const MAX_EVENTS: usize = 1000;
/// Ratio of the torque of a brake to the peak effort of its joint, if the options give no torque.
const BRAKE_RESERVE: f64 = 2.0;

/// Measured quantities of the plant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement<const N: usize, const NY: usize = N> {
    /// Time of the measurement (s). If the last measurements were lost, this time is earlier than the time of the
    /// plant.
    pub time: f64,
    /// Measured positions [rad or m], with rounding and noise of the encoders. Attitudes are quaternions.
    pub positions: [f64; NY],
    /// Measured velocities [rad/s or m/s]; `None` if [`PlantOptions::velocity_noise`] is `None`.
    pub velocities: Option<[f64; N]>,
    /// Measured drive forces at the joints in the last period [N m or N], which the applied inputs produce;
    /// `None` if [`PlantOptions::torque_noise`] is `None`.
    pub torques: Option<[f64; N]>,
}

/// External generalized forces that act until the time `end` (s).
#[derive(Clone)]
struct Push<const N: usize, const NY: usize> {
    end: f64,
    force: Arc<PushForce<N, NY>>,
}

/// Returns the generalized forces `Jᵀ w` [N m or N] of a wrench w at a frame.
///
/// - `jacobian`: Jacobian J of the frame, with the linear velocities of the origin before the angular velocities
/// - `wrench`: force (three entries, N) and moment about the origin (three entries, N m), in the axes of `jacobian`
#[must_use]
pub fn wrench_forces<const N: usize>(jacobian: &[[f64; N]; 6], wrench: &[f64; 6]) -> [f64; N] {
    core::array::from_fn(|i| jacobian.iter().zip(wrench).map(|(row, w)| row[i] * w).sum())
}

/// A simulated robot. Each call of [`apply`](Self::apply) advances the motion by a period with constant inputs.
///
/// ```
/// use gelenk_runtime::plant::{Plant, PlantOptions};
///
/// gelenk_runtime::dynamics!(pub struct PowerCube = gelenk_generated::powercube);
///
/// let options = PlantOptions { encoder_resolution: [1e-4; 2], delay: 1, ..PlantOptions::default() };
/// let mut plant = Plant::new(PowerCube, options)?;
/// plant.reset([0.1, 0.0], [0.0; 2])?;
/// plant.apply(&[0.0; 2], 0.02)?;
/// assert!(plant.state().0[0] > 0.1, "it falls");
/// # Ok::<(), gelenk_runtime::plant::PlantError>(())
/// ```
#[derive(Clone)]
pub struct Plant<D, const N: usize, const M: usize, const NY: usize = N> {
    model: D,
    options: PlantOptions<N, M>,
    brake_torque: [f64; N],
    brakes_engaged: bool,
    integrator: Integrator<N, NY>,
    /// Time since the last reset (s).
    time: f64,
    motion: Motion<N, NY>,
    measurement: Measurement<N, NY>,
    /// Delayed inputs, oldest first. Between calls the queue has `delay` entries.
    queue: VecDeque<[f64; M]>,
    /// Last input that arrived, before noise, rounding and limits.
    received: [f64; M],
    applied: [f64; M],
    push: Option<Push<N, NY>>,
    encoder_noise: ChaCha8Rng,
    input_noise: ChaCha8Rng,
    losses: ChaCha8Rng,
    velocity_noise: ChaCha8Rng,
    torque_noise: ChaCha8Rng,
}

impl<D: Dynamics<N, M, NY>, const N: usize, const M: usize, const NY: usize> Plant<D, N, M, NY> {
    /// A plant at rest at y = 0 with released brakes. Quaternions are the identity. All memory is allocated here.
    ///
    /// # Errors
    /// - [`PlantError::Option`] for an option out of range.
    /// - [`PlantError::SharedFriction`] if dry friction acts on several joints together.
    pub fn new(model: D, options: PlantOptions<N, M>) -> Result<Self, PlantError> {
        options.check(&model.joint_names(), &model.input_names())?;
        options.check_quaternions(&model.joint_names(), model.quaternion_joints())?;
        let start = model.neutral();
        refuse_shared_friction(&model, 0.0, &start)?;
        let brake_torque = options.brake_torque.unwrap_or_else(|| default_brakes(&model));
        // Each option has a separate stream of random numbers. An option then does not change the noise of others.
        let stream = |number| {
            let mut generator = ChaCha8Rng::seed_from_u64(options.seed);
            generator.set_stream(number);
            generator
        };
        let mut plant = Self {
            model,
            brake_torque,
            brakes_engaged: false,
            integrator: Integrator::new(options.relative_tolerance, options.absolute_tolerance),
            time: 0.0,
            motion: Motion { positions: start, velocities: [0.0; N] },
            measurement: Measurement { time: 0.0, positions: start, velocities: None, torques: None },
            queue: VecDeque::with_capacity(options.delay + 1),
            received: [0.0; M],
            applied: [0.0; M],
            push: None,
            encoder_noise: stream(0),
            input_noise: stream(1),
            losses: stream(2),
            velocity_noise: stream(3),
            torque_noise: stream(4),
            options,
        };
        plant.reset(start, [0.0; N])?;
        Ok(plant)
    }

    /// Restarts at time 0 with these positions [rad or m] and velocities [rad/s or m/s]. The brakes are released,
    /// delayed inputs are zero, and a measurement is made. The sequences of random numbers continue.
    ///
    /// # Errors
    /// - [`PlantError::Start`] or [`PlantError::StartEntry`] for values that are not finite.
    /// - [`PlantError::Attitude`] for a quaternion that is not an attitude.
    pub fn reset(&mut self, mut positions: [f64; NY], velocities: [f64; N]) -> Result<(), PlantError> {
        for (i, position) in plain_entries(self.model.quaternion_joints(), N) {
            if !(positions[position].is_finite() && velocities[i].is_finite()) {
                return Err(PlantError::Start {
                    coordinate: i,
                    name: self.model.joint_names()[i],
                    position: positions[position],
                    velocity: velocities[i],
                });
            }
        }
        self.model.check_attitudes(&positions)?;
        self.require_finite(self.model.position_names(), &positions)?;
        self.require_finite(self.model.joint_names(), &velocities)?;
        // Given quaternions have unit length except for rounding. They are normalized to full precision.
        let _ = self.model.normalize(&mut positions);
        self.motion = Motion { positions, velocities };
        self.time = 0.0;
        self.brakes_engaged = false;
        self.applied = [0.0; M];
        self.push = None;
        self.preload([0.0; M]);
        self.measurement = self.read_encoders();
        Ok(())
    }

    fn require_finite<const L: usize>(
        &self,
        names: [&'static str; L],
        values: &[f64; L],
    ) -> Result<(), PlantError> {
        match values.iter().position(|x| !x.is_finite()) {
            None => Ok(()),
            Some(i) => Err(PlantError::StartEntry { name: names[i], value: values[i] }),
        }
    }

    /// Sets the delayed inputs and the last received input to `inputs`, for a start during a motion.
    pub fn preload(&mut self, inputs: [f64; M]) {
        self.received = inputs;
        self.queue.clear();
        self.queue.extend((0..self.options.delay).map(|_| inputs));
    }

    /// Returns the last measurement that was not lost. Repeated calls in a period return the same measurement.
    #[must_use]
    pub fn measure(&self) -> Measurement<N, NY> {
        self.measurement
    }

    /// Sends `inputs` [N m, N or A] and advances the motion by `period` (s). The inputs sent
    /// [`PlantOptions::delay`] periods ago act during this period. While brakes are engaged, the drives are off.
    ///
    /// # Errors
    /// - [`PlantError::Input`] for an input that is not finite.
    /// - [`PlantError::Period`] for a period that is not positive and finite.
    /// - [`PlantError::Integration`] if the integration fails.
    /// - [`PlantError::SharedFriction`] if dry friction acts on several joints together.
    ///
    /// After the last two errors, positions, velocities and time of the plant are unchanged.
    pub fn apply(&mut self, inputs: &[f64; M], period: f64) -> Result<(), PlantError> {
        if let Some(input) = inputs.iter().position(|u| !u.is_finite()) {
            return Err(PlantError::Input {
                input,
                name: self.model.input_names()[input],
                value: inputs[input],
            });
        }
        require_period(period)?;
        self.queue.push_back(*inputs);
        let arriving = self.queue.pop_front().unwrap_or(*inputs);
        if !chance(&mut self.losses, self.options.input_loss) {
            self.received = arriving;
        }
        self.advance(period)
    }

    /// Advances the motion by `period` (s) without a new input. The last received inputs act, and delayed inputs remain
    /// in the queue.
    ///
    /// # Errors
    /// The errors of [`apply`](Self::apply) except [`PlantError::Input`].
    pub fn hold(&mut self, period: f64) -> Result<(), PlantError> {
        require_period(period)?;
        self.advance(period)
    }

    /// Engages the brakes and switches the drives off.
    pub fn brake(&mut self) {
        self.brakes_engaged = true;
    }

    /// Releases the brakes and switches the drives on.
    pub fn release(&mut self) {
        self.brakes_engaged = false;
    }

    /// Applies an external force during the next periods. `duration` (s) is rounded to whole periods. The force
    /// replaces an earlier external force. Brakes and friction resist the force.
    ///
    /// - `force`: function that returns generalized forces [N m or N] for positions. [`wrench_forces`] converts a force
    ///   at a frame to generalized forces.
    ///
    /// ```
    /// use gelenk_runtime::plant::{Plant, PlantOptions, wrench_forces};
    ///
    /// gelenk_runtime::dynamics!(pub struct Ur5 = gelenk_generated::ur5);
    ///
    /// let mut plant = Plant::new(Ur5, PlantOptions::default())?;
    /// // 20 N sideways at the tool.
    /// plant.push(0.1, |y| {
    ///     let jacobian = gelenk_generated::ur5::frame_tool_jacobian(y);
    ///     wrench_forces(&jacobian, &[0.0, 20.0, 0.0, 0.0, 0.0, 0.0])
    /// });
    /// plant.apply(&[0.0; 6], 0.01)?;
    /// # Ok::<(), gelenk_runtime::plant::PlantError>(())
    /// ```
    pub fn push(&mut self, duration: f64, force: impl Fn(&[f64; NY]) -> [f64; N] + Send + Sync + 'static) {
        self.push = Some(Push { end: self.time + duration, force: Arc::new(force) });
    }

    /// Whether the brakes are engaged.
    #[must_use]
    pub fn is_braked(&self) -> bool {
        self.brakes_engaged
    }

    /// True positions [rad or m] and velocities [rad/s or m/s], without measurement errors.
    #[must_use]
    pub fn state(&self) -> ([f64; NY], [f64; N]) {
        (self.motion.positions, self.motion.velocities)
    }

    /// Time since the last reset (s).
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Inputs that acted in the last period [N m, N or A], after noise, rounding and limits. They are zero
    /// while brakes are engaged.
    #[must_use]
    pub fn applied(&self) -> [f64; M] {
        self.applied
    }

    /// The model of the plant.
    #[must_use]
    pub fn model(&self) -> &D {
        &self.model
    }

    /// Replaces the model of the plant from now on, for example to simulate wear, another load or another
    /// temperature. State and delayed inputs are kept.
    pub fn set_model(&mut self, model: D) {
        self.model = model;
    }

    fn advance(&mut self, period: f64) -> Result<(), PlantError> {
        let applied = self.actuate();
        let motion = self.integrate(&applied, period)?;
        self.applied = applied;
        self.motion = motion;
        self.time += period;
        let measurement = self.read_encoders();
        if !chance(&mut self.losses, self.options.measurement_loss) {
            self.measurement = measurement;
        }
        Ok(())
    }

    fn actuate(&mut self) -> [f64; M] {
        let noise = normals::<M>(&mut self.input_noise);
        if self.brakes_engaged {
            return [0.0; M];
        }
        let mut applied = core::array::from_fn(|i| {
            let noisy = self.received[i] + self.options.input_noise[i] * noise[i];
            let [low, high] = self.options.input_limits[i];
            // The limit is applied last, so that rounding does not exceed the limit.
            quantized(noisy, self.options.input_resolution[i]).clamp(low, high)
        });
        let options = &self.options;
        limit_torques(&mut applied, options.torque_speed, &options.input_limits, &self.motion.velocities);
        applied
    }

    fn read_encoders(&mut self) -> Measurement<N, NY> {
        let noise = normals::<N>(&mut self.encoder_noise);
        let moved = core::array::from_fn(|i| self.options.encoder_noise[i] * noise[i]);
        let mut positions = self.model.integrate(&self.motion.positions, &moved);
        for (i, position) in plain_entries(self.model.quaternion_joints(), N) {
            positions[position] = quantized(positions[position], self.options.encoder_resolution[i]);
        }
        let velocities = self.options.velocity_noise.map(|deviation| {
            let noise = normals::<N>(&mut self.velocity_noise);
            core::array::from_fn(|i| self.motion.velocities[i] + deviation[i] * noise[i])
        });
        let torques = self.options.torque_noise.map(|deviation| {
            let noise = normals::<N>(&mut self.torque_noise);
            let at = &self.motion.positions;
            let gears = self.model.at_time(self.time, |model| model.input_matrix(at));
            core::array::from_fn(|i| {
                let force: f64 = gears[i].iter().zip(&self.applied).map(|(b, u)| b * u).sum();
                force + deviation[i] * noise[i]
            })
        });
        Measurement { time: self.time, positions, velocities, torques }
    }

    fn integrate(&mut self, inputs: &[f64; M], period: f64) -> Result<Motion<N, NY>, PlantError> {
        // Friction can become discontinuous after a change of the model or of the position.
        refuse_shared_friction(&self.model, self.time, &self.motion.positions)?;
        let brakes = if self.brakes_engaged { self.brake_torque } else { [0.0; N] };
        let push = self.push.as_ref().filter(|push| self.time + 0.5 * period < push.end);
        let mut joints = Joints {
            model: &self.model,
            start: self.time,
            inputs,
            brakes: &brakes,
            push: push.map(|push| &*push.force),
            modes: [Mode::Smooth; N],
            rest: self.options.absolute_tolerance,
        };
        let (mut time, mut motion, mut budget) = (0.0, self.motion, MAX_PERIOD_STEPS);
        for _ in 0..MAX_EVENTS {
            joints.settle_at(time, &mut motion);
            let arrival = self
                .integrator
                .advance(&joints, &motion, time, period, &mut budget)
                .map_err(|reason| PlantError::Integration { time: self.time + time, reason })?;
            (time, motion) = (arrival.time, arrival.motion);
            if !arrival.by_event {
                return self.with_attitudes(motion, self.time + time);
            }
        }
        Err(PlantError::Integration {
            time: self.time + time,
            reason: "joints changed between sticking and sliding more than 1000 times",
        })
    }

    /// Normalizes the quaternions, because the integration changes their length within its tolerance.
    fn with_attitudes(&self, mut motion: Motion<N, NY>, time: f64) -> Result<Motion<N, NY>, PlantError> {
        if self.model.normalize(&mut motion.positions) {
            return Ok(motion);
        }
        Err(PlantError::Integration { time, reason: "a quaternion is zero or not finite" })
    }
}

/// Checks that friction with a discontinuity in the velocity of one joint does not act on another joint. The plant can
/// only determine for single joints whether they stick. A discontinuity that is 0 for the present parameters and
/// positions is allowed.
fn refuse_shared_friction<const N: usize, const M: usize, const NY: usize>(
    model: &impl Dynamics<N, M, NY>,
    time: f64,
    positions: &[f64; NY],
) -> Result<(), PlantError> {
    let mut shared = model.friction_jumps().iter().filter(|[i, j]| i != j);
    let jumping = shared.find(|pair| {
        model.at_time(time, |model| jumps_with(**pair, |v| model.friction_torques(positions, v)))
    });
    match jumping {
        None => Ok(()),
        Some(&[i, j]) => {
            let names = model.joint_names();
            Err(PlantError::SharedFriction { first: names[i], second: names[j] })
        }
    }
}

fn default_brakes<const N: usize, const M: usize, const NY: usize>(
    model: &impl Dynamics<N, M, NY>,
) -> [f64; N] {
    let (limits, input_matrix) = (model.limits(), model.drive_matrix());
    core::array::from_fn(|i| {
        if input_matrix[i].iter().all(|b| *b == 0.0) { 0.0 } else { BRAKE_RESERVE * limits.peak_effort[i] }
    })
}

fn require_period(period: f64) -> Result<(), PlantError> {
    if period.is_finite() && period > 0.0 { Ok(()) } else { Err(PlantError::Period(period)) }
}

fn quantized(x: f64, resolution: f64) -> f64 {
    if resolution == 0.0 {
        return x;
    }
    let rounded = (x / resolution).round() * resolution;
    // If the step is far below the last digit of x, the quotient overflows. x is then a multiple of the step.
    if rounded.is_finite() { rounded } else { x }
}

/// Returns true with this probability. A random number is drawn in every call, so that the random sequences do not depend
/// on the options.
fn chance(generator: &mut ChaCha8Rng, probability: f64) -> bool {
    generator.random::<f64>() < probability
}

fn normals<const L: usize>(generator: &mut ChaCha8Rng) -> [f64; L] {
    core::array::from_fn(|_| generator.sample(StandardNormal))
}
