//! Methods of the paper that `gelenk identify` does not use: a Kalman smoother, and friction torques of a motion.
#![allow(dead_code, reason = "tests outside of the example use a part of it")]

pub mod kalman;
#[path = "../../support/random.rs"]
pub mod random;
pub mod torque;

/// Central differences, one-sided at the ends, as reference for smoothing.
pub fn central_differences(times: &[f64], signal: &[f64]) -> Vec<f64> {
    let last = signal.len() - 1;
    let ends = |i: usize| (i.saturating_sub(1), (i + 1).min(last));
    let slope = |(a, b): (usize, usize)| (signal[b] - signal[a]) / (times[b] - times[a]);
    (0..signal.len()).map(|i| slope(ends(i))).collect()
}
