//! Bootstrap ensembles: how often is a term chosen, and how much does its coefficient vary?
//!
//! Contiguous blocks of the log are drawn with replacement (block bootstrap, Künsch 1989), which keeps the
//! correlation in time inside a block. A draw adds up moments, so its cost does not depend on the samples.

use super::super::error::{IdentificationError, Result, require_setting};
use super::super::numeric::random::SplitMix64;
use super::super::numeric::statistics::quantile;
use super::moments::Moments;
use nalgebra::DVector;

/// Result of a bootstrap: statistics of each term over its draws.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ensemble {
    /// Share of the draws in which a term was chosen.
    pub inclusion: Vec<f64>,
    /// Median coefficient over all draws, zero where not chosen.
    pub median: Vec<f64>,
    /// 2.5 % and 97.5 % quantiles of the coefficient.
    pub interval: Vec<[f64; 2]>,
    /// Draws that gave a model.
    pub draws: usize,
    /// Draws without a model (all terms removed, collinear), with the first reason.
    pub failed: usize,
    /// Why the first failed draw failed.
    pub first_failure: Option<String>,
}

/// Draws as many of `blocks` as there are, `draws` times, and fits each with `fit`.
///
/// # Errors
/// Fewer than two blocks, no draws, or no draw that gives a model (the reason of the first is passed on).
pub(crate) fn bootstrap(
    blocks: &[Moments],
    draws: usize,
    seed: u64,
    fit: impl Fn(Moments) -> Result<DVector<f64>>,
) -> Result<Ensemble> {
    require_setting("number of blocks", blocks.len() as f64, blocks.len() >= 2, "at least two are needed")?;
    require_setting("number of draws", draws as f64, draws >= 1, "at least one is needed")?;
    let mut random = SplitMix64::new(seed);
    let mut models = Vec::with_capacity(draws);
    let mut failures: Vec<IdentificationError> = Vec::new();
    for _ in 0..draws {
        let drawn: Vec<&Moments> = blocks.iter().map(|_| &blocks[random.below(blocks.len())]).collect();
        match Moments::sum(drawn).and_then(&fit) {
            Ok(coefficients) => models.push(coefficients),
            Err(error) => failures.push(error),
        }
    }
    if models.is_empty() {
        return Err(failures.swap_remove(0));
    }
    let mut ensemble = summarize(&models);
    ensemble.failed = failures.len();
    ensemble.first_failure = failures.first().map(ToString::to_string);
    Ok(ensemble)
}

fn summarize(models: &[DVector<f64>]) -> Ensemble {
    let count = models.len() as f64;
    let mut ensemble = Ensemble {
        inclusion: Vec::new(),
        median: Vec::new(),
        interval: Vec::new(),
        draws: models.len(),
        failed: 0,
        first_failure: None,
    };
    for i in 0..models[0].len() {
        let mut values: Vec<f64> = models.iter().map(|m| m[i]).collect();
        values.sort_by(f64::total_cmp);
        ensemble.inclusion.push(values.iter().filter(|x| **x != 0.0).count() as f64 / count);
        ensemble.median.push(quantile(&values, 0.5));
        ensemble.interval.push([quantile(&values, 0.025), quantile(&values, 0.975)]);
    }
    ensemble
}

#[cfg(test)]
mod tests {
    use super::super::least_squares::Reduced;
    use super::super::library::Library;
    use super::super::moments::Samples;
    use super::super::thresholding::Thresholding;
    use super::*;

    #[test]
    fn true_terms_are_always_chosen_and_intervals_cover_them() {
        let mut random = SplitMix64::new(21);
        let v: Vec<f64> = (0..5000).map(|_| 2.0 * random.uniform() - 1.0).collect();
        let y: Vec<f64> =
            v.iter().map(|v| 1.5 * v + 0.6 * (5.0 * v).tanh() + 0.3 * random.normal()).collect();
        let library = Library::new(&["1", "v", "tanh(5*v)", "v*abs(v)"], &["v"]).unwrap();
        let samples = Samples::from_library(&library, vec![&v], vec![&y]).unwrap();
        let blocks = Moments::blocks(&samples, 100).unwrap();
        let settings = Thresholding { threshold: 0.2, ..Default::default() };
        let fit = |m: Moments| Ok(settings.fit(&Reduced::from_moments(m)?, 0)?.coefficients);
        let ensemble = bootstrap(&blocks, 200, 1, fit).unwrap();
        assert_eq!((ensemble.inclusion[1], ensemble.inclusion[2], ensemble.inclusion[0]), (1.0, 1.0, 0.0));
        assert!(ensemble.interval[1][0] < 1.5 && 1.5 < ensemble.interval[1][1]);
        assert!(ensemble.interval[2][0] < 0.6 && 0.6 < ensemble.interval[2][1]);
        assert_eq!(ensemble, bootstrap(&blocks, 200, 1, fit).unwrap());
        let strict = Thresholding { threshold: 99.0, ..settings };
        let failing = |m: Moments| Ok(strict.fit(&Reduced::from_moments(m)?, 0)?.coefficients);
        assert!(bootstrap(&blocks, 3, 1, failing).unwrap_err().to_string().contains("removes every term"));
    }

    #[test]
    fn spread_matches_the_standard_error_of_a_mean() {
        let mut random = SplitMix64::new(8);
        let one = vec![1.0; 10_000];
        let y: Vec<f64> = one.iter().map(|_| 2.0 + random.normal()).collect();
        let names = vec!["1".to_string()];
        let samples = Samples::from_columns(&names, vec![&one], vec![&y]).unwrap();
        let blocks = Moments::blocks(&samples, 500).unwrap();
        let fit = |m: Moments| Reduced::from_moments(m)?.solve(0, &[0], 0.0);
        let ensemble = bootstrap(&blocks, 2000, 5, fit).unwrap();
        let width = ensemble.interval[0][1] - ensemble.interval[0][0];
        assert!((width / (2.0 * 1.96 * 0.01) - 1.0).abs() < 0.1, "{width}");
    }
}
