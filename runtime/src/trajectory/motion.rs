//! Trait for motions, and samples, limits and errors of motions.

use crate::dynamics::{AttitudeError, DependentJoint, Limits, Named};
#[cfg(not(feature = "std"))]
use crate::no_std::*;
use thiserror::Error;

/// A desired state with accelerations. For a robot with quaternions it has NY position entries, and N entries of
/// velocities and accelerations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<const N: usize, const NY: usize = N> {
    /// Positions y [rad or m].
    pub positions: [f64; NY],
    /// Velocities ẏ [rad/s or m/s]; body velocities v for joints with quaternions.
    pub velocities: [f64; N],
    /// Accelerations ÿ [rad/s² or m/s²]; derivatives v̇ of the body velocities for joints with quaternions.
    pub accelerations: [f64; N],
}

impl<const N: usize, const NY: usize> Sample<N, NY> {
    /// A sample at rest at `positions`.
    #[must_use]
    pub fn at_rest(positions: [f64; NY]) -> Self {
        Self { positions, velocities: [0.0; N], accelerations: [0.0; N] }
    }

    /// Whether all entries are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let mut all = self.positions.iter().chain(&self.velocities).chain(&self.accelerations);
        all.all(|x| x.is_finite())
    }
}

/// Limits of the coordinates of a motion. By default all limits are infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionLimits<const N: usize> {
    /// Lowest and highest positions [rad or m].
    pub positions: [[f64; 2]; N],
    /// Largest speeds [rad/s or m/s].
    pub speeds: [f64; N],
    /// Largest accelerations [rad/s² or m/s²].
    pub accelerations: [f64; N],
    /// Largest jerks [rad/s³ or m/s³]. [`ViaPoints`](super::ViaPoints) ignores these limits.
    pub jerks: [f64; N],
    /// Followers, which are joints that follow several coordinates, with limits of position or speed.
    /// [`ViaPoints`](super::ViaPoints) keeps these limits. Joints that follow one coordinate are not listed, because their
    /// limits are part of the limits of this coordinate. Joints that follow driven joints are not listed either.
    pub dependent: &'static [DependentJoint<N>],
    /// Usable share (0 to 1) of the speed limits of the followers.
    pub dependent_share: f64,
}

impl<const N: usize> Default for MotionLimits<N> {
    fn default() -> Self {
        Self {
            positions: [[f64::NEG_INFINITY, f64::INFINITY]; N],
            speeds: [f64::INFINITY; N],
            accelerations: [f64::INFINITY; N],
            jerks: [f64::INFINITY; N],
            dependent: &[],
            dependent_share: 1.0,
        }
    }
}

impl<const N: usize> MotionLimits<N> {
    /// Limits for a motion of a model: its position limits, its speed limits times `share` (0 to 1), and the given
    /// `accelerations` [rad/s² or m/s²], because few descriptions have acceleration limits. If a joint follows one
    /// coordinate, its limits narrow the limits of this coordinate. Joints that follow several coordinates become
    /// followers. The limits of joints that follow driven joints are not included; check them by
    /// [`violations`](crate::limits::violations).
    #[must_use]
    pub fn of<const M: usize>(limits: &Limits<N, M>, share: f64, accelerations: [f64; N]) -> Self {
        let Limits { position, velocity, .. } = limits.narrowed();
        Self {
            positions: position,
            speeds: velocity.map(|v| v * share),
            accelerations,
            dependent: limits.dependent,
            dependent_share: share,
            ..Self::default()
        }
    }

    /// Checks the positions of a point.
    ///
    /// - `point`: index of the point, for messages
    ///
    /// # Errors
    /// [`TrajectoryError::NotFinite`] for a position that is not finite. [`TrajectoryError::PointOutside`] for a position
    /// outside its limits.
    pub(super) fn check_position(&self, point: usize, positions: &[f64; N]) -> Result<(), TrajectoryError> {
        for joint in 0..N {
            let limits @ [low, high] = self.positions[joint];
            let position = positions[joint];
            if !position.is_finite() {
                return Err(TrajectoryError::NotFinite {
                    what: format!("point {}, joint {},", point + 1, joint + 1),
                    value: position,
                });
            }
            if !(low..=high).contains(&position) {
                return Err(TrajectoryError::PointOutside { point, joint, position, limits });
            }
        }
        Ok(())
    }

    /// Checks that the limits are positive, and that upper position limits are above lower position limits.
    ///
    /// # Errors
    /// [`TrajectoryError::NotPositive`] for the first limit that is not valid.
    pub(super) fn check(&self) -> Result<(), TrajectoryError> {
        let widths = self.positions.map(|[low, high]| high - low);
        let all = [
            ("width of the position limits", &widths),
            ("speed limit", &self.speeds),
            ("acceleration limit", &self.accelerations),
            ("jerk limit", &self.jerks),
        ];
        for (what, values) in all {
            if let Some(i) = values.iter().position(|x| x.is_nan() || *x <= 0.0) {
                return Err(TrajectoryError::NotPositive {
                    what: format!("{what} of joint {}", i + 1),
                    value: values[i],
                });
            }
        }
        require_positive("`dependent_share`", self.dependent_share)
    }
}

/// A motion from time 0 to [`duration`](Self::duration).
///
/// For a robot with quaternions (NY ≠ N) the velocities are body velocities v, and the accelerations are v̇. The positions
/// change by `ẏ = T(y) v`. [`GeodesicMotion`](super::GeodesicMotion) is a motion for these robots.
pub trait Trajectory<const N: usize, const NY: usize = N> {
    /// Duration (s).
    fn duration(&self) -> f64;

    /// Desired state at the time `t` (s). Before the start (also for NaN) the motion is at rest at the first position,
    /// after the end at the last position.
    fn sample(&self, t: f64) -> Sample<N, NY>;

    /// Begins a period of the loop at `time` (s). Later calls of [`sample`](Self::sample) do not request earlier times. A
    /// motion that changes at run time must only change in this method, so that all samples of a period belong to one
    /// motion. The default does nothing.
    fn begin_period(&self, time: f64) {
        let _ = time;
    }
}

macro_rules! as_what_it_points_to {
    ($($pointer:ty),*) => {$(
        impl<const N: usize, const NY: usize, T: Trajectory<N, NY> + ?Sized> Trajectory<N, NY> for $pointer {
            fn duration(&self) -> f64 {
                (**self).duration()
            }

            fn sample(&self, t: f64) -> Sample<N, NY> {
                (**self).sample(t)
            }

            fn begin_period(&self, time: f64) {
                (**self).begin_period(time);
            }
        }
    )*};
}

as_what_it_points_to!(&T, Box<T>);

/// Error of a trajectory.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TrajectoryError {
    /// A number is NaN or infinite.
    #[error("{what} is {value}, but must be finite")]
    NotFinite {
        /// Name of the quantity.
        what: String,
        /// Value of the number that is not allowed.
        value: f64,
    },
    /// A duration, speed or other quantity is not positive.
    #[error("{what} is {value}, but must be positive")]
    NotPositive {
        /// Name of the quantity.
        what: String,
        /// Value of the number that is not allowed.
        value: f64,
    },
    /// Too few points or samples are given, or the lengths of two lists do not match.
    #[error("{given} {what} are given, but {needed} are needed")]
    TooFew {
        /// Kind of the entries, for example points or samples.
        what: &'static str,
        /// Necessary number of entries.
        needed: usize,
        /// Number of entries that were given.
        given: usize,
    },
    /// A number is out of range.
    #[error("{what} is {value}, but must be {range}")]
    OutOfRange {
        /// Name of the quantity.
        what: &'static str,
        /// Value of the number that is not allowed.
        value: f64,
        /// Allowed range of the number, as text.
        range: &'static str,
    },
    /// A point is outside the position limits.
    #[error(
        "point {} has joint {} at {position} rad (or m), outside its limits {} to {}",
        .point + 1, .joint + 1, .limits[0], .limits[1]
    )]
    PointOutside {
        /// Index of the point, from 0. Messages count from 1.
        point: usize,
        /// Index of the joint, from 0. Messages count from 1.
        joint: usize,
        /// Position of the joint [rad or m].
        position: f64,
        /// Position limits of the joint [rad or m].
        limits: [f64; 2],
    },
    /// At a point, a joint that follows several coordinates is outside its position limits.
    #[error(
        "point {} has joint {}, which follows several coordinates, at {position} rad (or m), outside its limits \
         {} to {}",
        .point + 1, Named(.joint), .limits[0], .limits[1]
    )]
    DependentOutside {
        /// Name of the joint.
        joint: &'static str,
        /// Index of the point, from 0. Messages count from 1.
        point: usize,
        /// Position of the joint [rad or m].
        position: f64,
        /// Position limits of the joint [rad or m].
        limits: [f64; 2],
    },
    /// Between two points, a joint that follows several coordinates leaves its position limits.
    #[error(
        "joint {}, which follows several coordinates, would reach {position} rad (or m) between points {} and \
         {}, outside its limits {} to {}. Insert a point between the two points",
        Named(.joint), .point + 1, .point + 2, .limits[0], .limits[1]
    )]
    DependentOvershoot {
        /// Name of the joint.
        joint: &'static str,
        /// Index of the first of the two points, from 0. Messages count from 1.
        point: usize,
        /// Extreme position of the joint [rad or m].
        position: f64,
        /// Position limits of the joint [rad or m].
        limits: [f64; 2],
    },
    /// A joint that follows several coordinates has limits, but the motion only keeps limits of single coordinates.
    #[error(
        "a motion to a changing target cannot keep the limits of joint {}, because it follows several joints. Narrow the limits \
         of these joints and remove it from `MotionLimits::dependent`, or use `ViaPoints`",
        Named(.joint)
    )]
    DependentNotKept {
        /// Name of the joint.
        joint: &'static str,
    },
    /// Two consecutive points are equal. A motion without stops cannot pass both points.
    #[error(
        "points {} and {} are equal. Remove one of them, or use `PointSequence` to stop there", .point, .point + 1
    )]
    RepeatedPoint {
        /// Index of the second point, from 0. Messages count from 1.
        point: usize,
    },
    /// A quaternion of a point is not an attitude.
    #[error("point {}: {error}", .point + 1)]
    Attitude {
        /// Index of the point, from 0. Messages count from 1.
        point: usize,
        /// Joint and fault of the quaternion.
        error: AttitudeError,
    },
    /// Between two points a joint turns by 180°, so the shortest direction is not unique.
    #[error(
        "joint {} turns by {angle} rad between points {} and {}, so the direction of this half turn is ambiguous. Insert a point \
         between the two points", Named(.joint), .point, .point + 1
    )]
    HalfTurn {
        /// Name of the joint.
        joint: &'static str,
        /// Index of the second point, from 0. Messages count from 1.
        point: usize,
        /// Angle of the rotation (rad).
        angle: f64,
    },
    /// Neither speed nor acceleration of a joint is limited.
    #[error("joint {} moves, but neither its speed nor its acceleration is limited. Set one of these limits", .joint + 1)]
    Unlimited {
        /// Index of the joint, from 0. Messages count from 1.
        joint: usize,
    },
    /// A file cannot be read.
    #[error("{place}: {message}")]
    File {
        /// Name of the file, and the row if it is known.
        place: String,
        /// Description of the fault, as text.
        message: String,
    },
}

/// Checks that computed values, for example speeds and accelerations, are finite.
pub(super) fn require_representable(what: &'static str, values: &[f64]) -> Result<(), TrajectoryError> {
    match values.iter().find(|x| !x.is_finite()) {
        None => Ok(()),
        Some(value) => Err(TrajectoryError::OutOfRange {
            what,
            value: *value,
            range: "finite. Choose a longer duration or a shorter distance",
        }),
    }
}

/// Number of periods of a motion, at most [`MAX_SAMPLES`].
pub(super) fn require_periods(duration: f64, period: f64) -> Result<usize, TrajectoryError> {
    whole_periods(duration, period).ok_or(TrajectoryError::OutOfRange {
        what: "duration in periods",
        value: duration / period,
        range: "at most 10 000 000",
    })
}

/// Largest number of samples of a trajectory. A larger number indicates a wrong duration or period, and would
/// fill the memory.
pub const MAX_SAMPLES: usize = 10_000_000;

/// Number of periods in a motion of this duration; `None` for more than [`MAX_SAMPLES`] and for NaN
/// durations.
pub(crate) fn whole_periods(duration: f64, period: f64) -> Option<usize> {
    let periods = (duration / period).ceil();
    // This form rejects NaN.
    (periods <= MAX_SAMPLES as f64).then_some(periods.max(0.0) as usize)
}

pub(super) fn require_finite(what: &str, values: &[f64]) -> Result<(), TrajectoryError> {
    match values.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(i) => {
            Err(TrajectoryError::NotFinite { what: format!("{what} of joint {}", i + 1), value: values[i] })
        }
    }
}

pub(crate) fn require_positive(what: &str, value: f64) -> Result<(), TrajectoryError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    let what = what.to_owned();
    Err(if value.is_finite() {
        TrajectoryError::NotPositive { what, value }
    } else {
        TrajectoryError::NotFinite { what, value }
    })
}
