//! Is a measurement believable?

use std::fmt;

/// What is wrong with a measured position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EncoderFault {
    /// NaN or infinite.
    NotFinite {
        /// Index of the coordinate.
        joint: usize,
    },
    /// Further from the last believed position than the joint can have moved.
    Jump {
        /// Index of the coordinate.
        joint: usize,
        /// Distance from the last believed position [rad or m].
        distance: f64,
        /// Distance that would have been believed [rad or m].
        possible: f64,
    },
    /// The reading stayed the same while the desired position moved on.
    Frozen {
        /// Index of the coordinate.
        joint: usize,
        /// Distance that the desired position moved meanwhile [rad or m].
        desired: f64,
    },
}

impl fmt::Display for EncoderFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { joint } => write!(f, "encoder of joint {joint} is not finite"),
            Self::Jump {
                joint,
                distance,
                possible,
            } => write!(
                f,
                "encoder of joint {joint} jumped by {distance:.4}; the joint can move {possible:.4} in that time"
            ),
            Self::Frozen { joint, desired } => write!(
                f,
                "encoder of joint {joint} did not change while {desired:.4} of motion was desired"
            ),
        }
    }
}

/// What the guard tolerates, by coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GuardSettings<const N: usize> {
    /// Speed above which a change of position is a jump [rad/s or m/s].
    pub jump_speed: [f64; N],
    /// Change that is always believed: noise and a few encoder steps [rad or m].
    pub jump_margin: [f64; N],
    /// Desired motion during which a reading may stay the same: stiction, backlash and following error [rad or m].
    pub frozen_motion: [f64; N],
}

/// Judges measurements by the ones before.
///
/// A joint that sticks looks like a frozen encoder, and is as good a reason to stop.
#[derive(Debug, Clone)]
pub struct EncoderGuard<const N: usize> {
    settings: GuardSettings<N>,
    believed: [f64; N],
    /// Time since `believed` was measured (s).
    age: f64,
    last_reading: [f64; N],
    /// Desired position when the reading last changed.
    desired_at_change: [f64; N],
}

impl<const N: usize> EncoderGuard<N> {
    /// Begins with a position that is believed.
    #[must_use]
    pub fn new(settings: GuardSettings<N>, positions: [f64; N], desired: [f64; N]) -> Self {
        Self {
            settings,
            believed: positions,
            age: 0.0,
            last_reading: positions,
            desired_at_change: desired,
        }
    }

    /// Notes that `span` seconds went by.
    pub fn elapse(&mut self, span: f64) {
        self.age += span;
    }

    /// Last position that was believed [rad or m], and its age (s).
    #[must_use]
    pub fn believed(&self) -> ([f64; N], f64) {
        (self.believed, self.age)
    }

    /// Judges one reading, given the position that is desired at the same time.
    ///
    /// # Errors
    /// The first [`EncoderFault`]; the reading then is not taken over.
    pub fn check(&mut self, reading: &[f64; N], desired: &[f64; N]) -> Result<(), EncoderFault> {
        for i in 0..N {
            // NaN differs from itself and so counts as a change, as it should: it is no frozen encoder.
            if reading[i] != self.last_reading[i] {
                self.last_reading[i] = reading[i];
                self.desired_at_change[i] = desired[i];
            }
        }
        for i in 0..N {
            self.check_joint(i, reading[i], desired[i])?;
        }
        self.believed = *reading;
        self.age = 0.0;
        Ok(())
    }

    fn check_joint(&self, joint: usize, reading: f64, desired: f64) -> Result<(), EncoderFault> {
        if !reading.is_finite() {
            return Err(EncoderFault::NotFinite { joint });
        }
        let settings = &self.settings;
        let distance = (reading - self.believed[joint]).abs();
        let possible = settings.jump_speed[joint] * self.age + settings.jump_margin[joint];
        if distance > possible {
            return Err(EncoderFault::Jump {
                joint,
                distance,
                possible,
            });
        }
        let moved = (desired - self.desired_at_change[joint]).abs();
        if moved > settings.frozen_motion[joint] {
            return Err(EncoderFault::Frozen {
                joint,
                desired: moved,
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: GuardSettings<2> = GuardSettings {
        jump_speed: [2.0; 2],
        jump_margin: [0.001; 2],
        frozen_motion: [0.05; 2],
    };

    fn guard() -> EncoderGuard<2> {
        let mut guard = EncoderGuard::new(SETTINGS, [1.0, 0.0], [1.0, 0.0]);
        guard.elapse(0.02);
        guard
    }

    #[test]
    fn what_a_joint_can_do_is_believed() {
        let mut guard = guard();
        assert_eq!(guard.check(&[1.04, -0.04], &[1.04, -0.04]), Ok(()));
        assert_eq!(guard.believed(), ([1.04, -0.04], 0.0));
    }

    #[test]
    fn nan_and_infinity_are_not() {
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(
                guard().check(&[1.0, x], &[1.0, 0.0]),
                Err(EncoderFault::NotFinite { joint: 1 })
            );
        }
    }

    #[test]
    fn a_jump_is_not_and_the_last_believed_position_stays() {
        let mut guard = guard();
        let fault = guard.check(&[1.0, 0.05], &[1.0, 0.0]).unwrap_err();
        assert!(matches!(fault, EncoderFault::Jump { joint: 1, .. }));
        assert_eq!(guard.believed(), ([1.0, 0.0], 0.02));
        // After a longer silence the same distance is possible.
        guard.elapse(0.02);
        assert_eq!(guard.check(&[1.0, 0.05], &[1.0, 0.0]), Ok(()));
    }

    #[test]
    fn a_reading_that_stays_while_motion_is_desired_is_frozen() {
        let mut guard = guard();
        assert_eq!(guard.check(&[1.0, 0.01], &[1.04, 0.01]), Ok(()));
        let fault = guard.check(&[1.0, 0.02], &[1.06, 0.02]).unwrap_err();
        assert!(matches!(fault, EncoderFault::Frozen { joint: 0, .. }));
        assert!(fault.to_string().starts_with("encoder of joint 0 did not"));
        // A new reading counts from where it changed.
        guard.elapse(0.02);
        assert_eq!(guard.check(&[1.001, 0.03], &[1.07, 0.03]), Ok(()));
    }

    #[test]
    fn at_rest_a_reading_may_stay_forever() {
        let mut guard = guard();
        for _ in 0..1000 {
            guard.elapse(0.02);
            assert_eq!(guard.check(&[1.0, 0.0], &[1.0, 0.0]), Ok(()));
        }
    }
}
