//! Plausibility check of measurements.

use crate::dynamics::{AttitudeError, Named, numbered};
use thiserror::Error;

/// A fault of a measured position.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum EncoderFault {
    /// The position is NaN or infinite.
    #[error("the measured position of joint {} is not finite: check its encoder", Named(.name))]
    NotFinite {
        /// Index of the coordinate.
        joint: usize,
        /// Name of the joint.
        name: &'static str,
    },
    /// The quaternion of a joint is not an attitude.
    #[error("the measurement is invalid: {0}")]
    Attitude(AttitudeError),
    /// The position is further from the last accepted position than the joint can have moved.
    #[error(
        "the measured position of joint {} jumped by {distance:.4} rad (or m), but `guard.jump_speed` and \
         `guard.jump_margin` allow {possible:.4} in this time. Check its encoder",
        Named(.name)
    )]
    Jump {
        /// Index of the coordinate.
        joint: usize,
        /// Name of the joint.
        name: &'static str,
        /// Distance from the last accepted position [rad or m].
        distance: f64,
        /// Largest distance that would have been accepted [rad or m].
        possible: f64,
    },
    /// The measured position remained constant while the desired position moved. Either the joint sticks, or the
    /// encoder fails.
    #[error(
        "the measured position of joint {} did not change during {desired:.4} rad (or m) of desired motion, above the limit \
         `guard.frozen_motion`. Check its encoder, its brake, and whether friction or an input without effect holds the joint",
        Named(.name)
    )]
    Frozen {
        /// Index of the coordinate.
        joint: usize,
        /// Name of the joint.
        name: &'static str,
        /// Distance that the desired position has moved while the measured position was constant [rad or m].
        desired: f64,
    },
    /// The measured velocity is not finite, or differs too much from the rate of change of the positions.
    /// Possible reasons are a wrong sign, unit or gear ratio, or a sensor that fails.
    #[error(
        "the measured velocity {measured:.4} rad/s (or m/s) of joint {} differs by {mismatch:.4} from the \
         change of its position, above the limit {possible:.4} of `guard.velocity_mismatch`. Check its sign and unit",
        Named(.name)
    )]
    Velocity {
        /// Index of the coordinate.
        joint: usize,
        /// Name of the joint.
        name: &'static str,
        /// Measured velocity [rad/s or m/s].
        measured: f64,
        /// Measured velocity minus rate of change of the positions, low-pass filtered with a time constant of
        /// 0.1 s [rad/s or m/s].
        mismatch: f64,
        /// Largest magnitude of the velocity difference that would have been accepted [rad/s or m/s].
        possible: f64,
    },
}

/// Tolerances of [`EncoderGuard`], one for each coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GuardSettings<const N: usize> {
    /// Speed above which a change of position counts as a jump [rad/s or m/s].
    pub jump_speed: [f64; N],
    /// Change of position that is always accepted [rad or m]. The margin must cover noise and a few encoder
    /// steps.
    pub jump_margin: [f64; N],
    /// Distance that the desired position may move while the measured position remains constant [rad or m]. The
    /// distance must cover stiction, backlash and following error.
    pub frozen_motion: [f64; N],
    /// Accepted difference between the measured velocity and the rate of change of the positions [rad/s or m/s].
    /// The difference must cover noise, and the acceleration times the delay of the drive's velocity filter. If
    /// the value is infinite, velocities are not compared.
    pub velocity_mismatch: [f64; N],
}

/// Distance that counts as a jump even if the settings are infinite [rad or m], so that velocities do not
/// overflow.
const NO_DISTANCE: f64 = 1e100;
/// Time constant of the low-pass filter for the difference of measured velocity and rate of change of the
/// positions (s). Without the filter, differences of positions are too noisy.
const MISMATCH_TIME: f64 = 0.1;

/// Plausibility check that compares each measurement with earlier measurements and with the desired motion.
///
/// The guard cannot distinguish a sticking joint from a frozen encoder. The loop stops in both cases.
#[derive(Debug, Clone)]
pub struct EncoderGuard<const N: usize> {
    settings: GuardSettings<N>,
    names: [&'static str; N],
    believed: [f64; N],
    /// Velocities measured with the last accepted positions; `None` if velocities are not measured.
    velocities: Option<[f64; N]>,
    /// Time since the last accepted positions were measured (s).
    age: f64,
    last_reading: [f64; N],
    /// Desired position at the last change of the reading.
    desired_at_change: [f64; N],
    /// Measured velocity minus rate of change of the positions, low-pass filtered.
    mismatch: [f64; N],
}

impl<const N: usize> EncoderGuard<N> {
    /// A guard whose last accepted positions are `positions`. `desired` are the desired positions at the same time
    /// [rad or m]. Messages number the joints from 1 unless [`with_names`](Self::with_names) sets their names.
    #[must_use]
    pub fn new(settings: GuardSettings<N>, positions: [f64; N], desired: [f64; N]) -> Self {
        Self {
            settings,
            names: numbered(),
            believed: positions,
            velocities: None,
            age: 0.0,
            last_reading: positions,
            desired_at_change: desired,
            mismatch: [0.0; N],
        }
    }

    /// Sets the names of the joints for messages.
    #[must_use]
    pub fn with_names(mut self, names: [&'static str; N]) -> Self {
        self.names = names;
        self
    }

    /// Advances the time by `span` seconds. Negative values and NaN count as 0.
    pub fn elapse(&mut self, span: f64) {
        self.age += span.max(0.0);
    }

    /// Last accepted positions [rad or m] and their age (s).
    #[must_use]
    pub fn believed(&self) -> ([f64; N], f64) {
        (self.believed, self.age)
    }

    /// Checks measured positions [rad or m] against earlier ones and against the desired positions at the same
    /// time. `velocities` are the measured velocities [rad/s or m/s]; `None` if velocities are not measured.
    ///
    /// # Errors
    /// [`EncoderFault`] for the first fault. The measurement is then not accepted.
    pub fn check(
        &mut self,
        reading: &[f64; N],
        velocities: Option<&[f64; N]>,
        desired: &[f64; N],
    ) -> Result<(), EncoderFault> {
        for i in 0..N {
            // NaN differs from itself and so counts as a change. This is correct: NaN does not show a frozen encoder.
            if reading[i] != self.last_reading[i] {
                self.last_reading[i] = reading[i];
                self.desired_at_change[i] = desired[i];
            }
        }
        for i in 0..N {
            self.check_joint(i, reading[i], desired[i])?;
        }
        if let Some(velocities) = velocities {
            self.compare(reading, velocities);
            for i in 0..N {
                self.check_velocity(i, velocities[i])?;
            }
        }
        self.velocities = velocities.copied();
        self.believed = *reading;
        self.age = 0.0;
        Ok(())
    }

    fn check_joint(&self, joint: usize, reading: f64, desired: f64) -> Result<(), EncoderFault> {
        let name = self.names[joint];
        if !reading.is_finite() {
            return Err(EncoderFault::NotFinite { joint, name });
        }
        let settings = &self.settings;
        let distance = (reading - self.believed[joint]).abs();
        let margin = settings.jump_margin[joint];
        let possible = settings.jump_speed[joint] * self.age + margin;
        // NaN counts as a jump. If the age is 0 and the speed is unlimited, `possible` is 0 · ∞ = NaN.
        let near = distance <= possible || (self.age == 0.0 && distance <= margin);
        if !(near && distance < NO_DISTANCE) {
            return Err(EncoderFault::Jump { joint, name, distance, possible });
        }
        let moved = (desired - self.desired_at_change[joint]).abs();
        if moved > settings.frozen_motion[joint] {
            return Err(EncoderFault::Frozen { joint, name, desired: moved });
        }
        Ok(())
    }

    /// Updates the filtered difference between the mean measured velocity (trapezoidal rule) and the mean rate of
    /// change of the positions since the last accepted reading.
    fn compare(&mut self, reading: &[f64; N], velocities: &[f64; N]) {
        let Some(before) = self.velocities.filter(|_| self.age > 0.0) else {
            return;
        };
        let weight = self.age / (self.age + MISMATCH_TIME);
        for i in 0..N {
            let slope = (reading[i] - self.believed[i]) / self.age;
            let difference = 0.5 * (before[i] + velocities[i]) - slope;
            let change = weight * (difference - self.mismatch[i]);
            // NaN of a sensor is reported immediately. It must not enter the filter state.
            if change.is_finite() {
                self.mismatch[i] += change;
            }
        }
    }

    fn check_velocity(&self, joint: usize, measured: f64) -> Result<(), EncoderFault> {
        let (mismatch, possible) = (self.mismatch[joint], self.settings.velocity_mismatch[joint]);
        if measured.is_finite() && mismatch.abs() <= possible {
            return Ok(());
        }
        Err(EncoderFault::Velocity { joint, name: self.names[joint], measured, mismatch, possible })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: GuardSettings<2> = GuardSettings {
        jump_speed: [2.0; 2],
        jump_margin: [0.001; 2],
        frozen_motion: [0.05; 2],
        velocity_mismatch: [0.2; 2],
    };

    fn guard() -> EncoderGuard<2> {
        let mut guard = EncoderGuard::new(SETTINGS, [1.0, 0.0], [1.0, 0.0]);
        guard.elapse(0.02);
        guard
    }

    #[test]
    fn what_a_joint_can_do_is_believed() {
        let mut guard = guard();
        assert_eq!(guard.check(&[1.04, -0.04], None, &[1.04, -0.04]), Ok(()));
        assert_eq!(guard.believed(), ([1.04, -0.04], 0.0));
    }

    #[test]
    fn nan_and_infinity_are_not() {
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(
                guard().check(&[1.0, x], None, &[1.0, 0.0]),
                Err(EncoderFault::NotFinite { joint: 1, name: "2" })
            );
        }
    }

    #[test]
    fn a_jump_is_not_and_the_last_believed_position_stays() {
        let mut guard = guard();
        let fault = guard.check(&[1.0, 0.05], None, &[1.0, 0.0]).unwrap_err();
        assert!(matches!(fault, EncoderFault::Jump { joint: 1, .. }));
        assert_eq!(guard.believed(), ([1.0, 0.0], 0.02));
        // After a longer time without a reading, the same distance is possible.
        guard.elapse(0.02);
        assert_eq!(guard.check(&[1.0, 0.05], None, &[1.0, 0.0]), Ok(()));
    }

    #[test]
    fn a_reading_that_stays_while_motion_is_desired_is_frozen() {
        let mut guard = guard();
        assert_eq!(guard.check(&[1.0, 0.01], None, &[1.04, 0.01]), Ok(()));
        let fault = guard.check(&[1.0, 0.02], None, &[1.06, 0.02]).unwrap_err();
        assert!(matches!(fault, EncoderFault::Frozen { joint: 0, .. }));
        assert!(fault.to_string().contains("holds the joint"));
        // The desired motion is counted from the last change of the reading.
        guard.elapse(0.02);
        assert_eq!(guard.check(&[1.001, 0.03], None, &[1.07, 0.03]), Ok(()));
    }

    #[test]
    fn at_rest_a_reading_may_stay_forever() {
        let mut guard = guard();
        for _ in 0..1000 {
            guard.elapse(0.02);
            assert_eq!(guard.check(&[1.0, 0.0], None, &[1.0, 0.0]), Ok(()));
        }
    }

    /// Number of periods until a fault if joint 0 moves at 1 rad/s and the measured velocity is `factor` times 1 rad/s.
    fn periods_believed(factor: f64, period: f64, noise: f64) -> Option<u32> {
        let mut guard = EncoderGuard::new(SETTINGS, [0.0; 2], [0.0; 2]);
        (1..=(2.0 / period) as u32).find(|k| {
            let time = f64::from(*k) * period;
            let y = time + if k % 2 == 0 { noise } else { -noise };
            guard.elapse(period);
            let fault = guard.check(&[y, 0.0], Some(&[factor, 0.0]), &[y, 0.0]);
            if let Err(fault) = fault {
                assert!(matches!(fault, EncoderFault::Velocity { joint: 0, .. }));
            }
            fault.is_err()
        })
    }

    #[test]
    fn velocities_of_another_sign_or_unit_are_not_believed() {
        for period in [0.02, 0.001] {
            // Encoder noise of 0.1 mrad causes differences of 0.2 rad/s at 1 kHz.
            assert_eq!(periods_believed(1.0, period, 1e-4), None);
            assert_eq!(periods_believed(1.15, period, 1e-4), None);
            // Wrong sign, speed of the motor instead of the joint, degrees, and a dead sensor.
            for factor in [-1.0, 161.0, 57.3, 0.0] {
                let periods = periods_believed(factor, period, 1e-4).unwrap();
                assert!(f64::from(periods) * period < 0.1, "{factor}: {periods}");
            }
        }
    }

    #[test]
    fn velocities_that_are_no_numbers_are_not_believed() {
        let mut guard = guard();
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let fault = guard.check(&[1.0, 0.0], Some(&[0.0, bad]), &[1.0, 0.0]).unwrap_err();
            assert!(matches!(fault, EncoderFault::Velocity { joint: 1, .. }));
        }
        let good = guard.check(&[1.0, 0.0], Some(&[0.0, 0.0]), &[1.0, 0.0]);
        assert_eq!(good, Ok(()));
    }

    /// The loop would reject these settings. A direct caller of the guard can use NaN, which counts as no tolerance.
    #[test]
    fn no_numbers_among_settings_and_times_let_nothing_through() {
        let settings = GuardSettings { jump_speed: [f64::INFINITY; 2], ..SETTINGS };
        let mut guard = EncoderGuard::new(settings, [1.0, 0.0], [1.0, 0.0]);
        guard.elapse(f64::NAN);
        guard.elapse(-1.0);
        assert_eq!(guard.believed().1, 0.0);
        assert!(guard.check(&[1.01, 0.0], None, &[1.0, 0.0]).is_err());
        assert_eq!(guard.check(&[1.0, 0.0], None, &[1.0, 0.0]), Ok(()));
        let settings = GuardSettings { jump_speed: [f64::NAN; 2], ..SETTINGS };
        let mut guard = EncoderGuard::new(settings, [1.0, 0.0], [1.0, 0.0]);
        guard.elapse(0.02);
        assert!(guard.check(&[1.0, 0.0], None, &[1.0, 0.0]).is_err());
    }
}
