//! Total-variation regularized differentiation (Chartrand 2011), by lagged diffusivity.
//!
//! The unknown is the smoothed signal s of the measured signal f. It minimizes `F(s) = ½ ‖s − f‖² + γ Δt Σ √((D s)² + ε)`,
//! in which D is the divided difference of order k + 1. For k = 1 the variation of the first derivative is penalized
//! (Chartrand's functional with a free offset). For k = 2 the variation of the second derivative is penalized. Each
//! iteration fixes the root and solves the banded system `(I + γ Δt Dᵀ W D) s = f` with `W = 1/√((D s)² + ε)`. The cost of
//! an iteration is linear in the number of samples.

use super::banded::{Band, solve};
use super::{Derivatives, by_discrepancy, require_noise, require_signal, residual_bound, rms_difference};
use crate::error::{Result, require_setting};

/// Settings of the total-variation regularization.
///
/// The smoothed signal s of the measured signal f minimizes `½ ‖s − f‖² + γ Δt Σ √((D s)² + ε)` with the
/// weight γ, the period Δt and the constant ε. D is the divided difference of order `order` + 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TotalVariation {
    /// Order of the derivative whose variation is penalized: 1 for piecewise constant velocities, 2 for piecewise linear
    /// velocities.
    pub order: usize,
    /// Rule for the weight γ of the variation.
    pub regularization: Regularization,
    /// Constant ε under the square root, in (unit of the signal / s^(order+1))². For a small ε the derivative
    /// jumps. `None` is possible only with [`Regularization::Noise`]. ε is then the mean square of the
    /// divided difference of a quadratically smoothed signal, which suits smooth motions.
    pub epsilon: Option<f64>,
    /// Largest number of iterations.
    pub iterations: usize,
    /// Largest change of a sample of the smoothed signal at which the iterations end, as a share of the
    /// signal's range.
    pub tolerance: f64,
}

/// Rule for the weight γ of the variation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Regularization {
    /// A given weight γ of the variation.
    Weight(f64),
    /// Standard deviation σ of the signal's noise. The weight γ of the variation follows from the discrepancy
    /// principle (Morozov 1966). It is the largest γ for which the rms of the smoothed minus the measured
    /// signal does not exceed σ, apart from a margin for chance.
    Noise(f64),
}

/// Smoothed signal that minimizes the total-variation functional, with its derivative between the samples.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TotalVariationResult {
    /// Smoothed signal s at the samples.
    pub signal: Vec<f64>,
    /// Slopes `(sᵢ₊₁ − sᵢ)/Δtᵢ` of the smoothed signal s between the samples. There is one entry less than in
    /// the signal.
    pub derivative: Vec<f64>,
    /// Weight γ of the variation.
    pub gamma: f64,
    /// Number of iterations.
    pub iterations: usize,
}

impl TotalVariation {
    /// Creates settings with a given γ, a penalty on the variation of the first derivative, and 20 iterations.
    pub(super) fn with_gamma(gamma: f64) -> Self {
        Self {
            order: 1,
            regularization: Regularization::Weight(gamma),
            epsilon: Some(1e-6),
            iterations: 20,
            tolerance: 1e-10,
        }
    }

    /// Creates settings with a penalty on the variation of the second derivative. The weight of the penalty
    /// follows from the standard deviation `sigma` of the signal's noise (see [`super::quantization_noise`]).
    pub fn from_noise(sigma: f64) -> Self {
        Self {
            order: 2,
            regularization: Regularization::Noise(sigma),
            epsilon: None,
            ..Self::with_gamma(0.0)
        }
    }

    /// Returns the smoothed signal and its derivatives at the sampling times.
    ///
    /// - `times`: sampling times in s, which must increase
    ///
    /// # Errors
    /// [`TooFewSamples`](crate::IdentificationError::TooFewSamples) for fewer than order + 3 samples,
    /// [`NotFinite`](crate::IdentificationError::NotFinite) for values that are not finite,
    /// [`File`](crate::IdentificationError::File) for times that do not increase,
    /// [`Shape`](crate::IdentificationError::Shape) for different lengths, and
    /// [`Setting`](crate::IdentificationError::Setting) for a setting out of its range.
    pub fn differentiate(&self, times: &[f64], signal: &[f64]) -> Result<Derivatives> {
        let result = self.solve(times, signal)?;
        let m = signal.len();
        let middle: Vec<f64> = times.windows(2).map(|t| 0.5 * (t[0] + t[1])).collect();
        let slope: Vec<f64> = (0..m - 2)
            .map(|i| (result.derivative[i + 1] - result.derivative[i]) / (middle[i + 1] - middle[i]))
            .collect();
        let second = |i: usize| slope[i.clamp(1, m - 2) - 1];
        let first = |i: usize| {
            let nearest = i.min(m - 2);
            let other = if i == 0 { 0 } else { i - 1 };
            let (a, b) = (other.min(m - 2), nearest);
            if a == b {
                result.derivative[a] + second(i) * (times[i] - middle[a])
            } else {
                let share = (times[i] - middle[a]) / (middle[b] - middle[a]);
                result.derivative[a] + share * (result.derivative[b] - result.derivative[a])
            }
        };
        Ok(Derivatives {
            first: (0..m).map(first).collect(),
            second: (0..m).map(second).collect(),
            residual: rms_difference(&result.signal, signal),
            value: result.signal,
            parameter: result.gamma,
        })
    }

    /// Computes the smoothed signal that minimizes the total-variation functional.
    ///
    /// # Errors
    /// The errors are those of [`Self::differentiate`].
    pub(super) fn solve(&self, times: &[f64], signal: &[f64]) -> Result<TotalVariationResult> {
        require_setting("order", self.order as f64, matches!(self.order, 1 | 2), "it must be 1 or 2")?;
        if let Some(epsilon) = self.epsilon {
            require_setting("ε", epsilon, epsilon > 0.0, "it must be positive")?;
        } else if let Regularization::Weight(gamma) = self.regularization {
            require_setting("γ", gamma, false, "if the weight γ is given, ε must be given, too")?;
        }
        require_setting("iterations", self.iterations as f64, self.iterations > 0, "at least one is needed")?;
        require_signal(times, signal, self.order + 3)?;
        match self.order {
            1 => Problem::<3>::new(self, times, signal).solve(),
            _ => Problem::<4>::new(self, times, signal).solve(),
        }
    }
}

struct Problem<'a, const W: usize> {
    settings: &'a TotalVariation,
    times: &'a [f64],
    signal: &'a [f64],
    /// Signal minus its mean. The functional does not depend on the mean, and the subtraction avoids a loss of digits.
    centred: Vec<f64>,
    mean: f64,
    step: f64,
    /// Coefficients of each divided difference. There is only one entry if the sampling is uniform.
    differences: Vec<[f64; W]>,
    root: Root,
}

/// Penalty on a divided difference d of the smoothed signal.
#[derive(Clone, Copy)]
enum Root {
    /// Penalty `√(d² + ε)` on a divided difference d, with the constant ε.
    Smoothed(f64),
    /// Penalty `½ d²` on a divided difference d, to estimate the scale of the signal.
    Quadratic,
}

impl<'a, const W: usize> Problem<'a, W> {
    fn new(settings: &'a TotalVariation, times: &'a [f64], signal: &'a [f64]) -> Self {
        let m = times.len();
        let step = (times[m - 1] - times[0]) / (m - 1) as f64;
        let uniform = times.windows(2).all(|t| (t[1] - t[0] - step).abs() <= 1e-6 * step);
        let differences = if uniform {
            let ideal: Vec<f64> = (0..W).map(|i| i as f64 * step).collect();
            vec![divided_difference(&ideal)]
        } else {
            times.windows(W).map(divided_difference).collect()
        };
        let mean = signal.iter().sum::<f64>() / m as f64;
        Self {
            settings,
            times,
            signal,
            centred: signal.iter().map(|x| x - mean).collect(),
            mean,
            step,
            differences,
            root: Root::Smoothed(settings.epsilon.unwrap_or(1.0)),
        }
    }

    fn solve(self) -> Result<TotalVariationResult> {
        match self.settings.regularization {
            Regularization::Weight(gamma) => {
                require_setting("γ", gamma, gamma >= 0.0, "it must not be negative")?;
                Ok(self.minimize(gamma, None))
            }
            Regularization::Noise(sigma) => {
                require_noise(sigma)?;
                self.explain_noise(sigma)
            }
        }
    }

    fn explain_noise(mut self, sigma: f64) -> Result<TotalVariationResult> {
        if self.settings.epsilon.is_none() {
            self.root = Root::Quadratic;
            let smooth = self.by_discrepancy(sigma)?.signal;
            let squares: f64 = (0..smooth.len() + 1 - W).map(|i| self.difference(i, &smooth).powi(2)).sum();
            // The floor avoids singular equations for a straight signal, whose divided difference is rounding error.
            let floor = (sigma / self.duration().powi(W as i32 - 1)).powi(2);
            self.root = Root::Smoothed((squares / smooth.len() as f64).max(floor));
        }
        self.by_discrepancy(sigma)
    }

    fn duration(&self) -> f64 {
        self.step * self.signal.len() as f64
    }

    fn difference(&self, i: usize, s: &[f64]) -> f64 {
        let d = self.coefficients(i);
        (0..W).map(|k| d[k] * s[i + k]).sum()
    }

    fn coefficients(&self, i: usize) -> [f64; W] {
        self.differences[if self.differences.len() == 1 { 0 } else { i }]
    }

    fn minimize(&self, gamma: f64, start: Option<&[f64]>) -> TotalVariationResult {
        let mut s = start.map_or_else(|| self.centred.clone(), <[f64]>::to_vec);
        let mut band: Band<W> = vec![[0.0; W]; s.len()];
        let range = self.centred.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        let mut iterations = 0;
        while iterations < self.settings.iterations {
            self.assemble(gamma, &s, &mut band);
            let before = std::mem::replace(&mut s, self.centred.clone());
            solve(&mut band, &mut s);
            iterations += 1;
            let moved = s.iter().zip(&before).fold(0.0_f64, |a, (x, y)| a.max((x - y).abs()));
            if moved <= self.settings.tolerance * range {
                break;
            }
        }
        let derivative =
            s.windows(2).zip(self.times.windows(2)).map(|(s, t)| (s[1] - s[0]) / (t[1] - t[0])).collect();
        s.iter_mut().for_each(|s| *s += self.mean);
        TotalVariationResult { signal: s, derivative, gamma, iterations }
    }

    /// Computes the lower band of `I + γ Δt Dᵀ W D`, with the weight γ, the period Δt, the divided difference
    /// D and the weights W at the signal s.
    fn assemble(&self, gamma: f64, s: &[f64], band: &mut Band<W>) {
        band.fill(std::array::from_fn(|k| if k == 0 { 1.0 } else { 0.0 }));
        let weight = gamma * self.step;
        for i in 0..s.len() + 1 - W {
            let d = self.coefficients(i);
            let w = match self.root {
                Root::Smoothed(epsilon) => weight / (self.difference(i, s).powi(2) + epsilon).sqrt(),
                Root::Quadratic => weight,
            };
            for row in 0..W {
                for column in 0..=row {
                    band[i + row][row - column] += w * d[row] * d[column];
                }
            }
        }
    }

    /// Returns the result for the largest γ whose residual can be explained by the noise. The residual grows with γ. If the
    /// residual stays below the bound for all γ, the largest γ is used.
    fn by_discrepancy(&self, sigma: f64) -> Result<TotalVariationResult> {
        let residual = |result: &TotalVariationResult| rms_difference(&result.signal, self.signal);
        let sigma = residual_bound(sigma, self.signal.len());
        // The range of γ follows from the product of γ and the weight of one difference, relative to 1. It extends from no
        // smoothing to a window of the whole signal.
        let typical = match self.root {
            Root::Smoothed(epsilon) => epsilon.sqrt().max(sigma / self.duration().powi(W as i32 - 1)),
            Root::Quadratic => 1.0,
        };
        let unit = |window: f64| window.powi(2 * W as i32 - 2) * typical / self.step;
        let (least, largest) = (1e-6 * unit(self.step), 1e3 * unit(self.duration()));
        let mut best = self.minimize(least, None);
        if residual(&best) > sigma {
            return Ok(best);
        }
        by_discrepancy(least.ln(), largest.ln(), 0.05, |logarithm| {
            let warm: Vec<f64> = best.signal.iter().map(|s| s - self.mean).collect();
            let result = self.minimize(logarithm.exp(), Some(&warm));
            let explains = residual(&result) <= sigma;
            if explains {
                best = result;
            }
            Ok(explains)
        })?;
        Ok(best)
    }
}

/// Returns (W − 1)! times the coefficients of the divided difference at the given times. It approximates a derivative of
/// order W − 1.
fn divided_difference<const W: usize>(times: &[f64]) -> [f64; W] {
    let factorial: f64 = (1..W).map(|k| k as f64).product();
    std::array::from_fn(|i| {
        let product: f64 = (0..W).filter(|&j| j != i).map(|j| times[i] - times[j]).product();
        factorial / product
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::random::SplitMix64;

    fn objective(s: &[f64], f: &[f64], gamma: f64, dt: f64) -> f64 {
        let fidelity: f64 = s.iter().zip(f).map(|(s, f)| (s - f).powi(2)).sum::<f64>() / 2.0;
        let variation: f64 =
            s.windows(3).map(|w| (((w[2] - 2.0 * w[1] + w[0]) / dt / dt).powi(2) + 1e-6).sqrt()).sum();
        fidelity + gamma * dt * variation
    }

    #[test]
    fn the_result_is_a_minimum_of_the_functional() {
        let mut random = SplitMix64::new(2);
        let dt = 0.01;
        let times: Vec<f64> = (0..300).map(|i| f64::from(i) * dt).collect();
        let signal: Vec<f64> = times.iter().map(|t| (t - 1.5).abs() + 0.01 * random.normal()).collect();
        let gamma = 1e-3;
        let settings = TotalVariation { iterations: 500, ..TotalVariation::with_gamma(gamma) };
        let result = settings.solve(&times, &signal).unwrap();
        let least = objective(&result.signal, &signal, gamma, dt);
        for _ in 0..200 {
            let size = 1e-6 * 10f64.powi(random.below(4) as i32);
            let moved: Vec<f64> = result.signal.iter().map(|s| s + size * random.normal()).collect();
            assert!(objective(&moved, &signal, gamma, dt) >= least);
        }
        // A kink: the derivative is −1, then 1, and constant in between.
        assert!((result.derivative[50] + 1.0).abs() < 0.05 && (result.derivative[250] - 1.0).abs() < 0.05);
    }

    #[test]
    fn the_discrepancy_principle_meets_the_noise() {
        let (times, signal, _) = super::super::tests::chirp(4);
        for order in [1, 2] {
            let settings = TotalVariation { order, ..TotalVariation::from_noise(0.01) };
            let result = settings.differentiate(&times, &signal).unwrap();
            assert!(
                result.residual <= residual_bound(0.01, 2000) && result.residual > 0.0098,
                "order {order}: {}",
                result.residual
            );
        }
    }

    #[test]
    fn jittered_sampling_gives_the_same_derivative() {
        let mut random = SplitMix64::new(6);
        let times: Vec<f64> =
            (0..1000).map(|i| 0.01 * (f64::from(i) + 0.4 * (random.uniform() - 0.5))).collect();
        let signal: Vec<f64> = times.iter().map(|t| (2.0 * t).sin() + 1e-4 * random.normal()).collect();
        let result = TotalVariation::from_noise(1e-4).differentiate(&times, &signal).unwrap();
        for i in 50..950 {
            assert!((result.first[i] - 2.0 * (2.0 * times[i]).cos()).abs() < 0.02);
            assert!((result.second[i] + 4.0 * (2.0 * times[i]).sin()).abs() < 0.5);
        }
    }
}
