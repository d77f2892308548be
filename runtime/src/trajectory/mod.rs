//! Desired motions: positions, velocities and accelerations over time.
//!
//! Everything here is C²: positions, velocities and accelerations are continuous, and each is the derivative of the one before. Feed-forward and
//! model predictive control rely on it.

mod along;
mod cartesian;
mod limits;
mod points;
mod polynomial;
mod recording;
mod sampled;
mod sine;
mod smoothing;

pub use along::Along;
pub use cartesian::{CartesianError, joint_points, pose_sequence, straight_ways};
pub use limits::{CheckError, Quantity, Rating, Violation, violations};
pub use points::PointSequence;
pub use polynomial::RestToRest;
pub use recording::{Columns, Inconsistency, Recording};
pub use sampled::Sampled;
pub use sine::{IdentificationMotion, IdentificationSine};
pub use smoothing::{Smoothed, Smoothing};

use thiserror::Error;

/// A desired state with its accelerations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<const N: usize> {
    /// y [rad or m].
    pub positions: [f64; N],
    /// ẏ [rad/s or m/s].
    pub velocities: [f64; N],
    /// ÿ [rad/s² or m/s²].
    pub accelerations: [f64; N],
}

impl<const N: usize> Sample<N> {
    /// At rest at `positions`.
    #[must_use]
    pub fn at_rest(positions: [f64; N]) -> Self {
        Self {
            positions,
            velocities: [0.0; N],
            accelerations: [0.0; N],
        }
    }

    /// True if no number is NaN or infinite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let all = [&self.positions, &self.velocities, &self.accelerations];
        all.iter().all(|x| x.iter().all(|x| x.is_finite()))
    }
}

/// A motion from time 0 to [`duration`](Self::duration).
pub trait Trajectory<const N: usize> {
    /// Its length (s).
    fn duration(&self) -> f64;

    /// Desired state at `t` (s). Before the start and after the end the robot rests at the first or last position; a time that is NaN counts
    /// as before the start.
    fn sample(&self, t: f64) -> Sample<N>;
}

impl<const N: usize, T: Trajectory<N> + ?Sized> Trajectory<N> for &T {
    fn duration(&self) -> f64 {
        (**self).duration()
    }

    fn sample(&self, t: f64) -> Sample<N> {
        (**self).sample(t)
    }
}

impl<const N: usize, T: Trajectory<N> + ?Sized> Trajectory<N> for Box<T> {
    fn duration(&self) -> f64 {
        (**self).duration()
    }

    fn sample(&self, t: f64) -> Sample<N> {
        (**self).sample(t)
    }
}

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
        /// What there is too little of.
        what: &'static str,
        /// How many are needed.
        needed: usize,
        /// How many there are.
        given: usize,
    },
    /// A number lies outside what is allowed.
    #[error("{what} is {value}; it must be {range}")]
    OutOfRange {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// A file cannot be read.
    #[error("{place}: {message}")]
    File {
        /// File, and row where known.
        place: String,
        /// What is wrong with it.
        message: String,
    },
}

/// A motion whose speeds or accelerations overflow.
fn require_representable(what: &'static str, values: &[f64]) -> Result<(), TrajectoryError> {
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
fn require_periods(duration: f64, period: f64) -> Result<usize, TrajectoryError> {
    whole_periods(duration, period).ok_or(TrajectoryError::OutOfRange {
        what: "duration in periods",
        value: duration / period,
        range: "at most 10 000 000",
    })
}

/// Most samples that a trajectory is asked for at once: more are a mistake in a duration or a period, and would fill the
/// memory.
pub const MAX_SAMPLES: usize = 10_000_000;

/// Periods until a motion of this duration is over; None for more than [`MAX_SAMPLES`], and for durations that are no number.
pub(crate) fn whole_periods(duration: f64, period: f64) -> Option<usize> {
    let periods = (duration / period).ceil();
    // Written so that NaN is refused.
    (periods <= MAX_SAMPLES as f64).then_some(periods.max(0.0) as usize)
}

fn require_finite(what: &str, values: &[f64]) -> Result<(), TrajectoryError> {
    match values.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(i) => Err(TrajectoryError::NotFinite {
            what: format!("{what} of joint {}", i + 1),
            value: values[i],
        }),
    }
}

fn require_positive(what: &str, value: f64) -> Result<(), TrajectoryError> {
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
