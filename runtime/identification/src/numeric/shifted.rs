//! Interpolation of signals with equally spaced samples.

/// Returns the value and the slope (per sample) at a fractional index, from the cubic through the four nearest samples.
pub(crate) fn shifted(signal: &[f64], index: f64) -> (f64, f64) {
    let i = (index.floor() as usize).clamp(1, signal.len().saturating_sub(3).max(1));
    let x = index - i as f64;
    let [a, b, c, d] = [0, 1, 2, 3].map(|k| signal[(i + k).saturating_sub(1).min(signal.len() - 1)]);
    let (c1, c2) = (c - a / 3.0 - b / 2.0 - d / 6.0, 0.5 * (a + c) - b);
    let c3 = (d - a) / 6.0 + 0.5 * (b - c);
    (b + x * (c1 + x * (c2 + x * c3)), c1 + x * (2.0 * c2 + 3.0 * c3 * x))
}

/// Returns the slope (per sample) at a sample, from the quartic through the sample and its four neighbours. Next to the
/// ends it is the slope of a parabola, at the ends that of the chord to the neighbour.
pub(crate) fn slope(signal: &[f64], sample: usize) -> f64 {
    let last = signal.len().saturating_sub(1);
    let over = |reach: usize| {
        let (before, after) = (sample.saturating_sub(reach), (sample + reach).min(last));
        (signal[after] - signal[before]) / (after - before).max(1) as f64
    };
    if sample < 2 || sample + 2 > last { over(1) } else { (4.0 * over(1) - over(2)) / 3.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shifts_follow_cubics() {
        let cubic = |x: f64| 2.0 - x + 0.5 * x * x - 0.1 * x * x * x;
        let rate = |x: f64| -1.0 + x - 0.3 * x * x;
        let signal: Vec<f64> = (0..10).map(|i| cubic(f64::from(i))).collect();
        for x in [1.0, 2.3, 5.75, 7.9] {
            let (value, found) = shifted(&signal, x);
            assert!((value - cubic(x)).abs() < 1e-12 && (found - rate(x)).abs() < 1e-12, "{x}");
        }
        for i in 2..8 {
            assert!((slope(&signal, i) - rate(i as f64)).abs() < 1e-12, "{i}");
        }
        // At the ends only the chord to the neighbour is available.
        assert!((slope(&signal, 0) - (signal[1] - signal[0])).abs() < 1e-12);
        assert_eq!(slope(&[3.0], 0), 0.0);
    }
}
