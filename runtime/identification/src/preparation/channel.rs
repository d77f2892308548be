//! One measured signal, reduced to its informative samples. Repeated values, spikes and missing values are left out.

use super::super::methods::differentiation::quantization_noise;
use super::super::numeric::statistics::{median, quantile};
use super::levels;

/// Samples of a signal that contain information, with their times.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Channel {
    /// Times in s, increasing.
    pub times: Vec<f64>,
    /// Values of the signal at `times`.
    pub values: Vec<f64>,
    /// Mean number of log samples for each new value. It is counted between large changes of the signal. It
    /// is 1 if each sample has a new value, or if there are too few large changes. Repeated values are left
    /// out if this number is above 1.2.
    pub hold: f64,
    /// Smallest change between two samples. It is the resolution if the signal is quantized.
    pub resolution: f64,
    /// Indices of samples that were left out as spikes.
    pub spikes: Vec<usize>,
}

/// Number of decades of magnitudes that are distinguished, from 1e-9 on.
const DECADES: usize = 19;

impl Channel {
    /// Creates the informative samples of a signal. Spikes are removed only from positions.
    pub(crate) fn new(times: &[f64], signal: &[f64], is_position: bool) -> Self {
        let mut rows: Vec<usize> = (0..signal.len()).filter(|i| signal[*i].is_finite()).collect();
        let mut values: Vec<f64> = rows.iter().map(|i| signal[*i]).collect();
        let at: Vec<f64> = rows.iter().map(|i| times[*i]).collect();
        let spikes = if is_position { spikes(&at, &values) } else { Vec::new() };
        let spike_rows: Vec<usize> = spikes.iter().map(|k| rows[*k]).collect();
        for k in spikes.iter().rev() {
            rows.remove(*k);
            values.remove(*k);
        }
        let resolution = smallest_change(&values);
        let hold = hold(&values);
        let kept = if hold > 1.2 { updates(&values, hold) } else { (0..values.len()).collect() };
        let times: Vec<f64> = kept.iter().map(|k| times[rows[*k]]).collect();
        let values: Vec<f64> = kept.iter().map(|k| values[*k]).collect();
        Self { times, values, hold, resolution, spikes: spike_rows }
    }

    /// Returns the median time between informative samples in s; 0 if there are fewer than two.
    pub(crate) fn step(&self) -> f64 {
        median_step(&self.times)
    }

    /// Returns the standard deviation of the noise, or of the rounding error if this is larger. The noise follows from the
    /// median error of cubics through the four neighbours of a sample. The variance of this error is 35/18 times the
    /// variance of white noise.
    pub(crate) fn noise(&self) -> f64 {
        let errors = self.values.windows(5).map(|w| cubic_error(w).abs());
        let noise = median(errors).unwrap_or(0.0) / (0.674_489_75 * (35.0_f64 / 18.0).sqrt());
        noise.max(quantization_noise(self.resolution))
    }

    /// Returns the number of changes of the value per second while the signal moves. Up to about this frequency, the
    /// rounding error is white.
    pub(crate) fn change_rate(&self) -> f64 {
        let moving = self.values.windows(2).filter(|w| w[0] != w[1]).count();
        let windows =
            self.values.windows(2 * levels::REST_WINDOW.get() + 1).step_by(levels::REST_WINDOW.get());
        let (all, at_rest) = windows.fold((0_usize, 0_usize), |(all, rest), w| {
            (all + 1, rest + usize::from(w.iter().all(|x| *x == w[0])))
        });
        let share = 1.0 - at_rest as f64 / all.max(1) as f64;
        let duration = self.times.last().unwrap_or(&0.0) - self.times.first().unwrap_or(&0.0);
        if share * duration > 0.0 { moving as f64 / (share * duration) } else { 0.0 }
    }
}

/// Returns the index of the sample that is nearest to a time.
pub(super) fn nearest(times: &[f64], time: f64) -> usize {
    let after = times.partition_point(|t| *t < time).min(times.len().saturating_sub(1));
    let before = after.saturating_sub(1);
    if time - times[before] < times[after] - time { before } else { after }
}

/// Returns the median of the steps of increasing times; 0 if there are fewer than two times.
pub(super) fn median_step(times: &[f64]) -> f64 {
    let mut steps: Vec<f64> = times.windows(2).map(|t| t[1] - t[0]).collect();
    if steps.is_empty() {
        return 0.0;
    }
    steps.sort_by(f64::total_cmp);
    quantile(&steps, 0.5)
}

/// Returns samples that neither the cubic through their neighbours nor the median of five samples explains.
///
/// The cubic alone would also reject the neighbours of a spike. The median alone would reject the turning points of a
/// motion. The error of a spike exceeds thirty times the noise, which is the rms error of the cubics without the largest 2
/// % of the errors. Samples next to a gap are not tested, because the cubic assumes equal time steps.
fn spikes(times: &[f64], values: &[f64]) -> Vec<usize> {
    let errors: Vec<f64> = values.windows(5).map(|w| cubic_error(w).abs()).collect();
    let mut sorted = errors.clone();
    sorted.sort_by(f64::total_cmp);
    let usual = &sorted[..sorted.len() - sorted.len().div_ceil(50)];
    let rms = (usual.iter().map(|d| d * d).sum::<f64>() / usual.len().max(1) as f64).sqrt();
    let bound = 30.0 * rms.max(smallest_change(values));
    let windows = values.windows(5).zip(&errors).enumerate();
    let longest = 1.5 * 4.0 * median_step(times);
    let stands_out = |i: usize, w: &[f64], e: f64| {
        from_median(w) > bound.max(0.5 * e) && e > bound && times[i + 4] - times[i] < longest
    };
    windows.filter(|(i, (w, e))| stands_out(*i, w, **e)).map(|(i, _)| i + 2).collect()
}

/// Returns the error of the cubic through four samples at the sample between them.
fn cubic_error(w: &[f64]) -> f64 {
    w[2] - (4.0 * (w[1] + w[3]) - w[0] - w[4]) / 6.0
}

fn from_median(window: &[f64]) -> f64 {
    let mut sorted = window.to_vec();
    sorted.sort_by(f64::total_cmp);
    (window[2] - sorted[2]).abs()
}

/// Returns the smallest non-zero difference of neighbouring samples; 0 for a constant signal.
fn smallest_change(values: &[f64]) -> f64 {
    let changes = values.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|d| *d > 0.0);
    let smallest = changes.fold(f64::INFINITY, f64::min);
    if smallest.is_finite() { smallest } else { 0.0 }
}

/// Returns the number of samples for each new value, counted between changes of at least four times the resolution.
///
/// If a coarse signal moves slowly, its repeated values are measurements. If the signal changes by several steps of the
/// resolution, a repeated value only shows that the driver had no new value.
fn hold(values: &[f64]) -> f64 {
    let resolutions = resolutions(values);
    let changes: Vec<usize> = (1..values.len()).filter(|i| values[*i] != values[i - 1]).collect();
    let is_large = |i: usize| {
        let [before, after] = [values[i - 1], values[i]];
        let resolution = resolutions[decade(before)].max(resolutions[decade(after)]);
        (after - before).abs() >= 4.0 * resolution
    };
    let large = changes.windows(2).filter(|pair| pair.iter().all(|i| is_large(*i)));
    let mut lengths: Vec<f64> = large.map(|pair| (pair[1] - pair[0]) as f64).collect();
    // A rest between two motions does not count.
    let most = 3.0 * median(lengths.iter().copied()).unwrap_or(0.0);
    lengths.retain(|length| *length <= most);
    let samples: f64 = lengths.iter().sum();
    // A few large changes may be only the end of a motion.
    let enough = !lengths.is_empty() && 10.0 * samples >= values.len() as f64;
    if enough { samples / lengths.len() as f64 } else { 1.0 }
}

/// Returns the smallest change in each decade of magnitudes. A log with a fixed number of digits is coarser at larger
/// values.
fn resolutions(values: &[f64]) -> [f64; DECADES] {
    let mut smallest = [f64::INFINITY; DECADES];
    for pair in values.windows(2).filter(|w| w[0] != w[1]) {
        let smallest = &mut smallest[decade(pair[0]).max(decade(pair[1]))];
        *smallest = smallest.min((pair[1] - pair[0]).abs());
    }
    smallest
}

fn decade(value: f64) -> usize {
    (value.abs().log10() + 9.0).clamp(0.0, (DECADES - 1) as f64) as usize
}

/// Returns the indices of samples with a changed value. If the value does not change for `1.5 hold` samples because the
/// signal rests, one more sample is kept.
fn updates(values: &[f64], hold: f64) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::new();
    for i in 0..values.len() {
        let changed = i > 0 && values[i] != values[i - 1];
        let due = kept.last().is_none_or(|last| (i - last) as f64 >= 1.5 * hold);
        if changed || due {
            kept.push(i);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::random::SplitMix64;

    fn wave(samples: usize, step: f64) -> (Vec<f64>, Vec<f64>) {
        let times: Vec<f64> = (0..samples).map(|i| step * i as f64).collect();
        let signal = times.iter().map(|t| (2.0 * t).sin()).collect();
        (times, signal)
    }

    #[test]
    fn repeats_of_a_driver_are_dropped_and_those_of_an_encoder_kept() {
        let (times, fine) = wave(4000, 1e-3);
        let held: Vec<f64> = (0..4000).map(|i| fine[i - i % 4]).collect();
        let channel = Channel::new(&times, &held, true);
        assert!((channel.hold - 4.0).abs() < 0.2, "{}", channel.hold);
        assert!((channel.step() - 4e-3).abs() < 1e-9 && channel.times.len() == 1000);
        let coarse: Vec<f64> = fine.iter().map(|y| (y / 6e-3).round() * 6e-3).collect();
        let channel = Channel::new(&times, &coarse, true);
        assert_eq!((channel.hold, channel.times.len()), (1.0, 4000));
        assert!((channel.resolution - 6e-3).abs() < 1e-9);
    }

    /// Efforts that a slower bus transmits: each value is in 25 rows.
    #[test]
    fn long_holds_are_dropped() {
        let (times, fine) = wave(5000, 4e-3);
        let held: Vec<f64> = (0..5000).map(|i| fine[i - i % 25]).collect();
        let channel = Channel::new(&times, &held, false);
        assert!((channel.hold - 25.0).abs() < 0.2 && (channel.step() - 0.1).abs() < 1e-9, "{}", channel.hold);
    }

    #[test]
    fn a_fixed_number_of_digits_is_no_hold() {
        // Five significant digits are 1e-5 below one and 1e-4 above it.
        let (times, fine) = wave(4000, 1e-3);
        let digits = |y: &f64| format!("{:.4e}", 0.1 * y + 1.0).parse::<f64>().unwrap();
        let signal: Vec<f64> = fine.iter().map(digits).collect();
        let channel = Channel::new(&times, &signal, true);
        assert_eq!((channel.hold, channel.times.len()), (1.0, 4000));
    }

    #[test]
    fn noise_is_that_of_the_samples_or_of_their_rounding() {
        let (times, truth) = wave(4000, 1e-3);
        let mut random = SplitMix64::new(5);
        let noisy: Vec<f64> = truth.iter().map(|y| y + 2e-4 * random.normal()).collect();
        let noise = Channel::new(&times, &noisy, true).noise();
        assert!((noise / 2e-4 - 1.0).abs() < 0.1, "{noise}");
        let coarse: Vec<f64> = truth.iter().map(|y| (y / 6e-3).round() * 6e-3).collect();
        let noise = Channel::new(&times, &coarse, true).noise();
        assert!((noise / (6e-3 / 12.0_f64.sqrt()) - 1.0).abs() < 0.1, "{noise}");
    }

    #[test]
    fn spikes_are_taken_out() {
        let (times, mut signal) = wave(1000, 0.01);
        let truth = signal.clone();
        signal[700] += 0.5;
        signal[20] = f64::NAN;
        let channel = Channel::new(&times, &signal, true);
        assert_eq!((channel.spikes.as_slice(), channel.times.len()), (&[700][..], 998));
        let error = |(t, y): (&f64, &f64)| (y - truth[(t / 0.01).round() as usize]).abs();
        assert!(channel.times.iter().zip(&channel.values).all(|pair| error(pair) < 1e-12));
        let none = Channel::new(&times, &truth, true);
        assert!(none.spikes.is_empty() && none.hold == 1.0);
    }
}
