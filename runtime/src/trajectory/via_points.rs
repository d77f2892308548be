//! Motion through points without stopping, within limits.

use super::polynomial::Quintic;
use super::spline::{self, Piece};
use super::sums;
use super::{MotionLimits, Sample, Trajectory, TrajectoryError};
#[cfg(not(feature = "std"))]
use crate::no_std::*;

/// A motion in joint space that passes inner points without stopping, and keeps limits of positions, speeds and
/// accelerations. The motion begins and ends at rest. Positions, velocities and accelerations are continuous. The motion is
/// not time-optimal. To stop at each point, use a [`PointSequence`](super::PointSequence).
///
/// Each joint follows a cubic spline. An additional knot in the first and in the last segment makes velocity and
/// acceleration zero at both ends (Lin, Chang, Luo, *Formulation and optimization of cubic polynomial joint trajectories
/// for industrial robots*, IEEE Trans. Automatic Control 28 (1983); Biagiotti, Melchiorri, *Trajectory Planning for
/// Automatic Machines and Robots*, 2008, section 4.4.4).
///
/// Splines overshoot. If the spline of a joint leaves the position limits between two points, this joint uses polynomials of
/// degree five instead. They are monotonic between points and have zero acceleration at the points. The velocity at a point
/// is the weighted harmonic mean of the slopes of both segments (Fritsch, Butland, *SIAM J. Sci. Stat. Comput.* 5 (1984)),
/// but at most 5/4 of either slope. With this limit, the Bézier points of the derivative have one sign, so the polynomials
/// are monotonic.
///
/// A few iterations adjust the durations of the segments to each other. Then one factor scales all durations, so that one
/// limit is reached and no limit is exceeded. Extremes are computed from the roots of the derivatives, not by sampling. The
/// limits of joints that follow several coordinates ([`MotionLimits::dependent`]) are kept too. If splines violate the
/// position limits of such a joint, all its coordinates use the monotonic polynomials.
///
/// ```
/// use gelenk_runtime::trajectory::{MotionLimits, Trajectory, ViaPoints};
///
/// let limits = MotionLimits { speeds: [1.0; 2], accelerations: [3.0; 2], ..MotionLimits::default() };
/// let points = [[0.0, 0.0], [0.5, 0.3], [0.9, -0.1], [1.2, 0.0]];
/// let motion = ViaPoints::within(&points, &limits)?;
/// let second = motion.sample(motion.times()[1]);
/// assert!((second.positions[1] - 0.3).abs() < 1e-12);
/// assert!(second.velocities[0] > 0.1, "it passes");
/// # Ok::<(), gelenk_runtime::trajectory::TrajectoryError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ViaPoints<const N: usize> {
    /// Times at which the polynomials begin (s), and the end time.
    knots: Vec<f64>,
    pieces: Vec<[Quintic; N]>,
    /// Times at which the points are passed (s).
    times: Vec<f64>,
    first: [f64; N],
    last: [f64; N],
}

/// Number of iterations in which the durations of the segments are adjusted to each other.
const ROUNDS: usize = 16;
/// Relative increase of the durations as a margin for rounding errors.
const MARGIN: f64 = 1e-10;

impl<const N: usize> ViaPoints<N> {
    /// Motion through `points` [rad or m] within `limits`.
    ///
    /// # Errors
    /// - [`TrajectoryError::TooFew`] for fewer than two points.
    /// - [`TrajectoryError::RepeatedPoint`] for two equal consecutive points.
    /// - [`TrajectoryError::NotFinite`] or [`TrajectoryError::PointOutside`] for a point that is not finite
    ///   or outside the position limits.
    /// - [`TrajectoryError::DependentOutside`] if a joint that follows several coordinates is outside its limits at a
    ///   point.
    /// - [`TrajectoryError::DependentOvershoot`] if such a joint leaves its limits between two points even with monotonic
    ///   polynomials.
    /// - [`TrajectoryError::NotPositive`] for limits that are not positive.
    /// - [`TrajectoryError::Unlimited`] for a joint that moves without a finite limit of speed or
    ///   acceleration.
    /// - [`TrajectoryError::OutOfRange`] for durations that overflow.
    pub fn within(points: &[[f64; N]], limits: &MotionLimits<N>) -> Result<Self, TrajectoryError> {
        limits.check()?;
        check_points(points, limits)?;
        let mut ways = first_guess(points, limits)?;
        let mut best = f64::INFINITY;
        let mut best_ways = ways.clone();
        for _ in 0..ROUNDS {
            let spans = spline::spans(&ways);
            let pieces = through(points, &ways, &spans, limits)?;
            let ratios = ratios(&pieces, &spans, limits, ways.len());
            let stretch = ratios.iter().copied().fold(0.0, f64::max) * (1.0 + MARGIN);
            let total = stretch * ways.iter().sum::<f64>();
            if total < best {
                best = total;
                best_ways = ways.iter().map(|way| way * stretch).collect();
            }
            // Segments that are far within their limits become shorter, and segments that exceed their limits become longer.
            for (way, ratio) in ways.iter_mut().zip(&ratios) {
                *way *= ratio.max(0.1).sqrt();
            }
        }
        Self::build(points, &best_ways, limits)
    }

    fn build(points: &[[f64; N]], ways: &[f64], limits: &MotionLimits<N>) -> Result<Self, TrajectoryError> {
        let spans = spline::spans(ways);
        let pieces = through(points, ways, &spans, limits)?;
        sums::check(&pieces, &spans, limits, ways.len())?;
        let beyond = ratios(&pieces, &spans, limits, ways.len());
        let kept = beyond.iter().all(|ratio| *ratio <= 1.0 + MARGIN);
        if !kept {
            return Err(TrajectoryError::OutOfRange {
                what: "the ratio of a speed or acceleration to its limit",
                value: beyond.iter().copied().fold(0.0, f64::max),
                range: "at most 1. The distances between the points differ by too many orders of magnitude",
            });
        }
        let passed = |spans: &[f64]| {
            let mut end = 0.0;
            let ends = spans.iter().map(move |span| {
                end += span;
                end
            });
            core::iter::once(0.0).chain(ends).collect::<Vec<f64>>()
        };
        let knots = passed(&spans);
        let mut times = passed(ways);
        // The two end times can differ by rounding, because the orders of the sums differ. They are made equal.
        if let (Some(time), Some(end)) = (times.last_mut(), knots.last()) {
            *time = *end;
        }
        Ok(Self { knots, pieces, times, first: points[0], last: points[points.len() - 1] })
    }

    /// Times at which the points are passed (s), from 0 to the duration.
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.times
    }
}

impl<const N: usize> Trajectory<N> for ViaPoints<N> {
    fn duration(&self) -> f64 {
        self.knots[self.knots.len() - 1]
    }

    fn sample(&self, t: f64) -> Sample<N> {
        if t.is_nan() || t <= 0.0 {
            return Sample::at_rest(self.first);
        }
        if t >= self.duration() {
            return Sample::at_rest(self.last);
        }
        // The index is between 0 and that of the last polynomial.
        let k = self.knots.partition_point(|knot| *knot <= t) - 1;
        let local = t - self.knots[k];
        let states: [[f64; 3]; N] = core::array::from_fn(|i| self.pieces[k][i].at(local));
        Sample {
            positions: states.map(|s| s[0]),
            velocities: states.map(|s| s[1]),
            accelerations: states.map(|s| s[2]),
        }
    }
}

fn check_points<const N: usize>(
    points: &[[f64; N]],
    limits: &MotionLimits<N>,
) -> Result<(), TrajectoryError> {
    if points.len() < 2 {
        return Err(TrajectoryError::TooFew { what: "points", needed: 2, given: points.len() });
    }
    for (k, point) in points.iter().enumerate() {
        limits.check_position(k, point)?;
        if k > 0 && points[k - 1] == *point {
            return Err(TrajectoryError::RepeatedPoint { point: k });
        }
    }
    sums::check_points(points, limits)
}

/// First guess of the durations of the segments. With these durations, no mean speed exceeds its speed limit, and no motion
/// from rest to rest would exceed its acceleration limit.
fn first_guess<const N: usize>(
    points: &[[f64; N]],
    limits: &MotionLimits<N>,
) -> Result<Vec<f64>, TrajectoryError> {
    let mut ways = Vec::with_capacity(points.len() - 1);
    for pair in points.windows(2) {
        let mut longest = 0.0_f64;
        for i in 0..N {
            let way = (pair[1][i] - pair[0][i]).abs();
            let time = (way / limits.speeds[i]).max((way / limits.accelerations[i]).sqrt());
            if way > 0.0 && time == 0.0 {
                return Err(TrajectoryError::Unlimited { joint: i });
            }
            longest = longest.max(time);
        }
        ways.push(longest);
    }
    Ok(ways)
}

/// Splines through the points. If a follower would leave its limits with splines, its coordinates use monotonic
/// polynomials.
fn through<const N: usize>(
    points: &[[f64; N]],
    ways: &[f64],
    spans: &[f64],
    limits: &MotionLimits<N>,
) -> Result<Vec<Piece<N>>, TrajectoryError> {
    let pieces = spline::through(points, ways, spans, &limits.positions, &[false; N])?;
    let mut is_monotone = [false; N];
    for joint in sums::of(limits).filter(|joint| sums::first_outside(joint, &pieces, spans).is_some()) {
        let followed = joint.ratios.map(|ratio| ratio != 0.0);
        is_monotone.iter_mut().zip(followed).for_each(|(is, follows)| *is |= follows);
    }
    if is_monotone.contains(&true) {
        return spline::through(points, ways, spans, &limits.positions, &is_monotone);
    }
    Ok(pieces)
}

/// Smallest factor of the duration of each segment for which the segment keeps the limits.
fn ratios<const N: usize>(
    pieces: &[Piece<N>],
    spans: &[f64],
    limits: &MotionLimits<N>,
    ways: usize,
) -> Vec<f64> {
    let mut ratios = vec![0.0_f64; ways];
    for (k, (piece, span)) in pieces.iter().zip(spans).enumerate() {
        let ratio = &mut ratios[spline::way_of(k, ways)];
        for i in 0..N {
            let [_, speed, acceleration] = piece[i].extremes(*span);
            let largest = |[low, high]: [f64; 2]| high.max(-low);
            let faster = largest(speed) / limits.speeds[i];
            let harder = (largest(acceleration) / limits.accelerations[i]).sqrt();
            *ratio = ratio.max(faster).max(harder);
        }
        *ratio = ratio.max(sums::largest_ratio(piece, *span, limits));
    }
    ratios
}
