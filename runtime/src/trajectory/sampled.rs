//! Motion through samples at a fixed period, with polynomials between the samples.

use super::polynomial::Quintic;
use super::{
    Sample, Trajectory, TrajectoryError, require_finite, require_periods, require_positive,
    require_representable,
};
#[cfg(not(feature = "std"))]
use crate::no_std::*;

/// A motion through samples at the times 0, T, 2T, … with the period T. Between two samples the motion is the polynomial of
/// degree five with the positions, velocities and accelerations of both samples. Therefore the motion is C².
#[derive(Debug, Clone, PartialEq)]
pub struct Sampled<const N: usize> {
    samples: Vec<Sample<N>>,
    period: f64,
}

impl<const N: usize> Sampled<N> {
    /// Motion through `samples` with this `period` (s). Positions, velocities and accelerations must be
    /// consistent. Otherwise use [`Recording::smoothed`](super::Recording::smoothed).
    ///
    /// # Errors
    /// - [`TrajectoryError::TooFew`] for fewer than two samples.
    /// - [`TrajectoryError::NotFinite`] for an entry that is not finite.
    /// - [`TrajectoryError::NotPositive`] for a period that is not positive.
    /// - [`TrajectoryError::OutOfRange`] for an overflow between two samples.
    pub fn new(samples: Vec<Sample<N>>, period: f64) -> Result<Self, TrajectoryError> {
        require_positive("period", period)?;
        if samples.len() < 2 {
            return Err(TrajectoryError::TooFew { what: "samples", needed: 2, given: samples.len() });
        }
        for (i, sample) in samples.iter().enumerate() {
            require_finite(&format!("positions of sample {i}"), &sample.positions)?;
            require_finite(&format!("velocities of sample {i}"), &sample.velocities)?;
            require_finite(&format!("accelerations of sample {i}"), &sample.accelerations)?;
        }
        let motion = Self { samples, period };
        require_representable("duration", &[motion.duration()])?;
        for k in 1..motion.samples.len() {
            for i in 0..N {
                let between = motion.between(k - 1, i);
                require_representable("motion between samples", &between.bounds(period))?;
            }
        }
        Ok(motion)
    }

    /// Polynomial of coordinate `i` from sample `k` to the next sample.
    fn between(&self, k: usize, i: usize) -> Quintic {
        let end = |s: &Sample<N>| [s.positions[i], s.velocities[i], s.accelerations[i]];
        let (a, b) = (&self.samples[k], &self.samples[k + 1]);
        Quintic::new(end(a), end(b), self.period)
    }

    /// Samples `trajectory` every `period` (s). The last sample is at or after the end of the trajectory.
    ///
    /// # Errors
    /// The errors of [`Sampled::new`]. [`TrajectoryError::OutOfRange`] for more than [`MAX_SAMPLES`](super::MAX_SAMPLES)
    /// samples or a NaN duration.
    pub fn of(trajectory: &impl Trajectory<N>, period: f64) -> Result<Self, TrajectoryError> {
        require_positive("period", period)?;
        let last = require_periods(trajectory.duration(), period)?.max(1);
        let samples = (0..=last).map(|k| trajectory.sample(k as f64 * period)).collect();
        Self::new(samples, period)
    }

    /// The samples that the motion passes through.
    #[must_use]
    pub fn samples(&self) -> &[Sample<N>] {
        &self.samples
    }

    /// Time between two samples (s).
    #[must_use]
    pub fn period(&self) -> f64 {
        self.period
    }
}

impl<const N: usize> Trajectory<N> for Sampled<N> {
    fn duration(&self) -> f64 {
        (self.samples.len() - 1) as f64 * self.period
    }

    fn sample(&self, t: f64) -> Sample<N> {
        let last = self.samples.len() - 1;
        if t.is_nan() || t < 0.0 {
            return Sample::at_rest(self.samples[0].positions);
        }
        if t > self.duration() {
            return Sample::at_rest(self.samples[last].positions);
        }
        // The conversion truncates. The last sample belongs to the last interval.
        let k = ((t / self.period) as usize).min(last - 1);
        let local = t - k as f64 * self.period;
        let mut sample = self.samples[k];
        for i in 0..N {
            let [p, v, acceleration] = self.between(k, i).at(local);
            sample.positions[i] = p;
            sample.velocities[i] = v;
            sample.accelerations[i] = acceleration;
        }
        sample
    }
}
