//! Variance of the sum of a correlated series of vectors, with exact small-sample quantiles.
//!
//! The series is projected on K slow cosines. If the spectrum of the series is flat over the frequencies of these cosines,
//! the projections are independent and each has the variance of the sum. Their mean square then estimates this variance with
//! exactly K degrees of freedom (equal-weighted cosines; Müller 2007; Sun 2013; Lazarus, Lewis, Stock, Watson 2018).
//! Therefore Student's t and Fisher's F also hold for short logs. A sum over lags with normal quantiles would give too small
//! intervals there.

use super::levels;
use nalgebra::DMatrix;
use std::f64::consts::PI;

/// Number K of cosines for a series with a length of `correlation_times` correlation times and `blocks` elements.
pub(super) fn count(correlation_times: f64, blocks: usize) -> usize {
    let wanted = levels::COSINES.get() * correlation_times.max(1.0).powf(2.0 / 3.0);
    (wanted as usize).min(blocks / 2)
}

/// Projections of the series on the first K cosines, as columns. The mean of their squares is the variance of the sum.
///
/// - `series`: elements of the series, as columns
pub(super) fn projections(series: &DMatrix<f64>, cosines: usize) -> DMatrix<f64> {
    let blocks = series.ncols();
    let cosine =
        |b: usize, k: usize| 2.0_f64.sqrt() * (PI * (k + 1) as f64 * (b as f64 + 0.5) / blocks as f64).cos();
    series * DMatrix::from_fn(blocks, cosines, cosine)
}

#[cfg(test)]
mod tests {
    use super::super::super::numeric::random::SplitMix64;
    use super::*;

    #[test]
    fn the_variance_of_a_correlated_sum_comes_out_with_its_degrees_of_freedom() {
        let (rho, blocks, trials) = (0.7_f64, 400, 400);
        let mut random = SplitMix64::new(1);
        let cosines = count(blocks as f64 * (1.0 - rho) / (1.0 + rho), blocks);
        let mut rejected = 0;
        let quantile = super::super::super::methods::confidence::quantile(0.9, cosines as f64).unwrap();
        for _ in 0..trials {
            let mut state = random.normal() / (1.0 - rho * rho).sqrt();
            let mut draw = || {
                state = rho * state + random.normal();
                state
            };
            let series = DMatrix::from_fn(1, blocks, |_, _| draw());
            let sum = series.sum();
            let variance = projections(&series, cosines).norm_squared() / cosines as f64;
            rejected += usize::from(sum.abs() > quantile * variance.sqrt());
        }
        // Two standard errors of the share are 0.03; the bias of the method makes it a little more.
        let share = f64::from(rejected as u32) / f64::from(trials);
        assert!((0.07..0.15).contains(&share), "{share}");
    }
}
