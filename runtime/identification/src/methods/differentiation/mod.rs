//! First and second derivatives of a sampled signal with noise and quantization.
//!
//! Total-variation regularization suits signals whose acceleration jumps ([`TotalVariation`]). It has one free parameter,
//! which is given or follows from the noise of the encoder.

mod banded;
mod total_variation;

pub use total_variation::{Regularization, TotalVariation};

use super::super::error::{Place, Result, require_finite, require_length, require_samples, require_setting};

/// A smoothed signal and its derivatives at the sampling times.
#[derive(Debug, Clone, PartialEq)]
pub struct Derivatives {
    /// Smoothed signal, in its unit.
    pub value: Vec<f64>,
    /// First derivative, in the unit of the signal per second.
    pub first: Vec<f64>,
    /// Second derivative, in the unit of the signal per second squared.
    pub second: Vec<f64>,
    /// Root mean square of the signal minus the smoothed signal, in the unit of the signal.
    pub residual: f64,
    /// Weight γ of the regularization ([`TotalVariation`]).
    pub parameter: f64,
}

/// Returns the standard deviation of the rounding error of an encoder, `Δ/√12` for the resolution Δ.
///
/// The formula holds if the signal moves by more than Δ between samples. A slower signal has correlated rounding errors.
pub fn quantization_noise(resolution: f64) -> f64 {
    resolution / 12.0_f64.sqrt()
}

/// Fails if lengths differ, if there are too few samples, if a value is not finite, or if the times do not increase.
///
/// # Errors
/// The error of the first condition that is violated
fn require_signal(times: &[f64], signal: &[f64], needed: usize) -> Result<()> {
    require_samples("differentiation", needed, signal.len())?;
    require_length("times of the signal", signal.len(), times.len())?;
    require_finite("time", times)?;
    require_finite("the signal", signal)?;
    match times.windows(2).position(|w| w[1] <= w[0]) {
        None => Ok(()),
        Some(i) => Err(Place::default().fault(format!(
            "the time does not increase at sample {} (counted from 0): {} s is followed by {} s. Sort the rows or split the log \
             into segments",
            i + 1,
            times[i],
            times[i + 1]
        ))),
    }
}

/// Returns the root mean square of a difference.
fn rms_difference(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

/// Returns the number nearest to `beyond` at which noise still explains the residual (discrepancy principle;
/// Morozov 1966). The number is found by bisection, up to `width`.
///
/// - `explained`: a number at which noise explains the residual
///
/// # Errors
/// The errors are those of `explains`.
fn by_discrepancy(
    mut explained: f64,
    mut beyond: f64,
    width: f64,
    mut explains: impl FnMut(f64) -> Result<bool>,
) -> Result<f64> {
    while (beyond - explained).abs() > width {
        let middle = 0.5 * (explained + beyond);
        if explains(middle)? { explained = middle } else { beyond = middle }
    }
    Ok(explained)
}

/// Returns the largest rms residual that noise with the standard deviation σ explains in n samples. It is σ plus two
/// standard errors of the rms, `σ √(1 + 2 √(2/n))`.
///
/// Without this margin, a log whose noise happens to be slightly above σ would hardly be smoothed.
fn residual_bound(sigma: f64, samples: usize) -> f64 {
    sigma * (1.0 + 2.0 * (2.0 / samples as f64).sqrt()).sqrt()
}

/// Fails if a noise is not positive and finite.
///
/// # Errors
/// [`IdentificationError::Setting`](crate::error::IdentificationError::Setting)
fn require_noise(sigma: f64) -> Result<()> {
    require_setting(
        "noise σ",
        sigma,
        sigma > 0.0,
        "it must be positive. The noise of an encoder is its resolution divided by √12",
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::random::SplitMix64;

    pub(super) fn chirp(seed: u64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let mut random = SplitMix64::new(seed);
        let times: Vec<f64> = (0..2000).map(|i| f64::from(i) * 0.01).collect();
        let phase = |t: f64| 2.0 * std::f64::consts::PI * (0.1 * t + 0.05 * t * t);
        let signal = times.iter().map(|&t| phase(t).sin() + 0.01 * random.normal()).collect();
        let rate = |t: f64| 2.0 * std::f64::consts::PI * (0.1 + 0.1 * t);
        let first = times.iter().map(|&t| rate(t) * phase(t).cos()).collect();
        (times, signal, first)
    }

    /// Central differences, one-sided at the ends: the reference that smoothing must beat.
    fn central_differences(times: &[f64], signal: &[f64]) -> Vec<f64> {
        let last = signal.len() - 1;
        let ends = |i: usize| (i.saturating_sub(1), (i + 1).min(last));
        let slope = |(a, b): (usize, usize)| (signal[b] - signal[a]) / (times[b] - times[a]);
        (0..signal.len()).map(|i| slope(ends(i))).collect()
    }

    /// Error over the inner 90 %, relative to the derivative's rms there.
    fn inner_error(estimate: &[f64], truth: &[f64]) -> f64 {
        let inner = truth.len() / 20..truth.len() - truth.len() / 20;
        let zero = vec![0.0; inner.len()];
        rms_difference(&estimate[inner.clone()], &truth[inner.clone()]) / rms_difference(&truth[inner], &zero)
    }

    #[test]
    fn total_variation_beats_central_differences_on_a_noisy_chirp() {
        for seed in 1..=20 {
            let (times, signal, truth) = chirp(seed);
            let central = inner_error(&central_differences(&times, &signal), &truth);
            let found = TotalVariation::from_noise(0.01).differentiate(&times, &signal).unwrap();
            let error = inner_error(&found.first, &truth);
            println!(
                "seed {seed}: central {central:.4}, total variation {error:.4} (γ {:.3e})",
                found.parameter
            );
            assert!(central >= 5.0 * error, "{seed}: {central} {error}");
        }
    }

    #[test]
    fn bad_signals_are_refused_with_numbers() {
        let ok = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        let message = |t: &[f64], x: &[f64]| {
            TotalVariation::with_gamma(1.0).differentiate(t, x).unwrap_err().to_string()
        };
        assert!(message(&[], &[]).contains("empty"));
        assert!(message(&[0.0], &[1.0]).contains("needs at least 4 samples, but there are 1"));
        assert!(
            message(&[0.0, 1.0, 1.0, 2.0], &ok[..4])
                .contains("at sample 2 (counted from 0): 1 s is followed by 1 s")
        );
        assert!(message(&ok, &[0.0, 1.0, f64::NAN, 1.0, 1.0, 1.0]).contains("not finite (NaN) at row 2"));
        assert!(message(&ok, &ok[..5]).contains("5 are expected, but 6 are given"));
        let negative = TotalVariation::from_noise(-1.0).differentiate(&ok, &ok).unwrap_err().to_string();
        assert!(negative.contains("noise σ = -1 is not possible"));
    }

    #[test]
    fn constant_and_straight_signals_have_constant_derivatives() {
        let times: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.02).collect();
        for slope in [0.0, -3.5] {
            let signal: Vec<f64> = times.iter().map(|t| 7.0 + slope * t).collect();
            let d = TotalVariation::from_noise(1e-4).differentiate(&times, &signal).unwrap();
            let is_straight = |i: usize| (d.first[i] - slope).abs() < 1e-3 && d.second[i].abs() < 1e-2;
            assert!((0..200).all(is_straight), "{} {:?}", d.parameter, d.first);
        }
    }
}
