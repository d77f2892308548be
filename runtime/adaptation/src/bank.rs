//! Kalman filters that estimate the terms for several rates of drift, and their weighted average.

use super::correlation::Correlation;
use super::law::{TERMS, dot, product, root};
use gelenk_kernels::math::exp;
use libm::log;

/// Weight of the initial noise variance, in samples. The weight is small, because a guess that is a hundred times too large
/// would otherwise have an effect for longer than the memory.
const FIRST_WEIGHT: f64 = 1.0;
/// Number of rates of drift.
pub(super) const RATES: usize = 3;

/// Mean and covariance of the coefficients δ of the terms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gaussian<const K: usize = TERMS> {
    pub mean: [f64; K],
    pub covariance: [[f64; K]; K],
}

impl<const K: usize> Gaussian<K> {
    /// The prior distribution N(0, diag(variances)).
    pub(super) fn prior(variances: &[f64; K]) -> Self {
        let row = |i: usize| core::array::from_fn(|j| if i == j { variances[i] } else { 0.0 });
        Self { mean: [0.0; K], covariance: core::array::from_fn(row) }
    }

    /// Adds drift to the coefficients δ of the terms: `δ ← δ + N(0, share · V)` with the variances V of the
    /// prior. A variance that would exceed that of the prior is reduced by scaling its row and column, so the
    /// covariance remains positive semidefinite.
    pub(super) fn widen(&mut self, share: f64, prior: &[f64; K]) {
        for i in 0..K {
            let wider = self.covariance[i][i] + share * prior[i];
            self.covariance[i][i] = wider;
            if wider > prior[i] {
                let factor = root(prior[i] / wider);
                for j in 0..K {
                    self.covariance[i][j] *= factor;
                    self.covariance[j][i] *= factor;
                }
            }
        }
    }

    /// Variance of the torque `φᵀ δ` for the values φ of the terms and their coefficients δ.
    pub(super) fn variance(&self, phi: &[f64; K]) -> f64 {
        dot(&product(&self.covariance, phi), phi).max(0.0)
    }

    /// Updates mean and covariance of the coefficients δ with a measured torque `φᵀ δ + N(0, noise)`, for the
    /// values φ of the terms. `error` is the prediction error of the torque.
    pub(super) fn update(&mut self, phi: &[f64; K], error: f64, noise: f64) {
        let direction = product(&self.covariance, phi);
        let total = dot(&direction, phi).max(0.0) + noise;
        for i in 0..K {
            self.mean[i] += direction[i] * error / total;
            for j in 0..=i {
                let value = self.covariance[i][j] - direction[i] * direction[j] / total;
                self.covariance[i][j] = value;
                self.covariance[j][i] = value;
            }
        }
    }
}

/// A sample of the filtered torque that the described law does not explain.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub phi: [f64; TERMS],
    pub torque: f64,
    /// Position relative to the range of positions, which is divided into cells to detect torque ripple.
    pub share: f64,
    pub forwards: bool,
}

/// Kalman filter for one rate of drift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Track {
    pub state: Gaussian,
    /// Logarithm of the weight, relative to the filter with the largest weight.
    pub weight: f64,
    pub correlation: Correlation,
    /// Number of correlated samples that have the information of one independent sample.
    pub correlated: f64,
}

/// Kalman filters for several rates of drift, with a common noise variance.
///
/// The terms are a random walk, δ(t + dt) = δ(t) + N(0, V dt/T), with the variances V of the prior. T is the time in which a
/// change as large as the prior is expected. T is unknown. Therefore one filter runs for each of several values of T, and the
/// weight w_l of filter l follows from its predictions (dynamic model averaging, Raftery, Kárný, Ettler, *Technometrics* 52,
/// 2010):
///
/// ```text
///     w_l ∝ w_l^α p_l(r)^(1/c)        p_l(r) = N(r; φᵀ δ_l, S_l)        S_l = φᵀ P_l φ + σ²
/// ```
///
/// Here r is the torque of the sample, φ are the values of the terms, and P_l is the covariance of filter l.
/// 1 − α is the interval between samples divided by the memory.
///
/// - All filters share the noise variance σ². It is estimated from the prediction errors e:
///   `σ² ← σ² (1 + (Σ w_l e²/S_l − 1)/n)` (West, Harrison, *Bayesian Forecasting and Dynamic Models*, 1997, section 10.8). With
///   separate variances, the fastest filter would interpret noise as drift.
/// - Each filter estimates from its residuals the number c_l of correlated samples that have the information of one independent
///   sample. It uses c_l σ² as noise variance. A filter that lags has correlated residuals, but must not slow down the other
///   filters. Therefore c is the smallest c_l.
/// - In directions that φ does not excite, the mean of a filter is constant, and the covariance grows with the drift. So
///   learned terms are only forgotten if new information replaces them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bank {
    pub tracks: [Track; RATES],
    /// Variance of the noise.
    pub noise: f64,
    /// Weight of the noise variance, as a number of samples.
    pub taken: f64,
}

impl Bank {
    /// Filters with the prior distribution.
    ///
    /// - `noise`: initial noise variance
    pub(super) fn new(prior: &[f64; TERMS], noise: f64) -> Self {
        let (state, correlation) = (Gaussian::prior(prior), Correlation::NEW);
        let track = Track { state, weight: 0.0, correlation, correlated: 1.0 };
        Self { tracks: [track; RATES], noise, taken: FIRST_WEIGHT }
    }

    /// Advances all filters by `dt` (s). Returns the ratio of the added variance to the prior, averaged over the filters.
    ///
    /// - `times`: time T of each filter (s)
    pub(super) fn drift(&mut self, dt: f64, times: &[f64; RATES], prior: &[f64; TERMS]) -> f64 {
        let weights = self.weights();
        for (track, time) in self.tracks.iter_mut().zip(times) {
            track.state.widen(dt / time, prior);
        }
        weights.iter().zip(times).map(|(weight, time)| weight * dt / time).sum()
    }

    /// Adds `share` times the variances of the prior to all filters.
    pub(super) fn widen(&mut self, share: f64, prior: &[f64; TERMS]) {
        self.tracks.iter_mut().for_each(|track| track.state.widen(share, prior));
    }

    /// Marks a pause, so that the next sample does not count as consecutive to the previous sample.
    pub(super) fn pause(&mut self) {
        self.tracks.iter_mut().for_each(|track| track.correlation.last = 0.0);
    }

    /// Updates all filters with a sample.
    ///
    /// - `forgetting`: exponent α of the filters' weights from sample to sample, which is also the decay
    ///   factor of leaky sums
    /// - `least`: smallest noise variance
    pub(super) fn update(&mut self, sample: &Sample, forgetting: f64, least: f64) {
        self.taken = forgetting * self.taken + 1.0;
        let correlated = self.correlated();
        let weights = self.weights();
        let mut ratios = 0.0;
        for (track, weight) in self.tracks.iter_mut().zip(weights) {
            let error = sample.torque - dot(&sample.phi, &track.state.mean);
            let variance = track.state.variance(&sample.phi) + self.noise;
            let ratio = error * error / variance;
            ratios += weight * ratio;
            track.weight = forgetting * track.weight - 0.5 * (log(variance) + ratio) / correlated;
            track.state.update(&sample.phi, error, self.noise * track.correlated);
            let residual = sample.torque - dot(&sample.phi, &track.state.mean);
            track.correlated = track.correlation.take(residual, sample.share, sample.forwards, forgetting);
        }
        self.noise = (self.noise * (1.0 + (ratios - 1.0) / self.taken)).max(least);
        let largest = self.tracks.iter().fold(f64::NEG_INFINITY, |largest, track| largest.max(track.weight));
        self.tracks.iter_mut().for_each(|track| track.weight -= largest);
    }

    /// Smallest number c_l over all filters l: the number of correlated samples with the information of one independent sample.
    pub(super) fn correlated(&self) -> f64 {
        self.tracks.iter().fold(f64::INFINITY, |least, track| least.min(track.correlated))
    }

    /// Mean and covariance of the weighted average of the filters.
    pub(super) fn average(&self) -> Gaussian {
        average(&self.tracks.map(|track| track.state), &self.tracks.map(|track| track.weight))
    }

    fn weights(&self) -> [f64; RATES] {
        let weights = self.tracks.map(|track| exp(track.weight));
        let sum: f64 = weights.iter().sum();
        weights.map(|weight| weight / sum)
    }
}

/// Mean and covariance of a mixture of distributions.
///
/// - `logarithms`: logarithms of the weights, which need not be normalized
pub(super) fn average<const L: usize>(parts: &[Gaussian; L], logarithms: &[f64; L]) -> Gaussian {
    let largest = logarithms.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
    let weights = logarithms.map(|w| exp(w - largest));
    let sum: f64 = weights.iter().sum();
    let weights = weights.map(|w| w / sum);
    let mean: [f64; TERMS] =
        core::array::from_fn(|i| parts.iter().zip(&weights).map(|(part, w)| w * part.mean[i]).sum());
    let covariance = |i: usize, j: usize| {
        let of_part =
            |part: &Gaussian| part.covariance[i][j] + (part.mean[i] - mean[i]) * (part.mean[j] - mean[j]);
        parts.iter().zip(&weights).map(|(part, w)| w * of_part(part)).sum()
    };
    Gaussian { mean, covariance: core::array::from_fn(|i| core::array::from_fn(|j| covariance(i, j))) }
}
