//! Bootstrap ensembles: how often is a term chosen, and how much does its coefficient vary?
//!
//! Contiguous blocks of the log are drawn with replacement (block bootstrap, Künsch 1989), which keeps the
//! correlation in time inside a block. A draw adds up moments, so its cost does not depend on the samples.

use super::super::error::{Result, require_setting};
use super::super::numeric::random::SplitMix64;
use super::moments::Moments;
use nalgebra::DVector;

/// Draws as many of `blocks` as there are, `draws` times, and fits each with `fit`: the coefficients of the draws that give a model.
///
/// # Errors
/// Fewer than two blocks, no draws, or no draw that gives a model (the reason of the first is passed on).
pub(crate) fn bootstrap(
    blocks: &[Moments],
    draws: usize,
    seed: u64,
    fit: impl Fn(Moments) -> Result<DVector<f64>>,
) -> Result<Vec<DVector<f64>>> {
    require_setting("number of blocks", blocks.len() as f64, blocks.len() >= 2, "at least two are needed")?;
    require_setting("number of draws", draws as f64, draws >= 1, "at least one is needed")?;
    let mut random = SplitMix64::new(seed);
    let mut drawn =
        || -> Vec<&Moments> { blocks.iter().map(|_| &blocks[random.below(blocks.len())]).collect() };
    let (models, failures): (Vec<_>, Vec<_>) =
        (0..draws).map(|_| Moments::sum(drawn()).and_then(&fit)).partition(Result::is_ok);
    if models.is_empty() {
        return failures.into_iter().collect();
    }
    models.into_iter().collect()
}

/// Share of the models in which each term was chosen.
pub(crate) fn inclusion(models: &[DVector<f64>]) -> Vec<f64> {
    let chosen = |term: usize| models.iter().filter(|model| model[term] != 0.0).count() as f64;
    (0..models[0].len()).map(|term| chosen(term) / models.len() as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::super::least_squares::Reduced;
    use super::super::library::Library;
    use super::super::moments::Samples;
    use super::super::thresholding::Thresholding;
    use super::*;
    use crate::numeric::statistics::quantile;

    /// 2.5 % and 97.5 % quantiles of a coefficient.
    fn interval(models: &[DVector<f64>], term: usize) -> [f64; 2] {
        let mut values: Vec<f64> = models.iter().map(|model| model[term]).collect();
        values.sort_by(f64::total_cmp);
        [0.025, 0.975].map(|share| quantile(&values, share))
    }

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
        assert_eq!(inclusion(&ensemble)[..3], [0.0, 1.0, 1.0]);
        let [of_v, of_tanh] = [1, 2].map(|term| interval(&ensemble, term));
        assert!(of_v[0] < 1.5 && 1.5 < of_v[1] && of_tanh[0] < 0.6 && 0.6 < of_tanh[1]);
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
        let [low, high] = interval(&ensemble, 0);
        let width = high - low;
        assert!((width / (2.0 * 1.96 * 0.01) - 1.0).abs() < 0.1, "{width}");
    }
}
