//! Polynomials of degree five, given by position, velocity and acceleration at both ends.

use super::{Sample, Trajectory, TrajectoryError, require_finite, require_positive, require_representable};
use crate::dynamics::Limits;
#[cfg(not(feature = "std"))]
use crate::no_std::*;

/// Position, velocity and acceleration of one coordinate.
pub(super) type End = [f64; 3];

/// Polynomial of degree five for one coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Quintic {
    /// Coefficients of 1, t, …, t⁵.
    coefficients: [f64; 6],
}

impl Quintic {
    /// The polynomial from `start` at t = 0 to `end` at t = `duration` (Craig, *Introduction to Robotics*,
    /// 2005, section 7.3).
    pub fn new(start: End, end: End, duration: f64) -> Self {
        let [p, v, a] = start;
        let t = duration;
        // Difference between the end values and the quadratic Taylor polynomial of the start.
        let dp = end[0] - (p + v * t + 0.5 * a * t * t);
        let dv = (end[1] - (v + a * t)) * t;
        let da = (end[2] - a) * t * t;
        let c3 = (10.0 * dp - 4.0 * dv + 0.5 * da) / (t * t * t);
        let c4 = (-15.0 * dp + 7.0 * dv - da) / (t * t * t * t);
        let c5 = (6.0 * dp - 3.0 * dv + 0.5 * da) / (t * t * t * t * t);
        Self { coefficients: [p, v, 0.5 * a, c3, c4, c5] }
    }

    /// The polynomial with these coefficients of 1, t, t², t³.
    pub fn cubic([c0, c1, c2, c3]: [f64; 4]) -> Self {
        Self { coefficients: [c0, c1, c2, c3, 0.0, 0.0] }
    }

    /// Sum of this polynomial and `factor` times `other`.
    pub fn plus(&self, factor: f64, other: &Self) -> Self {
        let sum = |k: usize| self.coefficients[k] + factor * other.coefficients[k];
        Self { coefficients: core::array::from_fn(sum) }
    }

    /// Smallest and largest position, velocity and acceleration between 0 and `duration`, up to rounding. Between two roots of
    /// its derivative, a polynomial is monotonic and has at most one root. Bisection finds this root.
    pub fn extremes(&self, duration: f64) -> [[f64; 2]; 3] {
        let c = &self.coefficients;
        let snap = |t: f64| 24.0 * c[4] + 120.0 * c[5] * t;
        let mut turns = Turns::new(duration);
        turns.add_roots(snap);
        turns.add_roots(|t| self.jerk(t));
        let accelerations = turns.range(|t| self.at(t)[2]);
        turns.add_roots(|t| self.at(t)[2]);
        let velocities = turns.range(|t| self.at(t)[1]);
        turns.add_roots(|t| self.at(t)[1]);
        [turns.range(|t| self.at(t)[0]), velocities, accelerations]
    }

    /// Position, velocity and acceleration at `t`.
    pub fn at(&self, t: f64) -> End {
        let c = &self.coefficients;
        let p = c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * (c[4] + t * c[5]))));
        let v = c[1] + t * (2.0 * c[2] + t * (3.0 * c[3] + t * (4.0 * c[4] + t * 5.0 * c[5])));
        let a = 2.0 * c[2] + t * (6.0 * c[3] + t * (12.0 * c[4] + t * 20.0 * c[5]));
        [p, v, a]
    }

    /// Upper bounds of the magnitudes of position, velocity and acceleration until `duration`. They are sums of the magnitudes
    /// of all terms, and infinite on overflow.
    pub fn bounds(&self, duration: f64) -> End {
        let absolute = Self { coefficients: self.coefficients.map(f64::abs) };
        absolute.at(duration)
    }

    /// Third derivative at `t`.
    pub fn jerk(&self, t: f64) -> f64 {
        let c = &self.coefficients;
        6.0 * c[3] + t * (24.0 * c[4] + t * 60.0 * c[5])
    }
}

/// Times between which a polynomial of degree five and its derivatives are monotonic, in increasing order. They are the two
/// ends and at most 1 + 2 + 3 + 4 roots.
struct Turns {
    times: [f64; 12],
    count: usize,
}

/// Number of bisections of an interval. The result is then accurate to the last bit.
const HALVINGS: usize = 64;

impl Turns {
    fn new(duration: f64) -> Self {
        let mut times = [0.0; 12];
        times[1] = duration;
        Self { times, count: 2 }
    }

    /// Adds the roots of a function that is monotonic between the present times.
    fn add_roots(&mut self, f: impl Fn(f64) -> f64) {
        let mut all = [0.0; 12];
        let mut count = 0;
        let mut add = |t: f64| {
            if let Some(place) = all.get_mut(count) {
                *place = t;
                count += 1;
            }
        };
        for pair in self.times[..self.count].windows(2) {
            add(pair[0]);
            if f(pair[0]) * f(pair[1]) < 0.0 {
                add(root(&f, pair[0], pair[1]));
            }
        }
        add(self.times[self.count - 1]);
        (self.times, self.count) = (all, count);
    }

    fn range(&self, f: impl Fn(f64) -> f64) -> [f64; 2] {
        let values = self.times[..self.count].iter().map(|t| f(*t));
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    }
}

/// Position between `low` and `high` at which a function changes its sign.
fn root(f: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let (mut low, mut high) = (low, high);
    let sign = f(low);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if f(middle) * sign > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Straight motion in joint space from rest at y_0 to rest at y_1 in the time T. All coordinates have the same profile s:
///
/// ```text
///     y(t) = y_0 + (y_1 − y_0) s(t/T)        s(x) = 10 x³ − 15 x⁴ + 6 x⁵
/// ```
///
/// Velocities and accelerations are zero at both ends. The largest speed is 15/8 |y_1 − y_0|/T in the middle of the motion.
/// The largest acceleration is 10/√3 |y_1 − y_0|/T². The motion has minimum jerk (Flash, Hogan, *The coordination of arm
/// movements*, J. Neurosci. 5, 1985).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RestToRest<const N: usize> {
    start: [f64; N],
    end: [f64; N],
    duration: f64,
}

/// Largest derivative s'(x) of the profile s(x) of a motion from rest to rest, for x from 0 to 1.
const PEAK_SPEED: f64 = 15.0 / 8.0;
/// Largest second derivative s''(x) of the profile s(x) of a motion from rest to rest, for x from 0 to 1.
const PEAK_ACCELERATION: f64 = 5.773_502_691_896_258; // 10/√3

impl<const N: usize> RestToRest<N> {
    /// Motion from `start` to `end` [rad or m] in `duration` (s).
    ///
    /// # Errors
    /// - [`TrajectoryError::NotFinite`] for an entry that is not finite.
    /// - [`TrajectoryError::NotPositive`] for a duration that is not positive.
    /// - [`TrajectoryError::OutOfRange`] if the duration is so short that accelerations overflow.
    pub fn new(start: [f64; N], end: [f64; N], duration: f64) -> Result<Self, TrajectoryError> {
        require_finite("start", &start)?;
        require_finite("end", &end)?;
        require_positive("duration", duration)?;
        let peaks = |i: usize| {
            let way = end[i] - start[i];
            [way / duration, way / (duration * duration)].map(|x| 60.0 * x)
        };
        let peaks: [[f64; 2]; N] = core::array::from_fn(peaks);
        require_representable("speed or acceleration", peaks.as_flattened())?;
        Ok(Self { start, end, duration })
    }

    /// Fastest motion within the limits `speeds` [rad/s or m/s] and `accelerations` [rad/s² or m/s²]. The duration is at
    /// least `shortest` (s). An infinite limit has no effect.
    ///
    /// # Errors
    /// The errors of [`RestToRest::new`]. [`TrajectoryError::NotPositive`] for a limit that is not positive.
    pub fn within(
        start: [f64; N],
        end: [f64; N],
        speeds: &[f64; N],
        accelerations: &[f64; N],
        shortest: f64,
    ) -> Result<Self, TrajectoryError> {
        if shortest.is_nan() {
            return Err(TrajectoryError::NotFinite { what: "shortest duration".into(), value: shortest });
        }
        let mut duration = shortest;
        for i in 0..N {
            for (what, limit) in [("speed", speeds[i]), ("acceleration", accelerations[i])] {
                if limit.is_nan() || limit <= 0.0 {
                    return Err(TrajectoryError::NotPositive {
                        what: format!("{what} limit of joint {}", i + 1),
                        value: limit,
                    });
                }
            }
            let way = (end[i] - start[i]).abs();
            duration = duration
                .max(PEAK_SPEED * way / speeds[i])
                .max((PEAK_ACCELERATION * way / accelerations[i]).sqrt());
        }
        Self::new(start, end, duration)
    }

    /// Fastest motion within `share` (0 to 1) times the speed limits of a model, and within `accelerations` [rad/s² or
    /// m/s²]. The speed limits of joints that follow coordinates are included. Position limits are not checked; check
    /// them by [`violations`](crate::limits::violations).
    ///
    /// # Errors
    /// The errors of [`RestToRest::within`].
    pub fn within_limits<const M: usize>(
        start: [f64; N],
        end: [f64; N],
        limits: &Limits<N, M>,
        share: f64,
        accelerations: &[f64; N],
    ) -> Result<Self, TrajectoryError> {
        let way = core::array::from_fn(|i| end[i] - start[i]);
        // All coordinates have one profile, so joints that follow several coordinates have this profile too. A motion
        // between equal points also needs a positive duration.
        let duration = limits.dependent.iter().fold(1e-3_f64, |duration, joint| {
            let [_, way] = joint.motion(&[0.0; N], &way, &[]);
            // The distance is NaN for a joint that follows a driven joint. `max` ignores NaN.
            duration.max(PEAK_SPEED * way.abs() / (share * joint.velocity))
        });
        let speeds = limits.velocity.map(|v| v * share);
        Self::within(start, end, &speeds, accelerations, duration)
    }
}

impl<const N: usize> Trajectory<N> for RestToRest<N> {
    fn duration(&self) -> f64 {
        self.duration
    }

    fn sample(&self, t: f64) -> Sample<N> {
        let x = t / self.duration;
        if x >= 1.0 {
            return Sample::at_rest(self.end);
        }
        if x.is_nan() || x <= 0.0 {
            return Sample::at_rest(self.start);
        }
        let s = x * x * x * (10.0 + x * (-15.0 + x * 6.0));
        let ds = 30.0 * x * x * (1.0 - x) * (1.0 - x) / self.duration;
        let dds = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (self.duration * self.duration);
        let way: [f64; N] = core::array::from_fn(|i| self.end[i] - self.start[i]);
        Sample {
            positions: core::array::from_fn(|i| self.start[i] + way[i] * s),
            velocities: way.map(|w| w * ds),
            accelerations: way.map(|w| w * dds),
        }
    }
}
