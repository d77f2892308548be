//! Standard errors for samples whose errors are correlated with the errors of neighbouring samples.
//!
//! Residuals of a smoothed log are correlated over tenths of a second, so that standard errors for independent errors would
//! be several times too small. Here the variance of a sum is estimated from sums over overlapping blocks (Meketon,
//! Schmeiser 1984). Asymptotically this is the estimator of Newey and West (1987) whose lag is the length of a block. The
//! length is doubled from one sample up to a twelfth of the data, and the largest variance is used (blocking; Flyvbjerg,
//! Petersen 1989). A lag from the first autocorrelation (Andrews 1991) is too short if white noise hides a slow error,
//! which is often so in logs of robots.

use super::super::error::{Result, require_setting};
use nalgebra::DMatrix;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};
use std::ops::Range;

/// Degrees of freedom above which an expansion about the normal quantile is used. Its first term (Abramowitz and Stegun
/// 26.7.5) has an error below 1e-11 there. statrs does not return for 1e9 degrees of freedom.
const NEARLY_NORMAL: f64 = 1e6;

/// Smallest number of blocks from which a variance is estimated.
const FEWEST_BLOCKS: usize = 12;

/// Statistics of the sum of a correlated series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LongRun {
    /// Variance of the sum of the series.
    pub variance: f64,
    /// Length of the blocks, in samples, that give the variance. Samples at a larger distance are hardly correlated.
    pub block: usize,
    /// Degrees of freedom of the variance.
    pub freedom: f64,
}

impl LongRun {
    /// Estimates the variance of the sum of `series`, whose expectation is zero.
    ///
    /// - `runs`: ranges of samples without interruption. Samples of different runs count as uncorrelated.
    pub(crate) fn of_sum(series: &[f64], runs: &[Range<usize>]) -> Self {
        let samples: usize = runs.iter().map(ExactSizeIterator::len).sum();
        let mut best = Self { variance: 0.0, block: 1, freedom: samples as f64 };
        let mut block = 1;
        while block == 1 || block * FEWEST_BLOCKS <= samples {
            let sums = |rows: &Range<usize>| overlapping(&series[rows.clone()], block);
            let shared = 1.0 - block as f64 / (samples as f64 + 1.0);
            let variance = runs.iter().map(sums).sum::<f64>() / shared;
            if variance > best.variance {
                // Overlapping blocks give 1.5 times as many degrees of freedom as blocks that do not overlap.
                let overlap = if block == 1 { 1.0 } else { 1.5 };
                let freedom = (overlap * samples as f64 / block as f64).max(3.0);
                best = Self { variance, block, freedom };
            }
            block *= 2;
        }
        best
    }

    /// Returns the standard error of the sum.
    pub(crate) fn standard_error(&self) -> f64 {
        self.variance.sqrt()
    }
}

/// Errors of coefficients with correlated scores: the inverse normal matrix ("bread") on both sides of the long-run variance
/// of the scores (White 1980; Newey, West 1987).
pub(crate) struct Correlated {
    pub covariance: DMatrix<f64>,
    pub standard: Vec<f64>,
    /// Variance of each coefficient, as a multiple of its variance for independent errors.
    pub inflation: Vec<f64>,
    pub freedom: f64,
}

impl Correlated {
    /// - `scores`: for each coefficient, the product of column and residual at each sample
    pub(crate) fn new(bread: &DMatrix<f64>, scores: &[Vec<f64>], runs: &[Range<usize>]) -> Self {
        let samples = scores.first().map_or(0, Vec::len);
        let sum = |j: usize, i: usize| (0..scores.len()).map(|k| bread[(j, k)] * scores[k][i]).sum();
        let influence = |j: usize| (0..samples).map(|i| sum(j, i)).collect();
        let influences: Vec<Vec<f64>> = (0..scores.len()).map(influence).collect();
        let sums: Vec<LongRun> = influences.iter().map(|series| LongRun::of_sum(series, runs)).collect();
        let block = sums.iter().map(|sum| sum.block).max().unwrap_or(1);
        let standard: Vec<f64> = sums.iter().map(LongRun::standard_error).collect();
        let independent = influences.iter().map(|series| series.iter().map(|x| x * x).sum::<f64>());
        Self {
            covariance: rescaled(covariance_of_sums(&influences, runs, block), &standard),
            inflation: sums
                .iter()
                .zip(independent)
                .filter(|(_, alone)| *alone > 0.0)
                .map(|(sum, alone)| sum.variance / alone)
                .collect(),
            freedom: sums.iter().map(|sum| sum.freedom).fold(f64::INFINITY, f64::min),
            standard,
        }
    }
}

/// Returns the covariance with the correlations of `raw` and the given standard errors.
pub(crate) fn rescaled(raw: DMatrix<f64>, standard: &[f64]) -> DMatrix<f64> {
    let factor = |i: usize| if raw[(i, i)] > 0.0 { standard[i] / raw[(i, i)].sqrt() } else { 0.0 };
    DMatrix::from_fn(standard.len(), standard.len(), |i, j| raw[(i, j)] * factor(i) * factor(j))
}

/// Returns the two-sided quantile of Student's t distribution for a confidence level.
///
/// # Errors
/// [`IdentificationError::Setting`](super::super::error::IdentificationError::Setting) if the level is outside (0, 1), or
/// if the degrees of freedom are not positive.
pub(crate) fn quantile(level: f64, freedom: f64) -> Result<f64> {
    require_setting("level", level, level > 0.0 && level < 1.0, "it must lie between 0 and 1")?;
    if freedom >= NEARLY_NORMAL {
        let z = Normal::standard().inverse_cdf(0.5 * (1.0 + level));
        return Ok(z + z * (z * z + 1.0) / (4.0 * freedom));
    }
    let distribution =
        StudentsT::new(0.0, 1.0, freedom).map_err(|e| super::super::error::IdentificationError::Setting {
            name: "degrees of freedom".into(),
            value: freedom,
            requirement: e.to_string(),
        })?;
    Ok(distribution.inverse_cdf(0.5 * (1.0 + level)))
}

/// Returns the covariance of the sums of several series, from blocks of one length.
fn covariance_of_sums(series: &[Vec<f64>], runs: &[Range<usize>], block: usize) -> DMatrix<f64> {
    let p = series.len();
    let mut covariance = DMatrix::zeros(p, p);
    for rows in runs {
        let sums: Vec<Vec<f64>> = series.iter().map(|s| block_sums(&s[rows.clone()], block)).collect();
        let share = rows.len() as f64 / (block.min(rows.len()) as f64 * sums[0].len() as f64);
        for i in 0..p {
            for j in 0..=i {
                let product: f64 = sums[i].iter().zip(&sums[j]).map(|(a, b)| a * b).sum();
                covariance[(i, j)] += share * product;
                covariance[(j, i)] = covariance[(i, j)];
            }
        }
    }
    covariance
}

/// Returns the variance of the sum of one run, from its overlapping blocks. A run that is shorter than a block is one
/// block.
fn overlapping(run: &[f64], block: usize) -> f64 {
    let block = block.min(run.len()).max(1);
    let sums = block_sums(run, block);
    let count = sums.len().max(1) as f64;
    run.len() as f64 / (block as f64 * count) * sums.iter().map(|s| s * s).sum::<f64>()
}

fn block_sums(run: &[f64], block: usize) -> Vec<f64> {
    let block = block.min(run.len()).max(1);
    let mut total = 0.0;
    let mut before = Vec::with_capacity(run.len() + 1);
    before.push(0.0);
    before.extend(run.iter().map(|x| {
        total += x;
        total
    }));
    before[block..].iter().zip(&before).map(|(end, start)| end - start).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::random::SplitMix64;

    /// Slow errors of a given correlation in white noise.
    fn series(seed: u64, samples: usize, correlation: f64, white: f64) -> Vec<f64> {
        let mut random = SplitMix64::new(seed);
        let mut slow = random.normal();
        let drive = (1.0 - correlation * correlation).sqrt();
        let mut next = || {
            slow = correlation * slow + drive * random.normal();
            slow + white * random.normal()
        };
        (0..samples).map(|_| next()).collect()
    }

    fn whole(samples: usize) -> [Range<usize>; 1] {
        let whole = 0..samples;
        [whole]
    }

    #[test]
    fn intervals_of_a_mean_cover_as_often_as_they_say() {
        for (correlation, white) in [(0.0, 0.0), (0.9, 0.0), (0.98, 2.0)] {
            let covered = (0..300).filter(|&seed| {
                let x = series(seed, 3000, correlation, white);
                let mean = x.iter().sum::<f64>() / 3000.0;
                let centred: Vec<f64> = x.iter().map(|x| x - mean).collect();
                let found = LongRun::of_sum(&centred, &whole(3000));
                mean.abs() <= quantile(0.9, found.freedom).unwrap() * found.standard_error() / 3000.0
            });
            // 90 % of 300 is 270 ± 5.2; nothing is promised within a few per cent at strong correlation.
            let covered = covered.count();
            assert!((252..=291).contains(&covered), "{correlation} {white}: {covered} of 300");
        }
    }

    #[test]
    fn the_block_is_longer_than_the_correlation() {
        let found = |correlation: f64| -> Vec<LongRun> {
            let one = |seed| LongRun::of_sum(&series(seed, 5000, correlation, 0.0), &whole(5000));
            (0..20).map(one).collect()
        };
        let error = |found: &[LongRun]| {
            let sum: f64 = found.iter().map(|f| (f.variance / 5000.0).sqrt()).sum();
            sum / found.len() as f64
        };
        // The exact variances of the sums are m and m (1 + ρ)/(1 − ρ); the largest of several lengths is above.
        let (white, slow) = (found(0.0), found(0.9));
        assert!((1.0..1.25).contains(&error(&white)), "{}", error(&white));
        assert!((0.95..1.2).contains(&(error(&slow) / 19_f64.sqrt())), "{}", error(&slow));
        assert!(slow.iter().all(|f| f.block > 20));
    }

    #[test]
    fn runs_are_independent_and_short_ones_count_whole() {
        let x: Vec<f64> = (0..40).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let runs: Vec<Range<usize>> = (0..20).map(|k| 2 * k..2 * k + 2).collect();
        // Each run sums to zero: only blocks of one sample have a variance.
        let found = LongRun::of_sum(&x, &runs);
        assert_eq!(found.block, 1);
        let equal = vec![1.0; 40];
        let found = LongRun::of_sum(&equal, &runs);
        assert_eq!(found.block, 2);
        assert!((found.variance * (1.0 - 2.0 / 41.0) - 80.0).abs() < 1e-12);
        let matrix = covariance_of_sums(&[equal.clone(), equal], &runs, 2);
        assert!((matrix[(0, 1)] - 80.0).abs() < 1e-12);
    }

    #[test]
    fn faulty_levels_are_refused() {
        assert!(quantile(1.0, 2.0).unwrap_err().to_string().starts_with("level = 1 is not possible"));
        assert!((quantile(0.95, 1e6).unwrap() - 1.96).abs() < 1e-3);
    }

    /// The normal quantile of 97.5 % is 1.959963984540054 (Abramowitz and Stegun, table 26.6). That of Student's
    /// distribution is from its density, integrated with 30 digits by mpmath.
    #[test]
    fn quantiles_go_over_into_those_of_the_normal_distribution() {
        for freedom in [1e9, 1e15, f64::MAX] {
            assert!((quantile(0.95, freedom).unwrap() - 1.959_963_984_540_054).abs() < 3e-9);
        }
        assert!((quantile(0.95, 1e6).unwrap() - 1.959_966_356_814_107).abs() < 1e-11);
    }
}
