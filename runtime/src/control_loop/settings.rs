//! Settings of the loop.

use super::guard::GuardSettings;
use super::stage::{STAGES, Stage};
use crate::dynamics::{DependentJoint, Dynamics, Limits, Named, QuaternionJoint, TorqueSpeedLine};
use crate::input_limits;
#[cfg(not(feature = "std"))]
use crate::no_std::*;
use core::fmt;
use core::time::Duration;

/// Ratio of the speed at which the loop brakes to the speed limit of the description. Predictive controllers use
/// the speed limit itself as a soft limit, and may exceed it slightly.
pub const SPEED_MARGIN: f64 = 1.1;

/// Allowed rates of the loop (Hz).
pub const RATES: core::ops::RangeInclusive<f64> = 50.0..=1000.0;

/// Settings of a [`ControlLoop`](super::ControlLoop). Begin with [`for_robot`](Self::for_robot), and change the
/// settings that differ.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopSettings<const N: usize, const M: usize> {
    /// Rate of the loop, 50 to 1000 Hz.
    pub rate: f64,
    /// Largest number of consecutive periods without a plausible measurement, and of consecutive missed deadlines.
    /// In these periods the robot holds its inputs or follows the controller's prediction. After one more period
    /// without a plausible measurement, or one more missed deadline, the loop engages the brakes.
    pub hold_periods: u32,
    /// Number of consecutive periods in which the loop uses the plan of the last successful step if the controller
    /// fails.
    pub plan_periods: u32,
    /// Number of consecutive periods without a successful controller step after which the loop makes a controlled
    /// stop. In these periods the loop uses the plan or the fallback law.
    pub fallback_periods: u32,
    /// Lower and upper limit of the position of each coordinate [rad or m].
    pub position_limits: [[f64; 2]; N],
    /// Speeds at which the loop brakes [rad/s or m/s].
    pub speed_limit: [f64; N],
    /// Joints that follow other joints. The loop also checks the limits of these joints. Their speed limits are
    /// multiplied by [`SPEED_MARGIN`].
    pub dependent_joints: &'static [DependentJoint<N>],
    /// Deceleration that the brakes guarantee [rad/s² or m/s²]. The loop brakes as soon as the braking distance
    /// would end outside `position_limits`. If the deceleration is infinite, the braking distance is 0.
    pub braking_deceleration: [f64; N],
    /// Largest distance from the desired position [rad or m]. The loop brakes beyond this distance, for example if
    /// a drive has the wrong sign.
    pub following_error: [f64; N],
    /// Largest distance from the start of the trajectory at which the loop starts [rad or m].
    pub start_tolerance: [f64; N],
    /// Lowest and highest value of each input [N m, N or A], with 0 between the two values. The loop clamps all
    /// inputs to this range.
    pub input_limits: [[f64; 2]; M],
    /// Torque–speed lines of motors, which limit the torque at high speed. The loop clamps inputs beyond a line,
    /// because the motor cannot produce them. The speed is the estimate of the controller, or of the loop if the
    /// controller has no estimator.
    pub torque_speed: &'static [TorqueSpeedLine<N>],
    /// Tolerances of the encoder guard.
    pub guard: GuardSettings<N>,
    /// Time constant of the velocity estimate from positions (s), for speed check, fallback law and log. The
    /// setting has no effect if the robot measures velocities.
    pub velocity_time_constant: f64,
    /// Speed below which a coordinate counts as at rest [rad/s or m/s].
    pub standstill_speed: [f64; N],
    /// Duration of a controlled stop of the trajectory, 0 to 60 s.
    pub stop_time: f64,
    /// Time between the end of the trajectory and the brake command, 0 to 60 s. If the robot is not at rest
    /// after this time, the loop waits for at most `stop_time` longer.
    pub settling_time: f64,
    /// Time that the brakes need to release, 0 to 60 s. During this time the inputs hold the start position.
    pub release_time: f64,
    /// Number of periods without a valid reading after which the loop refuses to start.
    pub start_periods: u32,
    /// Largest number of periods in which the loop repeats the brake command while the brakes are not engaged.
    pub brake_periods: u32,
    /// Time before each period (s), at most half a period, in which controller and fallback law compute a step to
    /// warm up the processor caches. 0 disables warm-ups. Without a warm-up, each step after the sleep waits for
    /// memory. The first warm-up is made before the brakes are released. A warm-up that takes longer than this
    /// time disables all later warm-ups. Warm-ups cost one more step and one more wake-up of the thread in each
    /// period.
    ///
    /// Warm-ups were measured at 50 Hz (`benches/warm_up.rs`). They make a step of joint PD or computed torque for
    /// six joints 2 times as fast, and an LTV-MPC step 1.2 to 1.7 times as fast. They do not help an NMPC step,
    /// which takes much longer.
    pub warm_up: f64,
    /// Time budget of each stage, indexed by [`Stage`](super::Stage). The loop only counts exceeded budgets. It
    /// reacts to missed deadlines.
    pub budgets: [Duration; STAGES],
}

impl<const N: usize, const M: usize> LoopSettings<N, M> {
    /// Settings for a loop with this rate (Hz) and the limits of `model`: inputs up to the peak of motor and
    /// joint ([`Dynamics::input_limits`]), positions up to their limits, and speeds up to 1.1 times
    /// ([`SPEED_MARGIN`]) their limits. The limits of joints that follow others are included.
    ///
    /// The other values are, with the speed limit v and the period T:
    ///
    /// | setting | value |
    /// |---|---|
    /// | `hold_periods`, `plan_periods`, `fallback_periods` | 3, 5, 25 |
    /// | `following_error`, `start_tolerance` | 0.1, 0.05 rad (or m) |
    /// | `braking_deceleration` | v/0.2 s |
    /// | `guard.jump_speed`, `guard.jump_margin` | 2 v, 0.001 rad (or m) |
    /// | `guard.frozen_motion` | 0.02 rad (or m) |
    /// | `guard.velocity_mismatch` | 0.1 v |
    /// | `velocity_time_constant`, `standstill_speed` | 0.01 s, 0.01 rad/s (or m/s) |
    /// | `stop_time`, `settling_time`, `release_time` | 0.5 s, 0.1 s, 0 s |
    /// | `start_periods`, `brake_periods` | 50, 10 |
    /// | `warm_up` | 0.1 T |
    /// | `budgets` | 0.25 T for reading, 0.5 T for control, 0.05 T for each other stage |
    ///
    /// Change these values for prismatic joints, and for joints without speed limits.
    #[must_use]
    pub fn for_robot<const NY: usize>(rate: f64, model: &impl Dynamics<N, M, NY>) -> Self {
        Self::within(rate, &model.limits(), model.input_limits().peak)
    }

    pub(super) fn within(rate: f64, limits: &Limits<N, M>, input_limits: [[f64; 2]; M]) -> Self {
        let fastest = limits.narrowed().velocity;
        // `ControlLoop::new` rejects a rate out of range, not this function.
        let period = 1.0 / if RATES.contains(&rate) { rate } else { *RATES.start() };
        let share = |part: f64| Duration::from_secs_f64(part * period);
        let mut budgets = [share(0.05); STAGES];
        budgets[Stage::Read as usize] = share(0.25);
        budgets[Stage::Control as usize] = share(0.5);
        Self {
            rate,
            hold_periods: 3,
            plan_periods: 5,
            fallback_periods: 25,
            position_limits: limits.position,
            speed_limit: limits.velocity.map(|v| SPEED_MARGIN * v),
            dependent_joints: limits.dependent,
            braking_deceleration: fastest.map(|v| v / 0.2),
            following_error: [0.1; N],
            start_tolerance: [0.05; N],
            input_limits,
            torque_speed: limits.torque_speed,
            guard: GuardSettings {
                jump_speed: fastest.map(|v| 2.0 * v),
                jump_margin: [1e-3; N],
                frozen_motion: [0.02; N],
                velocity_mismatch: fastest.map(|v| 0.1 * v),
            },
            velocity_time_constant: 0.01,
            standstill_speed: [0.01; N],
            stop_time: 0.5,
            settling_time: 0.1,
            release_time: 0.0,
            start_periods: 50,
            brake_periods: 10,
            warm_up: 0.1 * period,
            budgets,
        }
    }

    /// Length of a period, rounded to nanoseconds.
    #[must_use]
    pub fn period(&self) -> Duration {
        Duration::from_nanos((1e9 / self.rate).round() as u64)
    }

    /// Checks that the settings contain no position limits for joints with quaternions.
    ///
    /// - `joints`: the joints with quaternions
    ///
    /// # Errors
    /// [`SettingError`] for the first limit of such a position.
    pub(super) fn check_quaternions(&self, joints: &[QuaternionJoint]) -> Result<(), SettingError> {
        for joint in joints {
            let entries = joint.velocity..joint.angular_velocity() + 3;
            for value in self.position_limits[entries].as_flattened() {
                if value.is_finite() {
                    let range = "infinite for a joint whose position is a quaternion";
                    return Err(SettingError {
                        name: "position_limits",
                        of: Some(joint.name),
                        value: *value,
                        range,
                    });
                }
            }
        }
        Ok(())
    }

    /// Checks that each setting is in its range.
    ///
    /// - `joints`, `inputs`: names for messages
    ///
    /// # Errors
    /// [`SettingError`] for the first setting out of range.
    pub(super) fn check(
        &self,
        joints: &[&'static str; N],
        inputs: &[&'static str; M],
    ) -> Result<(), SettingError> {
        require("rate", self.rate, "50 to 1000 Hz", |x| RATES.contains(&x))?;
        let intervals = self.position_limits.map(|[low, high]| high - low);
        require_each("position_limits (upper minus lower)", joints, &intervals, "positive", |x| x > 0.0)?;
        let positive = [
            ("speed_limit", &self.speed_limit),
            ("braking_deceleration", &self.braking_deceleration),
            ("following_error", &self.following_error),
            ("start_tolerance", &self.start_tolerance),
            ("guard.jump_speed", &self.guard.jump_speed),
            ("guard.frozen_motion", &self.guard.frozen_motion),
            ("guard.velocity_mismatch", &self.guard.velocity_mismatch),
            ("standstill_speed", &self.standstill_speed),
        ];
        for (name, values) in positive {
            require_each(name, joints, values, "positive", |x| x > 0.0)?;
        }
        for (name, values, range, holds) in input_limits::requirements(&self.input_limits) {
            require_each(name, inputs, &values, range, holds)?;
        }
        require_each("guard.jump_margin", joints, &self.guard.jump_margin, "not negative", |x| x >= 0.0)?;
        let times = [
            ("velocity_time_constant", self.velocity_time_constant),
            ("stop_time", self.stop_time),
            ("settling_time", self.settling_time),
            ("release_time", self.release_time),
        ];
        for (name, value) in times {
            require(name, value, "0 to 60 s", |x| (0.0..=60.0).contains(&x))?;
        }
        let half = 0.5 / self.rate;
        require("warm_up", self.warm_up, "0 to half a period (s)", |x| (0.0..=half).contains(&x))
    }
}

/// A setting out of range.
#[derive(Debug, Clone, PartialEq)]
pub struct SettingError {
    /// Name of the setting.
    pub name: &'static str,
    /// Name of the joint or input; `None` for settings of the whole loop.
    pub of: Option<&'static str>,
    /// Value that is out of range.
    pub value: f64,
    /// Allowed range of the setting, as text.
    pub range: &'static str,
}

impl fmt::Display for SettingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "setting {}", self.name)?;
        if let Some(of) = self.of {
            write!(f, "[{}]", Named(of))?;
        }
        write!(f, " of the loop is {}, but must be {}", self.value, self.range)
    }
}

impl core::error::Error for SettingError {}

pub(super) fn require(
    name: &'static str,
    value: f64,
    range: &'static str,
    holds: impl Fn(f64) -> bool,
) -> Result<(), SettingError> {
    if holds(value) {
        return Ok(());
    }
    Err(SettingError { name, of: None, value, range })
}

/// Checks one value for each name in `names`, like [`require`].
pub(super) fn require_each<const L: usize>(
    name: &'static str,
    names: &[&'static str; L],
    values: &[f64; L],
    range: &'static str,
    holds: impl Fn(f64) -> bool,
) -> Result<(), SettingError> {
    match values.iter().position(|x| !holds(*x)) {
        None => Ok(()),
        Some(index) => Err(SettingError { name, of: Some(names[index]), value: values[index], range }),
    }
}
