//! Constant-jerk Kalman smoother (Rauch, Tung, Striebel 1965), in which white noise drives the derivative of the jerk.
//!
//! The state is (x, ẋ, ẍ, x⃛) with `x⃜ = w`, where w is white noise with the spectral density q. x is measured with the
//! variance σ². The forward pass filters, and the backward pass smooths. Internally, the unit of time is the mean sampling
//! step, so that covariances are well scaled.

use gelenk_identification::methods::differentiation::Derivatives;
use gelenk_identification::{IdentificationError, Result};
use nalgebra::{Matrix4, Vector4};
use std::ops::Range;

/// Settings of the method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KalmanSmoother {
    /// Standard deviation σ of the measurement noise, in the unit of the signal.
    pub sigma: f64,
    /// Spectral density q of the noise of the derivative of the jerk [unit² s⁻⁷]. `None` selects the smallest q for which the rms
    /// of the residual does not exceed σ (discrepancy principle).
    pub density: Option<f64>,
}

impl KalmanSmoother {
    /// Settings with the noise σ, for which q is selected automatically.
    pub fn from_noise(sigma: f64) -> Self {
        Self { sigma, density: None }
    }

    /// Returns the smoothed signal and its derivatives at the sampling times (s).
    ///
    /// # Errors
    /// An error for fewer than eight samples, or for settings out of range.
    pub fn differentiate(&self, times: &[f64], signal: &[f64]) -> Result<Derivatives> {
        require(self.sigma > 0.0, "noise σ", self.sigma)?;
        require(times.len() == signal.len() && signal.len() >= 8, "number of samples", signal.len() as f64)?;
        let m = times.len();
        let step = (times[m - 1] - times[0]) / (m - 1) as f64;
        // The density is divided by σ² and converted to steps: unit² s⁻⁷ · step⁷ / σ².
        let unit = self.sigma * self.sigma / step.powi(7);
        let ratio = match self.density {
            Some(q) => {
                require(q > 0.0, "spectral density", q)?;
                q / unit
            }
            None => ratio_by_discrepancy(times, signal, self.sigma, step)?,
        };
        let filter = Filter::new(times, signal, self.sigma, step, ratio);
        let states = filter.smooth()?;
        let scaled = |k: usize| -> Vec<f64> {
            states.iter().map(|s| s[k] * self.sigma / step.powi(k as i32)).collect()
        };
        let value: Vec<f64> = scaled(0).iter().map(|x| x + filter.offset).collect();
        Ok(Derivatives {
            first: scaled(1),
            second: scaled(2),
            residual: rms(value.iter().zip(signal).map(|(a, b)| a - b)),
            value,
            parameter: ratio * unit,
        })
    }
}

/// The ratio q/σ² per step by the discrepancy principle. The residual decreases as q grows.
fn ratio_by_discrepancy(times: &[f64], signal: &[f64], sigma: f64, step: f64) -> Result<f64> {
    let explains = |exponent: f64| -> Result<bool> {
        let squares = |times: &[f64], signal: &[f64]| {
            let filter = Filter::new(times, signal, sigma, step, 10f64.powf(exponent));
            let states = filter.smooth()?;
            Ok(states.iter().enumerate().map(|(i, state)| (filter.measurement(i) - state[0]).powi(2)).sum())
        };
        let (residual, count) = judged_residual(times, signal, squares)?;
        // Two standard errors of a sample's rms above the noise.
        Ok(residual <= (1.0 + 2.0 * (2.0 / count as f64).sqrt()).sqrt())
    };
    // At 1e-20 the smoothing window has some hundreds of samples. For smaller values, double precision is not sufficient.
    let (mut least, mut largest) = (-20.0, 8.0);
    if explains(least)? {
        largest = least;
    }
    while largest - least > 0.05 {
        let middle = 0.5 * (largest + least);
        if explains(middle)? { largest = middle } else { least = middle }
    }
    Ok(10f64.powf(largest))
}

fn require(holds: bool, name: &str, value: f64) -> Result<()> {
    let requirement = "it must be positive, and of eight samples or more".into();
    if holds { Ok(()) } else { Err(IdentificationError::Setting { name: name.into(), value, requirement }) }
}

fn rms(differences: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = differences.len() as f64;
    (differences.map(|d| d * d).sum::<f64>() / count).sqrt()
}

/// Rms of the residuals over the rows that are used to choose a regularization, and the number of these rows.
///
/// - `squares`: sum of the squared residuals of a signal at its times
fn judged_residual(
    times: &[f64],
    signal: &[f64],
    squares: impl Fn(&[f64], &[f64]) -> Result<f64>,
) -> Result<(f64, usize)> {
    let (mut sum, mut count) = (0.0, 0);
    for rows in judged_windows(times.len()) {
        count += rows.len();
        sum += squares(&times[rows.clone()], &signal[rows])?;
    }
    Ok(((sum / count as f64).sqrt(), count))
}

/// Rows that are used to choose a regularization: all rows, or four windows of 5000 rows that are evenly spread over a longer
/// signal.
fn judged_windows(samples: usize) -> Vec<Range<usize>> {
    const WINDOWS: usize = 4;
    const SIZE: usize = 5_000;
    if samples <= WINDOWS * SIZE {
        return std::iter::once(0..samples).collect();
    }
    let spacing = (samples - SIZE) / (WINDOWS - 1);
    (0..WINDOWS).map(|k| k * spacing..k * spacing + SIZE).collect()
}

/// Filter with the signal in units of σ and the time in units of the mean step.
struct Filter<'a> {
    times: &'a [f64],
    signal: &'a [f64],
    sigma: f64,
    step: f64,
    ratio: f64,
    offset: f64,
    uniform: bool,
}

/// Gain, covariance after the update, and covariance after the prediction before it.
#[derive(Clone, Copy)]
struct Step {
    gain: Vector4<f64>,
    filtered: Matrix4<f64>,
    predicted: Matrix4<f64>,
}

impl<'a> Filter<'a> {
    fn new(times: &'a [f64], signal: &'a [f64], sigma: f64, step: f64, ratio: f64) -> Self {
        let uniform = times.windows(2).all(|t| (t[1] - t[0] - step).abs() <= 1e-6 * step);
        Self { times, signal, sigma, step, ratio, offset: signal[0], uniform }
    }

    fn measurement(&self, i: usize) -> f64 {
        (self.signal[i] - self.offset) / self.sigma
    }

    fn interval(&self, i: usize) -> f64 {
        if self.uniform { 1.0 } else { (self.times[i] - self.times[i - 1]) / self.step }
    }

    /// Covariance of a wide prior, in which no derivative per step exceeds the range of the signal.
    fn prior(&self) -> Matrix4<f64> {
        let range = (0..self.signal.len()).map(|i| self.measurement(i).abs()).fold(1.0, f64::max);
        Matrix4::from_diagonal_element(range * range)
    }

    /// Runs the filter, and passes state and covariances of each step to `visit`.
    fn run(&self, mut visit: impl FnMut(&Step, &Vector4<f64>)) {
        let mut x = Vector4::zeros();
        let mut step = update(self.prior());
        let (mut f, mut q) = transition(1.0, self.ratio);
        let mut steady = false;
        for i in 0..self.signal.len() {
            if i > 0 {
                if !self.uniform {
                    (f, q) = transition(self.interval(i), self.ratio);
                }
                x = f * x;
                if !steady {
                    let next = update(f * step.filtered * f.transpose() + q);
                    steady = self.uniform && unchanged(&step.filtered, &next.filtered);
                    step = next;
                }
            }
            x += step.gain * (self.measurement(i) - x[0]);
            visit(&step, &x);
        }
    }

    fn smooth(&self) -> Result<Vec<Vector4<f64>>> {
        let mut states = Vec::with_capacity(self.signal.len());
        // If the covariances do not change any more, one entry is used for all later samples.
        let mut steps: Vec<Step> = Vec::new();
        self.run(|step, x| {
            states.push(*x);
            if !self.uniform || steps.last().is_none_or(|last| last.filtered != step.filtered) {
                steps.push(*step);
            }
        });
        let mut gain = Matrix4::<f64>::zeros();
        let mut known = usize::MAX;
        let (mut f, _) = transition(1.0, self.ratio);
        for i in (0..states.len() - 1).rev() {
            let (now, next) = (i.min(steps.len() - 1), (i + 1).min(steps.len() - 1));
            if !self.uniform {
                (f, _) = transition(self.interval(i + 1), self.ratio);
            }
            if known != now || !self.uniform {
                gain = smoother_gain(&steps[now].filtered, &f, &steps[next].predicted)?;
                // The first steady sample differs from its successor only by rounding.
                known = now;
            }
            let correction = gain * (states[i + 1] - f * states[i]);
            states[i] += correction;
        }
        Ok(states)
    }
}

fn unchanged(a: &Matrix4<f64>, b: &Matrix4<f64>) -> bool {
    (0..4).all(|i| (0..4).all(|j| (a[(i, j)] - b[(i, j)]).abs() <= 1e-12 * (b[(i, i)] * b[(j, j)]).sqrt()))
}

/// Measurement update with unit variance. Joseph's form keeps the covariance positive.
fn update(predicted: Matrix4<f64>) -> Step {
    let variance = predicted[(0, 0)] + 1.0;
    let gain = predicted.column(0) / variance;
    let mut keep = Matrix4::<f64>::identity();
    for i in 0..4 {
        keep[(i, 0)] -= gain[i];
    }
    let filtered = keep * predicted * keep.transpose() + gain * gain.transpose();
    Step { gain, filtered: (filtered + filtered.transpose()) * 0.5, predicted }
}

/// `F = exp(A h)` and `Q = ∫ F(s) e₄ e₄ᵀ F(s)ᵀ ds · ratio`.
fn transition(h: f64, ratio: f64) -> (Matrix4<f64>, Matrix4<f64>) {
    const FACTORIAL: [f64; 4] = [1.0, 1.0, 2.0, 6.0];
    let f = Matrix4::from_fn(|i, j| if j >= i { h.powi((j - i) as i32) / FACTORIAL[j - i] } else { 0.0 });
    let q = Matrix4::from_fn(|i, j| {
        let power = 7 - i - j;
        ratio * h.powi(power as i32) / (power as f64 * FACTORIAL[3 - i] * FACTORIAL[3 - j])
    });
    (f, q)
}

/// Smoother gain `P Fᵀ (P⁻)⁻¹`, computed by a Cholesky factorization of the scaled matrix.
fn smoother_gain(
    filtered: &Matrix4<f64>,
    f: &Matrix4<f64>,
    predicted: &Matrix4<f64>,
) -> Result<Matrix4<f64>> {
    let d = predicted.diagonal().map(|p| 1.0 / p.sqrt());
    let scale = Matrix4::from_diagonal(&d);
    let scaled = scale * predicted * scale;
    let factor = scaled.cholesky().ok_or_else(|| IdentificationError::NotConverged {
        what: "the Kalman smoother".into(),
        iterations: 0,
        detail: "the predicted covariance is not positive definite; raise the spectral density".into(),
    })?;
    let right = scale * f * filtered;
    Ok((scale * factor.solve(&right)).transpose())
}

#[cfg(test)]
mod tests {
    use super::super::central_differences;
    use super::super::random::SplitMix64;
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// Solution of the smoothing problem as one dense weighted least-squares problem over all states.
    fn by_dense_least_squares(filter: &Filter) -> Vec<f64> {
        let m = filter.signal.len();
        let mut information = DMatrix::<f64>::zeros(4 * m, 4 * m);
        let mut right = DVector::<f64>::zeros(4 * m);
        let prior = filter.prior().try_inverse().unwrap();
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
            information[(i, j)] += prior[(i, j)];
        }
        for i in 0..m {
            information[(4 * i, 4 * i)] += 1.0;
            right[4 * i] += filter.measurement(i);
            if i > 0 {
                let (f, q) = transition(filter.interval(i), filter.ratio);
                let w = q.try_inverse().unwrap();
                let mut c = DMatrix::zeros(4, 8);
                c.view_mut((0, 0), (4, 4)).copy_from(&-f);
                c.view_mut((0, 4), (4, 4)).fill_with_identity();
                let add = c.transpose() * w * &c;
                let mut block = information.view_mut((4 * (i - 1), 4 * (i - 1)), (8, 8));
                block += add;
            }
        }
        information.cholesky().unwrap().solve(&right).as_slice().to_vec()
    }

    #[test]
    fn agrees_with_dense_least_squares() {
        for jitter in [0.0, 0.3] {
            let mut random = SplitMix64::new(9);
            let times: Vec<f64> = (0..40).map(|i| 0.1 * (f64::from(i) + jitter * random.uniform())).collect();
            let signal: Vec<f64> = times.iter().map(|t| t.sin() + 0.1 * random.normal()).collect();
            let step = (times[39] - times[0]) / 39.0;
            let filter = Filter::new(&times, &signal, 0.1, step, 1e-2);
            let smoothed = filter.smooth().unwrap();
            let dense = by_dense_least_squares(&filter);
            for (i, s) in smoothed.iter().enumerate() {
                for k in 0..4 {
                    assert!((s[k] - dense[4 * i + k]).abs() < 1e-6, "{i} {k}: {} {}", s[k], dense[4 * i + k]);
                }
            }
        }
    }

    /// The error is ten times smaller than that of central differences, for a chirp up to 2.1 Hz with 1 % noise over the inner 90 %.
    #[test]
    fn a_noisy_chirp_is_differentiated() {
        let mut random = SplitMix64::new(1);
        let times: Vec<f64> = (0..2000).map(|i| 0.01 * f64::from(i)).collect();
        let phase = |t: f64| std::f64::consts::TAU * (0.1 * t + 0.05 * t * t);
        let signal: Vec<f64> = times.iter().map(|t| phase(*t).sin() + 0.01 * random.normal()).collect();
        let truth: Vec<f64> =
            times.iter().map(|t| std::f64::consts::TAU * (0.1 + 0.1 * t) * phase(*t).cos()).collect();
        let error = |found: &[f64]| rms((100..1900).map(|i| found[i] - truth[i]));
        let central = error(&central_differences(&times, &signal));
        let found = error(&KalmanSmoother::from_noise(0.01).differentiate(&times, &signal).unwrap().first);
        assert!(central > 10.0 * found, "{central} {found}");
    }

    #[test]
    fn the_steady_gain_changes_nothing() {
        let mut random = SplitMix64::new(10);
        let times: Vec<f64> = (0..3000).map(|i| 0.01 * f64::from(i)).collect();
        // The same times with small deviations, so that the covariances are not treated as steady.
        let uneven: Vec<f64> = times.iter().enumerate().map(|(i, t)| t + 1e-7 * ((i % 2) as f64)).collect();
        let signal: Vec<f64> = times.iter().map(|t| (3.0 * t).sin() + 0.01 * random.normal()).collect();
        let settings = KalmanSmoother { sigma: 0.01, density: Some(1e4) };
        let fast = settings.differentiate(&times, &signal).unwrap();
        let slow = settings.differentiate(&uneven, &signal).unwrap();
        for i in 0..3000 {
            assert!((fast.first[i] - slow.first[i]).abs() < 1e-3);
        }
    }
}
