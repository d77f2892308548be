//! Low-pass filter for positions, efforts and columns of the regressor.

use super::super::error::{IdentificationError, Result, require_setting};
use super::super::numeric::kernel::dot;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;
use std::ops::Range;

/// Width s of the Gaussian that smooths the edge of the transfer function, as a share of the bandwidth.
const EDGE: f64 = 0.25;

/// Half length of the kernel, in standard deviations of its Gaussian envelope. At this distance the envelope is `exp(−8) =
/// 3e-4`.
const ENVELOPE: f64 = 4.0;

/// A zero-phase low-pass filter with a kernel of finite length. All signals of a run pass the same filter.
///
/// The kernel is a sinc with a Gaussian envelope: `h(t) = 2 f_c sinc(2 f_c t) exp(−t²/(2 σ²))` with the bandwidth `f_c` and
/// `σ = 2/(π f_c)`. Its transfer function is a rectangle whose edges are smoothed by a Gaussian of width `s = f_c/4`: `H(f)
/// = ½ [erf((f_c + f)/(√2 s)) + erf((f_c − f)/(√2 s))]`. H is 0.98 at `f_c/2`, one half at `f_c`, and 3e-5 at `2 f_c`. The
/// half-power frequency is `0.864 f_c`.
///
/// Filtered derivatives are computed with the derivatives of the kernel, so they are exactly the derivatives of the
/// filtered signal. A correction of the kernel, which changes H by less than 1e-3, makes constants, slopes and parabolas
/// pass unchanged.
///
/// Least squares stays consistent if all columns pass the same linear filter (parallel filtering, Gautier 1997). The filter
/// smooths the steps in measured efforts. Therefore a friction column such as `sign ẏ`, with the velocity ẏ, must also pass
/// the filter (`Filter::apply`).
#[derive(Debug, Clone, PartialEq)]
pub struct Filter {
    bandwidth: f64,
    step: f64,
    taps: Vec<f64>,
    band: Option<Band>,
}

impl Filter {
    /// Creates the filter with `bandwidth` in Hz for samples at equal steps of `step` in s.
    ///
    /// # Errors
    /// [`IdentificationError::Setting`] if the bandwidth or the step is not positive, or if the bandwidth exceeds a quarter
    /// of the sample rate. Above this limit the sampled kernel does not have the stated transfer function.
    pub(crate) fn new(bandwidth: f64, step: f64) -> Result<Self> {
        require_setting("step", step, step > 0.0, "it must be positive")?;
        let most = 0.25 / step;
        let requirement = format!("it must lie between 0 and a quarter of the sample rate, {most} Hz");
        require_setting("bandwidth", bandwidth, bandwidth > 0.0 && bandwidth <= most, &requirement)?;
        let taps = kernel(bandwidth, step, 0, 0.0)?;
        Ok(Self { bandwidth, step, taps, band: None })
    }

    /// Returns this filter in series with the filter `band`.
    pub(crate) fn behind(self, band: Option<Band>) -> Self {
        let Some(band) = band else { return self };
        Self { taps: convolved(&self.taps, &band.taps(self.step)), band: Some(band), ..self }
    }

    /// Returns the low-pass filter of the efforts that is part of this filter; `None` if there is no such part.
    pub(crate) fn band(&self) -> Option<Band> {
        self.band
    }

    /// Returns only the filter `band`, for samples at the same steps.
    pub(crate) fn alone(&self, band: Band) -> Self {
        Self { bandwidth: band.frequency, step: self.step, taps: band.taps(self.step), band: Some(band) }
    }

    /// Returns the half-amplitude frequency f_c in Hz.
    pub(crate) fn bandwidth(&self) -> f64 {
        self.bandwidth
    }

    /// Returns the filtered signal, which has the length of the signal.
    ///
    /// Beyond its ends, the signal is continued by point reflection. Results that are nearer to an end than half the length
    /// of the kernel depend on this continuation.
    pub(crate) fn apply(&self, signal: &[f64]) -> Vec<f64> {
        self.apply_at(signal, 0..signal.len())
    }

    /// Returns the filtered signal at the given samples.
    pub(crate) fn apply_at(&self, signal: &[f64], samples: impl Iterator<Item = usize> + Clone) -> Vec<f64> {
        weighted(signal, &self.taps, samples.map(|i| i as isize))
    }

    /// Returns the number of samples on each side that influence a filtered sample.
    pub(crate) fn half_length(&self) -> usize {
        self.taps.len() / 2
    }
}

/// A zero-phase low-pass filter `H(f) = 1/(1 + (f/f_0)^(2n))`. It is a Butterworth filter of order n that is applied
/// forwards and backwards.
///
/// For n = 1 and up to second order in f, this filter represents every filter whose gain first falls with f².
/// Examples are a mean over the last samples and one pass of a first-order filter. For n = 2 and up to fourth
/// order in f, it represents one pass of a second-order Butterworth filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Band {
    /// Half-amplitude frequency f_0 in Hz.
    pub(crate) frequency: f64,
    /// Order n of the Butterworth filter.
    pub(crate) order: u32,
}

impl Band {
    /// Returns the kernel `h(t) = ω_0/(2n) Σ_k exp(−ω_0 |t| s_k) (s_k cos ω_0 c_k t + c_k sin ω_0 c_k |t|)` at multiples of
    /// `step` in s. Here `ω_0 = 2π f_0`, and s_k and c_k are the sine and cosine of the angles `π (2k + 1)/(2n)`. Constants
    /// pass unchanged.
    pub(crate) fn taps(&self, step: f64) -> Vec<f64> {
        let (omega, n) = (2.0 * PI * self.frequency, f64::from(self.order));
        let parts: Vec<(f64, f64)> =
            (0..self.order).map(|k| (PI * f64::from(2 * k + 1) / (2.0 * n)).sin_cos()).collect();
        let slowest = parts.iter().fold(f64::INFINITY, |least, part| least.min(part.0));
        let half = (0.5 * ENVELOPE * ENVELOPE / (slowest * omega * step)).ceil() as i64;
        let at = |t: f64| -> f64 {
            let part = |(s, c): &(f64, f64)| (-t * s).exp() * (s * (t * c).cos() + c * (t * c).sin());
            parts.iter().map(part).sum()
        };
        let taps: Vec<f64> = (-half..=half).map(|k| at(omega * step * k.abs() as f64)).collect();
        let sum: f64 = taps.iter().sum();
        taps.iter().map(|tap| tap / sum).collect()
    }
}

/// Returns the kernel of two filters in series.
pub(crate) fn convolved(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut all = vec![0.0; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        all[i..i + b.len()].iter_mut().zip(b).for_each(|(sum, y)| *sum += x * y);
    }
    all
}

/// Returns half the length of the kernel in s.
pub(crate) fn reach(bandwidth: f64) -> f64 {
    ENVELOPE * envelope(bandwidth)
}

/// Returns the gain `H(f)` of the filter with `bandwidth` at `frequency`, both in Hz.
pub(crate) fn gain(bandwidth: f64, frequency: f64) -> f64 {
    let edge = |x: f64| statrs::function::erf::erf(x / (2.0_f64.sqrt() * EDGE * bandwidth));
    0.5 * (edge(bandwidth + frequency) + edge(bandwidth - frequency))
}

/// Returns the standard deviation of the Gaussian envelope in s.
fn envelope(bandwidth: f64) -> f64 {
    1.0 / (2.0 * PI * EDGE * bandwidth)
}

/// Returns the taps of the kernel's derivative of `order` 0, 1 or 2. Samples are at `k·step`, and the result is at `shift`,
/// in s.
///
/// Tap `k` belongs to the sample that is `k − half` steps after the result. The taps are reversed as in a convolution.
///
/// # Errors
/// [`IdentificationError::TooFewSamples`] if there are fewer taps than corrected moments.
pub(crate) fn kernel(bandwidth: f64, step: f64, order: usize, shift: f64) -> Result<Vec<f64>> {
    let half = (reach(bandwidth) / step).ceil() as usize;
    let times: Vec<f64> = (0..=2 * half).map(|k| (k as f64 - half as f64) * step + shift).collect();
    let deviation = envelope(bandwidth);
    let mut taps: Vec<f64> = times.iter().map(|t| step * impulse(bandwidth, deviation, order, *t)).collect();
    correct_moments(&mut taps, &times, deviation, order)?;
    Ok(taps)
}

/// Returns the derivative of order 0, 1 or 2 of `s(t) g(t)`, with `s = sin(w t)/(π t)` and `g = exp(−t²/(2 σ²))`.
fn impulse(bandwidth: f64, deviation: f64, order: usize, t: f64) -> f64 {
    let [s0, s1, s2] = sinc(2.0 * PI * bandwidth, t);
    let variance = deviation * deviation;
    let g0 = (-0.5 * t * t / variance).exp();
    let g1 = -t / variance * g0;
    let g2 = (t * t / variance - 1.0) / variance * g0;
    match order {
        0 => s0 * g0,
        1 => s1 * g0 + s0 * g1,
        _ => s2 * g0 + 2.0 * s1 * g1 + s0 * g2,
    }
}

/// Returns `sin(w t)/(π t)` and its first two derivatives. Near zero they are computed from the series, because the
/// fractions cancel.
fn sinc(w: f64, t: f64) -> [f64; 3] {
    let x = w * t;
    if x.abs() < 1e-2 {
        let x2 = x * x;
        let value = 1.0 - x2 / 6.0 + x2 * x2 / 120.0;
        let first = x * (-1.0 / 3.0 + x2 / 30.0);
        let second = -1.0 / 3.0 + x2 / 10.0;
        return [value * w / PI, first * w * w / PI, second * w * w * w / PI];
    }
    let (s, c) = x.sin_cos();
    let value = s / (PI * t);
    let first = (w * c / PI - value) / t;
    let second = (-w * w * s / PI - 2.0 * first) / t;
    [value, first, second]
}

/// Adds a small parabola times the envelope to the taps. After that the kernel maps 1, t and t² exactly to their
/// derivatives of this order.
fn correct_moments(taps: &mut [f64], times: &[f64], deviation: f64, order: usize) -> Result<()> {
    let weight = |t: f64| (-0.5 * t * t / (deviation * deviation)).exp();
    let powers = |t: f64| Vector3::new(1.0, t / deviation, (t / deviation).powi(2));
    let (mut gram, mut moments) = (Matrix3::zeros(), Vector3::zeros());
    for (tap, t) in taps.iter().zip(times) {
        gram += weight(*t) * powers(*t) * powers(*t).transpose();
        moments += *tap * powers(*t);
    }
    // For a result at 0, the weight of the sample at −t is h(t). Hence ∫ h⁽ᵏ⁾(t) (−t)ᵏ dt = k!.
    let wanted = [1.0, -1.0 / deviation, 2.0 / (deviation * deviation)][order];
    moments[order] -= wanted;
    let correction = gram.cholesky().ok_or_else(|| IdentificationError::TooFewSamples {
        what: "the filter's kernel".into(),
        needed: 3,
        got: taps.len(),
    })?;
    let coefficients = correction.solve(&moments);
    for (tap, t) in taps.iter_mut().zip(times) {
        *tap -= weight(*t) * powers(*t).dot(&coefficients);
    }
    Ok(())
}

/// Returns `Σ taps[k] · signal[centre + half − k]` at each centre.
///
/// Beyond its ends, the signal is continued by point reflection. Still farther outside, the last reflected value is
/// repeated.
pub(crate) fn weighted(
    signal: &[f64],
    taps: &[f64],
    centres: impl Iterator<Item = isize> + Clone,
) -> Vec<f64> {
    let half = (taps.len() / 2) as isize;
    let (Some(least), Some(most)) = (centres.clone().min(), centres.clone().max()) else { return Vec::new() };
    let signal = continued(signal, least - half..most + half + 1);
    let taps: Vec<f64> = taps.iter().rev().copied().collect();
    centres.map(|centre| dot(&signal[(centre - least) as usize..][..taps.len()], &taps)).collect()
}

/// Returns samples of a signal that is continued beyond its ends.
fn continued(signal: &[f64], samples: Range<isize>) -> Vec<f64> {
    let last = signal.len() as isize - 1;
    let value = |k: isize| signal[k.clamp(0, last) as usize];
    let before = (samples.start..samples.end.min(0)).map(|i| 2.0 * value(0) - value(-i));
    let [first, end] = [samples.start, samples.end].map(|i| i.clamp(0, last + 1) as usize);
    let after = (samples.start.max(last + 1)..samples.end).map(|i| 2.0 * value(last) - value(2 * last - i));
    before.chain(signal[first..end].iter().copied()).chain(after).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Computes the response of a derivative's kernel at a frequency by direct summation.
    fn response(bandwidth: f64, step: f64, order: usize, shift: f64, frequency: f64) -> f64 {
        let taps = kernel(bandwidth, step, order, shift).unwrap();
        let half = (taps.len() / 2) as f64;
        let w = 2.0 * PI * frequency;
        let wave = |k: usize| {
            let t = -(k as f64 - half) * step - shift;
            // The phase of the derivative: cos, sin, −cos.
            if order == 1 { (w * t).sin() } else { (w * t).cos() }
        };
        taps.iter().enumerate().map(|(k, tap)| tap * wave(k)).sum()
    }

    #[test]
    fn kernels_have_the_stated_transfer_function() {
        for step in [1e-3, 0.02] {
            for shift in [0.0, 0.3 * step] {
                for frequency in [0.1, 1.0, 2.0, 4.0, 6.0, 10.0] {
                    let w = 2.0 * PI * frequency;
                    let stated = gain(4.0, frequency);
                    let at = |order| response(4.0, step, order, shift, frequency);
                    assert!((at(0) - stated).abs() < 1e-3, "{step} {frequency}: {} {stated}", at(0));
                    assert!((at(1) / w - stated).abs() < 3e-3, "{step} {frequency}: {}", at(1) / w);
                    assert!((-at(2) / (w * w) - stated).abs() < 3e-3, "{step} {frequency} {}", at(2));
                }
            }
        }
        assert!((gain(4.0, 4.0) - 0.5).abs() < 1e-6 && gain(4.0, 8.0) < 1e-4);
    }

    #[test]
    fn parabolas_pass_unchanged() {
        let filter = Filter::new(2.0, 0.01).unwrap();
        let parabola: Vec<f64> =
            (0..500).map(|i| 0.01 * f64::from(i)).map(|t| 3.0 - t + 2.0 * t * t).collect();
        let filtered = filter.apply(&parabola);
        let whole = (reach(2.0) / 0.01).ceil() as usize;
        for i in whole..500 - whole {
            assert!((filtered[i] - parabola[i]).abs() < 1e-9, "{i}");
        }
        assert!(Filter::new(30.0, 0.01).unwrap_err().to_string().contains("bandwidth = 30 is not possible"));
        assert!(Filter::new(f64::NAN, 0.01).is_err() && Filter::new(1.0, 0.0).is_err());
        assert!(filter.apply(&[]).is_empty());
    }
}
