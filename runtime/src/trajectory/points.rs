//! Sequences of points with rest in each point.

use super::{RestToRest, Sample, Trajectory, TrajectoryError, require_positive, require_representable};
#[cfg(not(feature = "std"))]
use crate::no_std::*;

/// Motion through points in joint space that stops at each point. Each segment is a [`RestToRest`] motion.
#[derive(Debug, Clone, PartialEq)]
pub struct PointSequence<const N: usize> {
    pieces: Vec<RestToRest<N>>,
    /// Times at which the motions begin (s). The last entry is the end of the last motion.
    times: Vec<f64>,
}

impl<const N: usize> PointSequence<N> {
    /// Motion through `points` [rad or m]. Each segment is as fast as `speeds` and `accelerations` allow (see
    /// [`RestToRest::within`]). The motion rests for `dwell` ≥ 0 (s) in each inner point.
    ///
    /// # Errors
    /// - [`TrajectoryError::TooFew`] for fewer than two points.
    /// - [`TrajectoryError::NotPositive`] or [`TrajectoryError::NotFinite`] for a `dwell` that is negative or not finite.
    /// - The errors of [`RestToRest::within`].
    pub fn within(
        points: &[[f64; N]],
        speeds: &[f64; N],
        accelerations: &[f64; N],
        dwell: f64,
    ) -> Result<Self, TrajectoryError> {
        let pieces = points
            .windows(2)
            .map(|w| RestToRest::within(w[0], w[1], speeds, accelerations, SHORTEST))
            .collect::<Result<_, _>>()?;
        Self::chain(pieces, points.len(), dwell)
    }

    /// Motion through `points` [rad or m]. Each segment takes the time in `durations` (s). The motion rests
    /// for `dwell` ≥ 0 (s) in each inner point.
    ///
    /// # Errors
    /// - [`TrajectoryError::TooFew`] for fewer than two points, or if the number of durations is not the number of points
    ///   minus 1.
    /// - [`TrajectoryError::NotPositive`] or [`TrajectoryError::NotFinite`] for a `dwell` that is negative or not finite.
    /// - The errors of [`RestToRest::new`].
    pub fn timed(points: &[[f64; N]], durations: &[f64], dwell: f64) -> Result<Self, TrajectoryError> {
        if durations.len() + 1 != points.len() {
            return Err(TrajectoryError::TooFew {
                what: "points for the durations",
                needed: durations.len() + 1,
                given: points.len(),
            });
        }
        let ways = points.windows(2).zip(durations);
        let pieces =
            ways.map(|(w, duration)| RestToRest::new(w[0], w[1], *duration)).collect::<Result<_, _>>()?;
        Self::chain(pieces, points.len(), dwell)
    }

    fn chain(pieces: Vec<RestToRest<N>>, points: usize, dwell: f64) -> Result<Self, TrajectoryError> {
        if points < 2 {
            return Err(TrajectoryError::TooFew { what: "points", needed: 2, given: points });
        }
        if dwell != 0.0 {
            require_positive("dwell", dwell)?;
        }
        let mut times = vec![0.0];
        let mut end = 0.0;
        for (k, piece) in pieces.iter().enumerate() {
            end += piece.duration();
            if k + 1 < pieces.len() {
                end += dwell;
            }
            times.push(end);
        }
        require_representable("duration", &[end])?;
        Ok(Self { pieces, times })
    }

    /// Start times of the segments, and the end time (s).
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.times
    }
}

/// Duration of the motion between two equal points (s).
const SHORTEST: f64 = 1e-3;

impl<const N: usize> Trajectory<N> for PointSequence<N> {
    fn duration(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    fn sample(&self, t: f64) -> Sample<N> {
        // After its end, each piece is at rest at its last point. NaN selects the first piece.
        let begun = self.times.iter().skip(1).take_while(|begin| **begin <= t).count();
        let k = begun.min(self.pieces.len() - 1);
        self.pieces[k].sample(t - self.times[k])
    }
}
