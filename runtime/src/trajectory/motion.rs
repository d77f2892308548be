//! The trait of motions, their samples, limits and errors.

use crate::dynamics::{AttitudeError, DependentJoint, Limits, Named};
#[cfg(not(feature = "std"))]
use crate::no_std::*;
use thiserror::Error;

/// A desired state with its accelerations; of a robot with quaternions with NY position entries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<const N: usize, const NY: usize = N> {
    /// y [rad or m].
    pub positions: [f64; NY],
    /// ẏ [rad/s or m/s], or v where they are not the same.
    pub velocities: [f64; N],
    /// ÿ [rad/s² or m/s²], or v̇.
    pub accelerations: [f64; N],
}

impl<const N: usize, const NY: usize> Sample<N, NY> {
    /// At rest at `positions`.
    #[must_use]
    pub fn at_rest(positions: [f64; NY]) -> Self {
        Self { positions, velocities: [0.0; N], accelerations: [0.0; N] }
    }

    /// True if no number is NaN or infinite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let mut all = self.positions.iter().chain(&self.velocities).chain(&self.accelerations);
        all.all(|x| x.is_finite())
    }
}

/// The limits that a motion must keep, by coordinate. The default has no limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionLimits<const N: usize> {
    /// Lowest and highest position [rad or m].
    pub positions: [[f64; 2]; N],
    /// Largest speed [rad/s or m/s].
    pub speeds: [f64; N],
    /// Largest acceleration [rad/s² or m/s²].
    pub accelerations: [f64; N],
    /// Largest jerk [rad/s³ or m/s³]. [`ViaPoints`](super::ViaPoints) has none.
    pub jerks: [f64; N],
    /// Joints that follow several coordinates and have limits of position or speed. [`ViaPoints`](super::ViaPoints) keeps them. Those that
    /// follow one coordinate count by its limits, and those that follow driven joints are not known here.
    pub dependent: &'static [DependentJoint<N>],
    /// Share (0 to 1) of the speeds of these joints.
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
    /// A model's limits of positions, a share (0 to 1) of its speeds, and accelerations: few models have `ACCELERATION_LIMITS`.
    /// Limits of joints that follow one coordinate narrow its own, and those of joints that follow several are
    /// taken over. Whether joints that follow driven ones keep theirs says [`violations`](crate::limits::violations).
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

    /// - `point`: its index, for messages
    ///
    /// # Errors
    /// A position that is not finite or outside its limits.
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

    /// # Errors
    /// [`TrajectoryError::NotPositive`] for limits that are not positive, or of positions whose upper one is
    /// not above the lower.
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
        require_positive("share of the speeds of dependent joints", self.dependent_share)
    }
}

/// A motion from time 0 to [`duration`](Self::duration).
///
/// Of a robot with quaternions (NY ≠ N) velocities are v, and accelerations are v̇: positions move by
/// `ẏ = T(y) v`. [`GeodesicMotion`](super::GeodesicMotion) makes such motions.
pub trait Trajectory<const N: usize, const NY: usize = N> {
    /// Its length (s).
    fn duration(&self) -> f64;

    /// Desired state at `t` (s). Before the start and after the end the robot rests at the first or last
    /// position; a time that is NaN counts as before the start.
    fn sample(&self, t: f64) -> Sample<N, NY>;

    /// The loop begins a period at `time` (s): what is earlier will not be asked for again. A motion that
    /// changes while it runs takes its changes over here, and nowhere else, so that a period sees one motion.
    /// The default does nothing.
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

/// Why there is no such trajectory.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TrajectoryError {
    /// A number is NaN or infinite.
    #[error("{what} is {value}; it must be finite")]
    NotFinite {
        /// Which number.
        what: String,
        /// Its value.
        value: f64,
    },
    /// A duration, speed or other number that must be positive is not.
    #[error("{what} is {value}; it must be positive")]
    NotPositive {
        /// Which number.
        what: String,
        /// Its value.
        value: f64,
    },
    /// Not enough points or samples.
    #[error("{given} {what} given; at least {needed} are needed")]
    TooFew {
        /// The kind of entries that are too few: points or samples.
        what: &'static str,
        /// How many are needed.
        needed: usize,
        /// How many there are.
        given: usize,
    },
    /// A number lies outside its range.
    #[error("{what} is {value}; it must be {range}")]
    OutOfRange {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The range that is allowed.
        range: &'static str,
    },
    /// A point is outside the position limits.
    #[error(
        "point {} has joint {} at {position}, outside its limits {} to {}",
        .point + 1, .joint + 1, .limits[0], .limits[1]
    )]
    PointOutside {
        /// Index of the point; messages count from 1.
        point: usize,
        /// Index of the joint; messages count from 1.
        joint: usize,
        /// Its position [rad or m].
        position: f64,
        /// Limits [rad or m].
        limits: [f64; 2],
    },
    /// At a point, a joint that follows several coordinates is outside its position limits.
    #[error(
        "point {} has joint {}, which follows several coordinates, at {position}, outside its limits {} to {}",
        .point + 1, Named(.joint), .limits[0], .limits[1]
    )]
    DependentOutside {
        /// Name of the joint.
        joint: &'static str,
        /// Index of the point; messages count from 1.
        point: usize,
        /// Position of the joint [rad or m].
        position: f64,
        /// Limits [rad or m].
        limits: [f64; 2],
    },
    /// Between two points, a joint that follows several coordinates leaves its position limits.
    #[error(
        "joint {}, which follows several coordinates, would reach {position} between points {} and {}, outside its limits \
         {} to {}: put a point between that leads its coordinates inside",
        Named(.joint), .point + 1, .point + 2, .limits[0], .limits[1]
    )]
    DependentOvershoot {
        /// Name of the joint.
        joint: &'static str,
        /// Index of the point before; messages count from 1.
        point: usize,
        /// Farthest position of the joint [rad or m].
        position: f64,
        /// Limits [rad or m].
        limits: [f64; 2],
    },
    /// A joint that follows several coordinates has limits, which a motion cannot keep that knows limits of coordinates alone.
    #[error(
        "joint {} follows several coordinates, and a target that changes keeps limits of single ones alone: narrow these, so \
         that it stays within its own, and leave it out of `MotionLimits::dependent`; or move by `ViaPoints`",
        Named(.joint)
    )]
    DependentNotKept {
        /// Name of the joint.
        joint: &'static str,
    },
    /// Two points in a row are the same: a motion that does not stop cannot pass both.
    #[error(
        "points {} and {} are the same: leave one out, or stop there with a sequence of points", .point, .point + 1
    )]
    RepeatedPoint {
        /// Index of the second one; messages count from 1.
        point: usize,
    },
    /// A quaternion of a point is not an attitude.
    #[error("point {}: {error}", .point + 1)]
    Attitude {
        /// Index of the point; messages count from 1.
        point: usize,
        /// Its joint, and its fault.
        error: AttitudeError,
    },
    /// Between two points a joint turns by half a turn, which has no shortest way.
    #[error(
        "joint {} turns by {angle} rad between points {} and {}: from half a turn on it is not clear which way is the \
         shortest; put a point between", Named(.joint), .point, .point + 1
    )]
    HalfTurn {
        /// Name of the joint.
        joint: &'static str,
        /// Index of the second point; messages count from 1.
        point: usize,
        /// The angle (rad).
        angle: f64,
    },
    /// Nothing limits how fast a joint moves.
    #[error("joint {} moves, but neither its speed nor its acceleration has a limit", .joint + 1)]
    Unlimited {
        /// Index of the joint; messages count from 1.
        joint: usize,
    },
    /// A file cannot be read.
    #[error("{place}: {message}")]
    File {
        /// File, and row where known.
        place: String,
        /// The fault that was found.
        message: String,
    },
}

/// A motion whose speeds or accelerations overflow.
pub(super) fn require_representable(what: &'static str, values: &[f64]) -> Result<(), TrajectoryError> {
    match values.iter().find(|x| !x.is_finite()) {
        None => Ok(()),
        Some(value) => Err(TrajectoryError::OutOfRange {
            what,
            value: *value,
            range: "a number: such a way in such a time has none",
        }),
    }
}

/// The periods of a motion, if they are not too many.
pub(super) fn require_periods(duration: f64, period: f64) -> Result<usize, TrajectoryError> {
    whole_periods(duration, period).ok_or(TrajectoryError::OutOfRange {
        what: "duration in periods",
        value: duration / period,
        range: "at most 10 000 000",
    })
}

/// Most samples that a trajectory is asked for at once: more are a mistake in a duration or a period, and
/// would fill the memory.
pub const MAX_SAMPLES: usize = 10_000_000;

/// Periods until a motion of this duration is over; None for more than [`MAX_SAMPLES`], and for durations
/// that are not numbers.
pub(crate) fn whole_periods(duration: f64, period: f64) -> Option<usize> {
    let periods = (duration / period).ceil();
    // Written so that NaN is refused.
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
