//! Choice of the bandwidth of the smoothing filter from the positions. All signals have the same bandwidth.

use super::super::methods::filter::gain;
use super::levels;
use super::spectrum::Spectrum;
use std::f64::consts::PI;

/// Quality of a joint's measured positions.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PositionQuality {
    /// Spectrum of the position, pooled over all runs.
    pub spectrum: Spectrum,
    /// Spectral density of the white noise of the position, in unit²/Hz. The unit is rad or m.
    pub density: f64,
    /// Standard deviation σ of the noise of a sample, in rad or m.
    pub noise: f64,
    /// Whether the joint moves by more than ten times its noise.
    pub moves: bool,
}

/// Returns candidate bandwidths from `lowest` to `highest` in Hz, with `per_octave` candidates in each octave. The last one
/// is `highest`.
pub(super) fn candidates(lowest: f64, highest: f64, per_octave: f64) -> Vec<f64> {
    let count = ((highest / lowest).log2() * per_octave).floor().max(0.0) as usize;
    (0..=count).map(|k| highest * 2.0_f64.powf(-((count - k) as f64) / per_octave)).collect()
}

/// Returns two mean square errors of the filtered acceleration of a joint, as shares of the power of the acceleration: the
/// lost part of the signal, and the remaining part of the noise.
///
/// The errors are `Σ (1 − H)² S / Σ S` and `Σ H² N / Σ S`, with sums over the bands of the spectrum. S is the power of the
/// signal and N the power of the noise, both of accelerations (ω⁴ times the power of positions). H is the gain of the
/// filter.
pub(super) fn relative_errors(quality: &PositionQuality, bandwidth: f64) -> [f64; 2] {
    let [all, lost, _, left] = filtered(quality, bandwidth);
    if all > 0.0 { [lost / all, left / all] } else { [1.0, 1.0] }
}

/// Power of a joint's acceleration: of the signal, the part of it that a filter removes, the part that passes the filter, and
/// the noise that passes.
fn filtered(quality: &PositionQuality, bandwidth: f64) -> [f64; 4] {
    let mut sums = [0.0; 4];
    for (frequency, signal, noise) in quality.spectrum.accelerations(quality.density) {
        let h = gain(bandwidth, frequency);
        let parts = [signal, (1.0 - h).powi(2) * signal, h * h * signal, h * h * noise];
        sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
    }
    sums
}

/// Returns the share of noise in the power of a filtered acceleration.
pub(super) fn noise_share(quality: &PositionQuality, bandwidth: f64) -> f64 {
    let [_, _, passed, left] = filtered(quality, bandwidth);
    left / (left + passed).max(f64::MIN_POSITIVE)
}

/// Returns the standard deviation of the noise of a filtered speed.
///
/// - `density`: spectral density of the white noise of the positions, in unit²/Hz
///
/// The formula follows from `∫ (2π f)² H² df = (2π)² f_c³/3` for a filter whose gain H has a sharp edge at
/// the frequency f_c.
pub(super) fn speed_noise(density: f64, bandwidth: f64) -> f64 {
    2.0 * PI * (density * bandwidth.powi(3) / 3.0).sqrt()
}

/// Returns the largest bandwidth whose error exceeds the smallest error by at most the tolerance. The error is the mean of
/// [`relative_errors`] over the moving joints, and the error of a joint counts at most 1.
///
/// The result is `None` if no joint moves.
pub(super) fn from_positions(joints: &[&PositionQuality], lowest: f64, highest: f64) -> Option<f64> {
    let moving: Vec<_> = joints.iter().filter(|q| q.moves).collect();
    let mean = |f: &f64| {
        moving.iter().map(|q| relative_errors(q, *f).iter().sum::<f64>().min(1.0)).sum::<f64>()
            / moving.len() as f64
    };
    if moving.is_empty() {
        return None;
    }
    let tried = candidates(lowest, highest, levels::BANDWIDTHS_PER_OCTAVE.get());
    let errors: Vec<f64> = tried.iter().map(mean).collect();
    let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
    errors.iter().rposition(|e| *e <= least + levels::EQUAL_BANDWIDTHS.get()).map(|k| tried[k])
}

#[cfg(test)]
mod tests {
    use super::super::super::numeric::random::SplitMix64;
    use super::*;

    fn quality(frequency: f64, sigma: f64, seed: u64) -> PositionQuality {
        let mut random = SplitMix64::new(seed);
        let w = 2.0 * PI * frequency;
        let positions: Vec<f64> =
            (0..20_000).map(|i| (w * 1e-3 * f64::from(i)).sin() + sigma * random.normal()).collect();
        let mut spectrum = Spectrum::new();
        spectrum.add(&positions, 1e-3);
        let density = spectrum.floor(400.0);
        PositionQuality { spectrum, density, noise: sigma, moves: true }
    }

    #[test]
    fn motion_passes_and_noise_does_not() {
        for (frequency, sigma) in [(0.3, 1e-5), (1.0, 1e-4), (3.0, 1e-3), (10.0, 1e-4)] {
            let quality = quality(frequency, sigma, 8);
            let bandwidth = from_positions(&[&quality], 0.2, 200.0).unwrap();
            assert!(bandwidth > 1.3 * frequency, "{frequency} {bandwidth}");
            assert!(relative_errors(&quality, bandwidth).iter().sum::<f64>() < 0.02);
            assert!(noise_share(&quality, bandwidth) < 2e-3);
        }
    }

    #[test]
    fn the_fastest_joint_is_not_smoothed_away() {
        let joints = [quality(0.3, 1e-5, 1), quality(5.0, 1e-5, 2)];
        let bandwidth = from_positions(&[&joints[0], &joints[1]], 0.2, 200.0).unwrap();
        assert!(bandwidth > 6.0, "{bandwidth}");
        let rest = PositionQuality { moves: false, ..joints[1].clone() };
        assert_eq!(from_positions(&[&rest], 0.2, 200.0), None);
    }
}
