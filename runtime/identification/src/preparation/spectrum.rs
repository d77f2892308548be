//! Power spectrum of positions and of their noise, for all runs together.

use super::levels;
use std::f64::consts::PI;

/// Lower edge of the first band in Hz.
const LOWEST: f64 = 0.02;

/// Number of bands. The last one ends at 84 kHz.
const BANDS: usize = 132;

/// Measured power in bands of a sixth of an octave. Spectral densities are one-sided.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Spectrum {
    bands: Vec<Band>,
}

/// Sums over the frequencies k/T of a band, weighted by the duration T of each piece. P is the spectral density of the
/// position, Δf the distance of the frequencies, and ω = 2π f.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Band {
    /// Number of frequencies (bins) in the band.
    bins: usize,
    /// Power of the positions, `Σ P Δf T` with the spectral density P, the distance Δf of the frequencies,
    /// and the duration T.
    position: f64,
    /// Power of the accelerations, `Σ ω⁴ P Δf T` with the angular frequency ω, the spectral density P of the
    /// position, the distance Δf of the frequencies, and the duration T.
    acceleration: f64,
    /// Power of white noise of the position with density one, `Σ Δf T` with the distance Δf of the
    /// frequencies, and the duration T.
    white: f64,
    /// Power of the acceleration of white noise of the position with density one, `Σ ω⁴ Δf T` with the
    /// angular frequency ω, the distance Δf of the frequencies, and the duration T.
    white_acceleration: f64,
}

impl Spectrum {
    /// Creates a spectrum without data.
    pub(crate) fn new() -> Self {
        Self { bands: vec![Band::default(); BANDS] }
    }

    /// Adds the periodogram of positions at equal time steps.
    ///
    /// - `step`: time step in s
    ///
    /// Second differences are computed before the Hann taper is applied. The power of positions decreases steeply with the
    /// frequency. Without the differences, leakage from low frequencies would cover the high frequencies.
    pub(crate) fn add(&mut self, positions: &[f64], step: f64) {
        let second: Vec<f64> = positions.windows(3).map(|w| w[2] - 2.0 * w[1] + w[0]).collect();
        let m = second.len();
        if m < 8 {
            return;
        }
        let taper = |i: usize| 0.5 - 0.5 * (2.0 * PI * (i as f64 + 0.5) / m as f64).cos();
        let length = m.next_power_of_two();
        let mut tapered: Vec<[f64; 2]> =
            second.iter().enumerate().map(|(i, a)| [a * taper(i), 0.0]).collect();
        tapered.resize(length, [0.0; 2]);
        let transformed = transform(&tapered);
        let (duration, bin) = (m as f64 * step, 1.0 / (length as f64 * step));
        // The mean square of the Hann taper is 3/8.
        let density = 2.0 * step / (0.375 * m as f64);
        for k in 1..length / 2 {
            let frequency = k as f64 * bin;
            let difference = (2.0 * (PI * frequency * step).sin()).powi(4);
            let [re, im] = transformed[k];
            let power = density * (re * re + im * im) / difference;
            self.bands[band(frequency)].add(frequency, power, bin * duration);
        }
    }

    /// Returns the spectral density of the white noise of the positions in unit²/Hz; 0 if there are no data. The density is
    /// the lowest mean over half an octave at or below `highest` in Hz.
    ///
    /// Motion decreases with the frequency, but white noise does not. Therefore the lowest mean is an upper
    /// bound of the noise. It equals the noise if the sampling is fast enough for a band without motion. Half
    /// octaves with less than an eighth of the bins of the fullest half octave are left out. Their means are
    /// inaccurate, and the smallest of many inaccurate means would be too low.
    pub(crate) fn floor(&self, highest: f64) -> f64 {
        let top = band(highest).min(BANDS - 1);
        let sums = |bands: &[Band]| {
            let sum = |of: &dyn Fn(&Band) -> f64| bands.iter().map(of).sum::<f64>();
            (sum(&|b| b.bins as f64), sum(&|b| b.position) / sum(&|b| b.white))
        };
        let means: Vec<(f64, f64)> = self.bands[..top].windows(3).map(sums).collect();
        let fullest = means.iter().map(|m| m.0).fold(0.0, f64::max);
        let trusted = means.iter().filter(|m| m.0 >= (fullest / 8.0).max(1.0)).map(|m| m.1);
        let lowest = trusted.fold(f64::INFINITY, f64::min);
        if lowest.is_finite() { lowest } else { 0.0 }
    }

    /// Returns `(centre frequency, signal, noise)` of each band with data. The frequency is in Hz. The signal is the power
    /// of accelerations without noise. The noise is the power of noise with the density `noise` in unit²/Hz.
    ///
    /// A band contains signal if its power exceeds 1.5 times the noise by four standard errors of the noise's mean. The
    /// signal of other bands is 0. Otherwise their errors, multiplied by ω⁴, would add up over the many bands of a fast
    /// log.
    pub(crate) fn accelerations(&self, noise: f64) -> Vec<(f64, f64, f64)> {
        let used = self.bands.iter().enumerate().filter(|(_, band)| band.bins > 0);
        used.map(|(k, band)| {
            let noise = noise * band.white_acceleration;
            let clear = noise * (1.5 + 4.0 / (band.bins as f64).sqrt());
            let signal = if band.acceleration > clear { band.acceleration - noise } else { 0.0 };
            (centre(k), signal, noise)
        })
        .collect()
    }
}

impl Band {
    fn add(&mut self, frequency: f64, power: f64, measure: f64) {
        let fourth = (2.0 * PI * frequency).powi(4);
        self.bins += 1;
        self.position += power * measure;
        self.acceleration += fourth * power * measure;
        self.white += measure;
        self.white_acceleration += fourth * measure;
    }
}

fn band(frequency: f64) -> usize {
    ((frequency / LOWEST).log2() * levels::BANDS_PER_OCTAVE.get()).clamp(0.0, (BANDS - 1) as f64) as usize
}

fn centre(band: usize) -> f64 {
    LOWEST * 2.0_f64.powf((band as f64 + 0.5) / levels::BANDS_PER_OCTAVE.get())
}

/// Returns the discrete Fourier transform by the radix-2 algorithm (Cooley and Tukey 1965): real and imaginary parts. The
/// length must be a power of two.
fn transform(series: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let half = series.len() / 2;
    if half == 0 {
        return series.to_vec();
    }
    let part = |first: usize| {
        transform(&series[first..].iter().step_by(2).copied().collect::<Vec<_>>()).into_iter().enumerate()
    };
    let turned = part(1).map(|(k, [re, im])| {
        let (s, c) = (-PI * k as f64 / half as f64).sin_cos();
        [re * c - im * s, re * s + im * c]
    });
    let turned: Vec<[f64; 2]> = turned.collect();
    let even: Vec<[f64; 2]> = part(0).map(|(_, value)| value).collect();
    let sums = |sign: f64| even.iter().zip(&turned).map(move |(a, b)| [0, 1].map(|i| a[i] + sign * b[i]));
    sums(1.0).chain(sums(-1.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::super::numeric::random::SplitMix64;
    use super::*;

    #[test]
    fn the_transform_agrees_with_its_definition() {
        let signal: Vec<f64> = (0..16).map(|i| f64::from(i * i % 7)).collect();
        let found = transform(&signal.iter().map(|x| [*x, 0.0]).collect::<Vec<_>>());
        for k in 0..16 {
            let angle = |i: usize| -2.0 * PI * (i * k) as f64 / 16.0;
            let c: f64 = signal.iter().enumerate().map(|(i, x)| x * angle(i).cos()).sum();
            let s: f64 = signal.iter().enumerate().map(|(i, x)| x * angle(i).sin()).sum();
            assert!((found[k][0] - c).abs() < 1e-12 && (found[k][1] - s).abs() < 1e-12, "{k}");
        }
    }

    #[test]
    fn noise_under_a_motion_and_the_motions_acceleration_are_found() {
        let (step, sigma) = (0.002, 1e-4);
        let mut random = SplitMix64::new(5);
        let w = 2.0 * PI;
        let positions: Vec<f64> =
            (0..10_000).map(|i| (w * step * f64::from(i)).sin() + sigma * random.normal()).collect();
        let mut spectrum = Spectrum::new();
        spectrum.add(&positions, step);
        // White noise of variance σ² over 250 Hz.
        let noise = spectrum.floor(200.0);
        assert!((noise / (sigma * sigma / 250.0) - 1.0).abs() < 0.2, "{noise}");
        let energy: f64 =
            spectrum.accelerations(noise).iter().filter(|band| band.0 < 5.0).map(|band| band.1).sum();
        assert!((energy / 20.0 / (0.5 * w.powi(4)) - 1.0).abs() < 0.05, "{energy}");
        assert_eq!(Spectrum::new().floor(100.0), 0.0);
    }
}
