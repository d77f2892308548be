//! Kalman filters that estimate the terms for several rates of drift, and their weighted average.

use super::correlation::Correlation;
use super::law::{TERMS, dot, product, root};
use gelenk_kernels::math::exp;
use libm::log;

/// Weight of the initial noise variance, in samples. The weight is small, because a guess that is a hundred times too large
/// would otherwise have an effect for longer than the memory.
const FIRST_WEIGHT: f64 = 1.0;
/// Number of rates of drift.
pub(super) const RATES: usize = 4;
/// Correlation time of the rates of change, relative to the time T of the drift.
const PERSISTENCE: f64 = 1.0 / 4000.0;

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
    /// covariance remains positive semidefinite. Returns the factors of the rows and columns.
    pub(super) fn widen(&mut self, share: f64, prior: &[f64; K]) -> [f64; K] {
        let mut factors = [1.0; K];
        for i in 0..K {
            let wider = self.covariance[i][i] + share * prior[i];
            self.covariance[i][i] = wider;
            if wider > prior[i] {
                factors[i] = root(prior[i] / wider);
                for j in 0..K {
                    self.covariance[i][j] *= factors[i];
                    self.covariance[j][i] *= factors[i];
                }
            }
        }
        factors
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
    /// The coefficients δ.
    pub state: Gaussian,
    /// The rates of change ρ of the coefficients δ [1/s].
    pub change: Gaussian,
    /// Covariance of the coefficients δ (rows) and their rates of change ρ (columns).
    pub cross: [[f64; TERMS]; TERMS],
    /// Logarithm of the weight, relative to the filter with the largest weight.
    pub weight: f64,
    pub correlation: Correlation,
    /// Number of correlated samples that have the information of one independent sample.
    pub correlated: f64,
}

impl Track {
    fn new(prior: &[f64; TERMS]) -> Self {
        Self {
            state: Gaussian::prior(prior),
            change: Gaussian::prior(&[0.0; TERMS]),
            cross: [[0.0; TERMS]; TERMS],
            weight: 0.0,
            correlation: Correlation::NEW,
            correlated: 1.0,
        }
    }

    /// Advances coefficients and rates of change by `dt` (s). Without a sample, the mean of the coefficients is constant.
    ///
    /// - `time`: time T of the drift (s)
    fn advance(&mut self, dt: f64, time: f64, prior: &[f64; TERMS], is_sampled: bool) {
        // Exact integration of the rates of change over `dt`.
        let persistence = PERSISTENCE * time;
        let keep = exp(-dt / persistence);
        let (lost, moved) = (1.0 - keep, persistence * (1.0 - keep));
        let (change, cross) = (&mut self.change, self.cross);
        for i in 0..TERMS {
            if is_sampled {
                self.state.mean[i] += moved * change.mean[i];
            }
            change.mean[i] *= keep;
            for j in 0..TERMS {
                let of_change = moved * change.covariance[i][j];
                self.state.covariance[i][j] += moved * (cross[i][j] + cross[j][i] + of_change);
                self.cross[i][j] = keep * (cross[i][j] + of_change);
                change.covariance[i][j] *= keep * keep;
            }
            self.cross[i][i] += 0.5 * lost * lost / time * prior[i];
            change.covariance[i][i] += 0.5 * lost * (1.0 + keep) / (time * persistence) * prior[i];
        }
        let added = (dt - 0.5 * moved * (3.0 - keep)) / time;
        self.widen(added.max(0.0), prior);
    }

    fn widen(&mut self, share: f64, prior: &[f64; TERMS]) {
        let factors = self.state.widen(share, prior);
        for (row, factor) in self.cross.iter_mut().zip(factors) {
            row.iter_mut().for_each(|entry| *entry *= factor);
        }
    }

    /// Updates the filter with a sample, as [`Gaussian::update`].
    fn update(&mut self, phi: &[f64; TERMS], error: f64, noise: f64) {
        let direction = product(&self.state.covariance, phi);
        let total = dot(&direction, phi).max(0.0) + noise;
        let of_change: [f64; TERMS] =
            core::array::from_fn(|j| self.cross.iter().zip(phi).map(|(row, phi)| row[j] * phi).sum());
        let gains = of_change.map(|covariance| covariance / total);
        for i in 0..TERMS {
            self.change.mean[i] += gains[i] * error;
            for j in 0..TERMS {
                self.cross[j][i] -= direction[j] * gains[i];
                self.change.covariance[i][j] -= of_change[i] * gains[j];
            }
        }
        self.state.update(phi, error, noise);
    }
}

/// Kalman filters for several rates of drift, with a common noise variance.
///
/// The coefficients δ are a random walk with correlated steps: their rates of change ρ are correlated over a time κ that is short
/// compared with the time T of the drift (integrated Ornstein–Uhlenbeck process, Uhlenbeck, Ornstein, *Phys. Rev.* 36, 1930):
///
/// ```text
///     dδ/dt = ρ        κ dρ/dt = −ρ + white noise        cov ρ = V/(2 T κ)        κ = T/4000
/// ```
///
/// V are the variances of the prior. Over times longer than κ, the variance of δ increases by V dt/T, as that of a random walk.
/// Gears warm up gradually. A random walk without correlation lags behind such a drift, and its covariance does not include the lag.
///
/// T is the time in which a change as large as the prior is expected. T is unknown. Therefore one filter runs for each of several
/// values of T, and the weight w_l of filter l follows from its predictions (dynamic model averaging, Raftery, Kárný, Ettler,
/// *Technometrics* 52, 2010):
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
        Self { tracks: [Track::new(prior); RATES], noise, taken: FIRST_WEIGHT }
    }

    /// Advances all filters by `dt` (s). Returns the ratio of the added variance to the prior, averaged over the filters.
    ///
    /// - `times`: time T of each filter (s)
    /// - `is_sampled`: whether a sample follows. Otherwise the means are constant.
    pub(super) fn drift(
        &mut self,
        dt: f64,
        times: &[f64; RATES],
        prior: &[f64; TERMS],
        is_sampled: bool,
    ) -> f64 {
        let weights = self.weights();
        for (track, time) in self.tracks.iter_mut().zip(times) {
            track.advance(dt, *time, prior, is_sampled);
        }
        weights.iter().zip(times).map(|(weight, time)| weight * dt / time).sum()
    }

    /// Adds `share` times the variances of the prior to all filters.
    pub(super) fn widen(&mut self, share: f64, prior: &[f64; TERMS]) {
        self.tracks.iter_mut().for_each(|track| track.widen(share, prior));
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
            track.update(&sample.phi, error, self.noise * track.correlated);
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
