//! Options and errors of a plant.

use crate::dynamics::{AttitudeError, Named, QuaternionJoint, TorqueSpeedLine, plain_entries};
use crate::input_limits;
use thiserror::Error;

/// Errors of the inputs and measurements of a [`Plant`](super::Plant), brakes, and accuracy of the integration. By
/// default encoders and inputs are exact, inputs are unlimited and not delayed, and nothing is lost.
#[derive(Debug, Clone, PartialEq)]
pub struct PlantOptions<const N: usize, const M: usize> {
    /// Resolutions of the encoders at the joints [rad or m]. Measured positions are rounded to multiples of the
    /// resolution. 0 means exact, and is required for joints with a quaternion.
    pub encoder_resolution: [f64; N],
    /// Standard deviations of the normally distributed noise of the positions before rounding [rad or m]. Joints with
    /// a quaternion have one entry for each velocity. Their noise is a small rotation or translation.
    pub encoder_noise: [f64; N],
    /// Standard deviations of the normally distributed noise of measured velocities [rad/s or m/s]; `None` if
    /// velocities are not measured.
    pub velocity_noise: Option<[f64; N]>,
    /// Standard deviations of the normally distributed noise of measured drive forces at the joints [N m or N]; `None`
    /// if forces are not measured.
    pub torque_noise: Option<[f64; N]>,
    /// Resolutions of the inputs [N m, N or A]. Applied inputs are rounded to multiples of the resolution. 0 means
    /// exact.
    pub input_resolution: [f64; M],
    /// Lowest and highest value of each input [N m, N or A]. Inputs are clamped to this range, which must
    /// contain 0. Infinite values mean no limit.
    pub input_limits: [[f64; 2]; M],
    /// Torque–speed lines of motors, usually `model.limits().torque_speed`. Inputs are clamped to these lines and to
    /// `input_limits`, for the speed at the start of the period. The list may be empty.
    pub torque_speed: &'static [TorqueSpeedLine<N>],
    /// Standard deviations of the normally distributed noise of the inputs [N m, N or A]. The noise is constant during
    /// a period and is added before the inputs are clamped.
    pub input_noise: [f64; M],
    /// Number of periods until an input has an effect, 0 to 1000; see [`Plant::apply`](super::Plant::apply).
    pub delay: usize,
    /// Probability that an input is lost, 0 to 1. The previous input then acts for one more period.
    pub input_loss: f64,
    /// Probability that a measurement is lost, 0 to 1. [`Plant::measure`](super::Plant::measure) then returns
    /// the previous measurement.
    pub measurement_loss: f64,
    /// Friction torque of each engaged brake [N m or N]; 0 for joints without a brake. With an infinite torque the
    /// joint stops immediately. `None` selects these defaults:
    ///
    /// - Joints with a drive have a brake with twice the peak effort of the model (infinite without a peak effort).
    /// - Other joints have no brake, also if inputs at frames (for example cylinders) move them. Set a brake if the
    ///   valves of the real robot hold the joint.
    pub brake_torque: Option<[f64; N]>,
    /// Relative error tolerance of an integration step, 1e-14 to 1e-2.
    pub relative_tolerance: f64,
    /// Absolute error tolerance of an integration step, 1e-14 to 1e-2 [rad, m, rad/s or m/s].
    pub absolute_tolerance: f64,
    /// Seed of all random numbers. The same seed and the same inputs give the same motion.
    pub seed: u64,
}

impl<const N: usize, const M: usize> Default for PlantOptions<N, M> {
    fn default() -> Self {
        Self {
            encoder_resolution: [0.0; N],
            encoder_noise: [0.0; N],
            velocity_noise: None,
            torque_noise: None,
            input_resolution: [0.0; M],
            input_limits: [[f64::NEG_INFINITY, f64::INFINITY]; M],
            torque_speed: &[],
            input_noise: [0.0; M],
            delay: 0,
            input_loss: 0.0,
            measurement_loss: 0.0,
            brake_torque: None,
            relative_tolerance: 1e-10,
            absolute_tolerance: 1e-10,
            seed: 0,
        }
    }
}

/// Largest delay of the inputs, in periods.
const MAX_DELAY: usize = 1000;

impl<const N: usize, const M: usize> PlantOptions<N, M> {
    /// Checks the range of all options.
    ///
    /// - `joints`, `inputs`: names for messages
    ///
    /// # Errors
    /// [`PlantError::Option`] for the first value out of range.
    pub(super) fn check(
        &self,
        joints: &[&'static str; N],
        inputs: &[&'static str; M],
    ) -> Result<(), PlantError> {
        const SIZE: &str = "finite and not negative";
        let size = |x: f64| x.is_finite() && x >= 0.0;
        let sensors = [
            ("encoder_resolution", Some(&self.encoder_resolution)),
            ("encoder_noise", Some(&self.encoder_noise)),
            ("velocity_noise", self.velocity_noise.as_ref()),
            ("torque_noise", self.torque_noise.as_ref()),
        ];
        for (option, values) in sensors {
            let values = values.map_or(&[][..], |v| v);
            require(option, joints, values, SIZE, size)?;
        }
        let drives = [("input_resolution", &self.input_resolution), ("input_noise", &self.input_noise)];
        for (option, values) in drives {
            require(option, inputs, values, SIZE, size)?;
        }
        for (option, values, range, holds) in input_limits::requirements(&self.input_limits) {
            require(option, inputs, &values, range, holds)?;
        }
        let brakes = self.brake_torque.as_ref().map_or(&[][..], |b| b);
        require("brake_torque", joints, brakes, "not negative", |x| x >= 0.0)?;
        let losses = [("input_loss", self.input_loss), ("measurement_loss", self.measurement_loss)];
        for (option, value) in losses {
            require(option, &[], &[value], "a probability, 0 to 1", |x| (0.0..=1.0).contains(&x))?;
        }
        let tolerances = [
            ("relative_tolerance", self.relative_tolerance),
            ("absolute_tolerance", self.absolute_tolerance),
        ];
        for (option, value) in tolerances {
            require(option, &[], &[value], "1e-14 to 1e-2", |x| (1e-14..=1e-2).contains(&x))?;
        }
        let delay = self.delay as f64;
        require("delay", &[], &[delay], "at most 1000 periods", |x| x <= MAX_DELAY as f64)
    }
}

impl<const N: usize, const M: usize> PlantOptions<N, M> {
    /// Checks that joints with quaternions have neither encoder resolutions nor brakes.
    ///
    /// - `quaternions`: the joints with quaternions
    ///
    /// # Errors
    /// [`PlantError::Option`] for an encoder resolution or a brake of such a joint.
    pub(super) fn check_quaternions(
        &self,
        joints: &[&'static str; N],
        quaternions: &[QuaternionJoint],
    ) -> Result<(), PlantError> {
        let plain: Vec<usize> = plain_entries(quaternions, N).map(|(velocity, _)| velocity).collect();
        let of_quaternions = |values: &[f64; N]| -> [f64; N] {
            core::array::from_fn(|i| if plain.contains(&i) { 0.0 } else { values[i] })
        };
        let zero = |x: f64| x == 0.0;
        let range = "0 for joints with a quaternion";
        require("encoder_resolution", joints, &of_quaternions(&self.encoder_resolution), range, zero)?;
        let brakes = self.brake_torque.as_ref().map(of_quaternions);
        require("brake_torque", joints, brakes.as_ref().map_or(&[][..], |b| b), range, zero)
    }
}

/// Checks a value or an array. `names` are the names of the joints or inputs of an array, and empty for a
/// single value.
fn require(
    option: &'static str,
    names: &[&'static str],
    values: &[f64],
    range: &'static str,
    holds: impl Fn(f64) -> bool,
) -> Result<(), PlantError> {
    match values.iter().position(|x| !holds(*x)) {
        None => Ok(()),
        Some(index) => {
            Err(PlantError::Option { option, of: names.get(index).copied(), value: values[index], range })
        }
    }
}

/// Error of a plant. If a call returns an error, the state of the plant is unchanged.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PlantError {
    /// An option is out of range.
    #[error("plant option {option}{} is {value}, but must be {range}", bracketed(*.of))]
    Option {
        /// Name of the option.
        option: &'static str,
        /// Name of the joint or input; `None` for options of the whole plant.
        of: Option<&'static str>,
        /// Value of the option that is out of range.
        value: f64,
        /// Allowed range of the option, as text.
        range: &'static str,
    },
    /// A start position or velocity is NaN or infinite.
    #[error(
        "joint {} cannot start at position {position} with velocity {velocity}: both must be finite", Named(.name)
    )]
    Start {
        /// Index of the coordinate.
        coordinate: usize,
        /// Name of the joint.
        name: &'static str,
        /// Start position [rad or m].
        position: f64,
        /// Start velocity [rad/s or m/s].
        velocity: f64,
    },
    /// A start position of a robot with quaternions is NaN or infinite.
    #[error("position {} cannot start at {value}: it must be finite", Named(.name))]
    StartEntry {
        /// Name of the position entry.
        name: &'static str,
        /// Value of the position entry.
        value: f64,
    },
    /// A quaternion of the start position is not an attitude.
    #[error("the plant cannot start: {0}")]
    Attitude(#[from] AttitudeError),
    /// Dry friction acts on several joints together, for example on the shaft of a motor that moves two joints. The
    /// plant cannot determine the holding force at rest of such friction.
    #[error(
        "the plant cannot simulate sticking of joints {} and {} together. A motor that moves both joints, or a joint that follows \
         both, has friction with a jump at rest. Generate the model of the plant with smooth friction: `--smooth-sign 100`",
        Named(.first),
        Named(.second)
    )]
    SharedFriction {
        /// Name of the first joint.
        first: &'static str,
        /// Name of the second joint.
        second: &'static str,
    },
    /// An input is NaN or infinite.
    #[error("input {} is {value}, but inputs must be finite", Named(.name))]
    Input {
        /// Index of the input.
        input: usize,
        /// Name of the input.
        name: &'static str,
        /// Value of the input.
        value: f64,
    },
    /// A period is not positive and finite.
    #[error("the period is {0} s, but must be positive and finite")]
    Period(f64),
    /// The integration failed, because accelerations are not finite, or too many or too small steps would be needed.
    #[error("the integration stopped at {time} s: {reason}")]
    Integration {
        /// Time of the plant (s).
        time: f64,
        /// Reason why the integration stopped.
        reason: &'static str,
    },
}

/// The name of a joint or input in brackets, as an index.
fn bracketed(name: Option<&'static str>) -> String {
    name.map_or_else(String::new, |name| format!("[{}]", Named(name)))
}
