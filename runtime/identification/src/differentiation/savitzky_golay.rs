//! Savitzky–Golay differentiation: a least-squares polynomial around each sample (Savitzky and Golay 1964).

use super::super::error::{IdentificationError, Result, require_setting};
use super::{
    Derivatives, check, judged_residual, judged_windows, require_noise, residual_bound, rms_difference,
};
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Settings of the method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SavitzkyGolay {
    /// Degree of the polynomial, 2 to 8.
    pub degree: usize,
    /// Window, or the noise from which it is found.
    pub window: Window,
}

/// How the window is chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Window {
    /// Number of samples, odd, more than the degree.
    Samples(usize),
    /// The widest window whose rms residual does not exceed this noise σ (discrepancy principle).
    Noise(f64),
}

impl SavitzkyGolay {
    /// Window by hand.
    pub fn with_window(samples: usize, degree: usize) -> Self {
        Self { degree, window: Window::Samples(samples) }
    }

    /// Window from the noise σ, degree 5.
    pub fn from_noise(sigma: f64) -> Self {
        Self { degree: 5, window: Window::Noise(sigma) }
    }

    /// Smoothed signal and derivatives at the sampling times; near the ends the window is not centred.
    ///
    /// # Errors
    /// Fewer samples than the window, values that are not finite, times that do not increase, settings out of
    /// range.
    pub fn differentiate(&self, times: &[f64], signal: &[f64]) -> Result<Derivatives> {
        require_setting(
            "degree",
            self.degree as f64,
            (2..=8).contains(&self.degree),
            "it must lie between 2 and 8",
        )?;
        match self.window {
            Window::Samples(window) => {
                let wanted = format!("it must be odd and at least {}", self.degree + 1);
                require_setting("window", window as f64, window % 2 == 1 && window > self.degree, &wanted)?;
                check(times, signal, window)?;
                Filter::new(times, window, self.degree)?.apply(times, signal)
            }
            Window::Noise(sigma) => {
                require_noise(sigma)?;
                check(times, signal, self.degree + 3)?;
                self.widest(sigma, times, signal)
            }
        }
    }

    fn widest(&self, sigma: f64, times: &[f64], signal: &[f64]) -> Result<Derivatives> {
        let smallest = (self.degree + 2) | 1;
        let largest = judged_windows(signal.len()).iter().map(|w| w.len()).min().unwrap_or(0).min(2001);
        let (mut window, mut best) = (smallest, smallest);
        while window <= largest {
            let squares = |times: &[f64], signal: &[f64]| {
                let residual = Filter::new(times, window, self.degree)?.residual(times, signal)?;
                Ok(residual * residual * signal.len() as f64)
            };
            let (residual, count) = judged_residual(times, signal, squares)?;
            // The residual is not monotone in the window; far above the noise it does not come back.
            if residual > 1.5 * sigma {
                break;
            }
            if residual <= residual_bound(sigma, count) {
                best = window;
            }
            window = (window + 2).max((window as f64 * 1.08) as usize | 1);
        }
        Filter::new(times, best, self.degree)?.apply(times, signal)
    }
}

/// Weights for value, slope and curvature at the centre of a uniform window.
struct Filter {
    window: usize,
    degree: usize,
    uniform: bool,
    weights: [Vec<f64>; 3],
}

impl Filter {
    fn new(times: &[f64], window: usize, degree: usize) -> Result<Self> {
        let m = times.len();
        let step = (times[m - 1] - times[0]) / (m - 1) as f64;
        let uniform = times.windows(2).all(|t| (t[1] - t[0] - step).abs() <= 1e-6 * step);
        let half = (window / 2) as f64;
        let ideal: Vec<f64> = (0..window).map(|i| (i as f64 - half) * step).collect();
        let weights = polynomial_weights(&ideal, 0.0, degree)?;
        Ok(Self { window, degree, uniform, weights })
    }

    fn apply(&self, times: &[f64], signal: &[f64]) -> Result<Derivatives> {
        let out = self.filtered::<3>(times, signal)?;
        let residual = rms_difference(&out[0], signal);
        let [value, first, second] = out;
        Ok(Derivatives { value, first, second, residual, parameter: self.window as f64 })
    }

    /// Root mean square of signal minus smoothed signal.
    fn residual(&self, times: &[f64], signal: &[f64]) -> Result<f64> {
        Ok(rms_difference(&self.filtered::<1>(times, signal)?[0], signal))
    }

    /// Value and the first K − 1 derivatives.
    fn filtered<const K: usize>(&self, times: &[f64], signal: &[f64]) -> Result<[Vec<f64>; K]> {
        let (m, half) = (signal.len(), self.window / 2);
        let mut out: [Vec<f64>; K] = std::array::from_fn(|_| vec![0.0; m]);
        self.fill_end(0, 0..half, times, signal, &mut out)?;
        self.fill_end(m - self.window, m - half..m, times, signal, &mut out)?;
        for i in half..m - half {
            let rows = i - half..i + half + 1;
            let local;
            let weights = if self.uniform {
                &self.weights
            } else {
                local = polynomial_weights(&times[rows.clone()], times[i], self.degree)?;
                &local
            };
            // Relative to the sample itself: the weights of the derivatives sum to zero, and digits are kept.
            for (out, weights) in out.iter_mut().zip(weights) {
                out[i] = weights.iter().zip(&signal[rows.clone()]).map(|(w, x)| w * (x - signal[i])).sum();
            }
            out[0][i] += signal[i];
        }
        Ok(out)
    }

    /// Samples `rows` near an end, from the one polynomial through the window that starts at `start`.
    fn fill_end<const K: usize>(
        &self,
        start: usize,
        rows: Range<usize>,
        times: &[f64],
        signal: &[f64],
        out: &mut [Vec<f64>; K],
    ) -> Result<()> {
        let window = start..start + self.window;
        let centre = times[start + self.window / 2];
        let scale = (times[window.end - 1] - centre).max(centre - times[start]);
        let matrix = DMatrix::from_fn(self.window, self.degree + 1, |i, j| {
            ((times[start + i] - centre) / scale).powi(j as i32)
        });
        let mut right = DVector::from_fn(self.window, |i, _| signal[start + i]);
        let qr = matrix.qr();
        qr.q_tr_mul(&mut right);
        let right = right.rows(0, self.degree + 1).into_owned();
        let mut c =
            qr.r().solve_upper_triangular(&right).ok_or_else(|| singular(self.degree, self.window))?;
        for out in out.iter_mut() {
            for i in rows.clone() {
                let x = (times[i] - centre) / scale;
                out[i] = c.iter().rev().fold(0.0, |sum, c| sum * x + c);
            }
            c = DVector::from_fn(c.len() - 1, |k, _| c[k + 1] * (k + 1) as f64 / scale);
        }
        Ok(())
    }
}

fn singular(degree: usize, window: usize) -> IdentificationError {
    IdentificationError::NotConverged {
        what: "the local polynomial".into(),
        iterations: 0,
        detail: format!("degree {degree} on {window} samples is singular"),
    }
}

/// Weights of the samples in value, slope and curvature at `centre` of the polynomial fitted at `times`.
fn polynomial_weights(times: &[f64], centre: f64, degree: usize) -> Result<[Vec<f64>; 3]> {
    let scale = times.iter().fold(0.0_f64, |a, t| a.max((t - centre).abs()));
    let vandermonde =
        DMatrix::from_fn(times.len(), degree + 1, |i, j| ((times[i] - centre) / scale).powi(j as i32));
    let qr = vandermonde.qr();
    let (q, r) = (qr.q(), qr.r());
    let mut weights = [Vec::new(), Vec::new(), Vec::new()];
    let factors = [1.0, 1.0 / scale, 2.0 / (scale * scale)];
    for (k, weights) in weights.iter_mut().enumerate() {
        // Row k of R⁻¹ Qᵀ: solve Rᵀ z = eₖ, then Q z.
        let unit = DVector::from_fn(degree + 1, |i, _| if i == k { 1.0 } else { 0.0 });
        let z = r.tr_solve_upper_triangular(&unit).ok_or_else(|| singular(degree, times.len()))?;
        *weights = (&q * z * factors[k]).as_slice().to_vec();
    }
    Ok(weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_the_published_ones() {
        // Savitzky and Golay 1964, tables I and III: quadratic, 5 points.
        let times = [-2.0, -1.0, 0.0, 1.0, 2.0];
        let [value, slope, _] = polynomial_weights(&times, 0.0, 2).unwrap();
        for (got, want) in value.iter().zip([-3.0, 12.0, 17.0, 12.0, -3.0]) {
            assert!((got * 35.0 - want).abs() < 1e-12);
        }
        for (got, want) in slope.iter().zip([-2.0, -1.0, 0.0, 1.0, 2.0]) {
            assert!((got * 10.0 - want).abs() < 1e-12);
        }
    }

    #[test]
    fn polynomials_of_the_degree_are_exact_also_at_the_ends_and_with_jitter() {
        for jitter in [0.0, 0.003] {
            let times: Vec<f64> =
                (0..60).map(|i| 0.02 * f64::from(i) + jitter * f64::from(i * 7 % 3)).collect();
            let signal: Vec<f64> = times.iter().map(|t| 1.0 - 2.0 * t + 3.0 * t.powi(4)).collect();
            let d = SavitzkyGolay::with_window(11, 4).differentiate(&times, &signal).unwrap();
            for (i, t) in times.iter().enumerate() {
                assert!((d.first[i] - (12.0 * t.powi(3) - 2.0)).abs() < 1e-8);
                assert!((d.second[i] - 36.0 * t * t).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn windows_out_of_range_are_refused() {
        let times: Vec<f64> = (0..9).map(f64::from).collect();
        let message =
            |w, d| SavitzkyGolay::with_window(w, d).differentiate(&times, &times).unwrap_err().to_string();
        assert_eq!(message(4, 2), "window = 4 is not possible: it must be odd and at least 3");
        assert_eq!(message(11, 2), "differentiation needs at least 11 samples, there are 9");
        assert_eq!(message(5, 1), "degree = 1 is not possible: it must lie between 2 and 8");
    }
}
