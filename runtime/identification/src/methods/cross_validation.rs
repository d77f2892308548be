//! Choice of the LASSO's λ by k-fold cross-validation on contiguous blocks.
//!
//! Folds are contiguous blocks, because neighbouring samples of a log are correlated. With random folds, samples of the
//! test set would have neighbours in the training set.

use super::super::error::{Result, everything_removed, require_length, require_setting};
use super::super::numeric::statistics::{mean_with_error, simplest};
use super::lasso::{Lasso, LassoPath, active_terms};
use super::least_squares::{Reduced, Solution};
use super::moments::{Moments, splits};

/// Solutions of the LASSO for several weights λ of the penalty, with their errors in cross-validation.
#[derive(Debug, Clone, PartialEq)]
pub struct CrossValidation {
    /// Solutions for all samples. λ has the scale of glmnet and scikit-learn.
    pub path: LassoPath,
    /// Mean squared error on the held-out block, averaged over the folds, for each λ.
    pub mean_error: Vec<f64>,
    /// Standard error of [`Self::mean_error`] over the folds, for each λ.
    pub standard_error: Vec<f64>,
    /// Index of the weight λ with the smallest error.
    pub minimum: usize,
    /// Index of the largest weight λ whose error exceeds the smallest error by at most one standard error.
    pub one_standard_error: usize,
}

impl CrossValidation {
    /// Computes the solutions for all weights λ of the penalty, first on all samples, then for each fold on
    /// the samples outside the fold.
    ///
    /// - `folds`: moments of contiguous blocks, see [`Moments::blocks`]
    /// - `target`: index of the target column
    /// - `lambdas`: values of λ, descending
    ///
    /// # Errors
    /// - `Setting`: there are fewer than two folds, or the values of λ do not descend
    /// - The errors of the LASSO for a λ without a solution
    pub fn new(lasso: &Lasso, folds: &[Moments], target: usize, lambdas: &[f64]) -> Result<Self> {
        require_setting("number of folds", folds.len() as f64, folds.len() >= 2, "at least two are needed")?;
        require_setting("number of λ", lambdas.len() as f64, !lambdas.is_empty(), "at least one is needed")?;
        let descending = lambdas.is_sorted_by(|a, b| a >= b);
        require_setting(
            "first λ",
            lambdas[0],
            descending,
            "the values of λ must descend, so that the first models are the simplest",
        )?;
        let mut errors = vec![Vec::with_capacity(folds.len()); lambdas.len()];
        for split in splits(folds) {
            let (training, held_out) = split?;
            let path = lasso.path(&training, target, lambdas)?;
            for (errors, coefficients) in errors.iter_mut().zip(path.coefficients.column_iter()) {
                let residual = held_out.residual(target, &coefficients.into_owned());
                errors.push(residual / held_out.samples() as f64);
            }
        }
        let errors: Vec<[f64; 2]> = errors.iter().map(|errors| mean_with_error(errors)).collect();
        let [minimum, one_standard_error] = simplest(&errors).unwrap_or_default();
        let [mean_error, standard_error] = [0, 1].map(|k| errors.iter().map(|error| error[k]).collect());
        let path = lasso.path(&Moments::sum(folds)?, target, lambdas)?;
        Ok(Self { path, mean_error, standard_error, minimum, one_standard_error })
    }
}

/// Computes the least-squares solution on the terms that the LASSO chose for one value of λ.
///
/// - `path`: solutions of the LASSO
/// - `index`: index of the value of λ in the path
///
/// # Errors
/// - [`Shape`](crate::IdentificationError::Shape) if `index` is outside the path
/// - [`EverythingRemoved`](crate::IdentificationError::EverythingRemoved) if the solution for this λ has no terms
/// - the errors of [`Reduced::fit`]
pub fn refit(reduced: &Reduced, target: usize, path: &LassoPath, index: usize) -> Result<Solution> {
    if index >= path.lambdas.len() {
        require_length("λ of the path", index + 1, path.lambdas.len())?;
    }
    let active = active_terms(&path.coefficients.column(index).into_owned());
    if active.is_empty() {
        let kept = (0..path.lambdas.len()).find(|&k| path.coefficients.column(k).amax() > 0.0);
        let largest = kept.map_or(0.0, |k| path.lambdas[k]);
        return Err(everything_removed("lambda", path.lambdas[index], largest));
    }
    reduced.fit(target, &active)
}

#[cfg(test)]
mod tests {
    use super::super::library::Library;
    use super::super::moments::Samples;
    use super::*;
    use crate::numeric::random::SplitMix64;

    fn friction(m: usize, noise: f64) -> (Vec<f64>, Vec<f64>) {
        let mut random = SplitMix64::new(11);
        let v: Vec<f64> =
            (0..m).map(|i| 1.2 * (0.0021 * i as f64).sin() + 0.4 * (0.013 * i as f64).sin()).collect();
        let y = v.iter().map(|v| 3.0 * v + 0.8 * (10.0 * v).tanh() + noise * random.normal()).collect();
        (v, y)
    }

    #[test]
    fn errors_are_those_of_explicitly_left_out_blocks() {
        let (v, y) = friction(1003, 0.2);
        let library = Library::friction().unwrap();
        let theta = library.matrix(&[&v]).unwrap();
        let samples = Samples::from_library(&library, vec![&v], vec![&y]).unwrap();
        let folds = Moments::blocks(&samples, 5).unwrap();
        let lasso = Lasso::default();
        let grid = lasso.lambda_grid(&Moments::sum(&folds).unwrap(), 0, 12, 1e-3).unwrap();
        let validation = CrossValidation::new(&lasso, &folds, 0, &grid).unwrap();
        // Fold 1 holds rows 201..402: 1003 = 3·201 + 2·200.
        let training = Moments::sum([0, 2, 3, 4].map(|k| &folds[k])).unwrap();
        let w = lasso.path(&training, 0, &grid).unwrap().coefficients;
        let mut direct = [0.0; 12];
        for (k, d) in direct.iter_mut().enumerate() {
            *d = (201..402).map(|i| (y[i] - (theta.row(i) * w.column(k))[0]).powi(2)).sum::<f64>() / 201.0;
        }
        let by_sums: Vec<f64> =
            (0..12).map(|k| folds[1].residual(0, &w.column(k).into_owned()) / 201.0).collect();
        for (a, b) in direct.iter().zip(&by_sums) {
            assert!((a - b).abs() < 1e-12 * a.max(1.0), "{a} {b}");
        }
        assert!(validation.one_standard_error <= validation.minimum);
        let bound = validation.mean_error[validation.minimum] + validation.standard_error[validation.minimum];
        assert!(validation.mean_error[validation.one_standard_error] <= bound);
    }

    #[test]
    fn a_refit_has_the_terms_of_the_path() {
        let (v, y) = friction(4000, 0.05);
        let library = Library::new(&["1", "v", "tanh(10*v)", "v*abs(v)"], &["v"]).unwrap();
        let samples = Samples::from_library(&library, vec![&v], vec![&y]).unwrap();
        let folds = Moments::blocks(&samples, 8).unwrap();
        let reduced = Reduced::new(&samples).unwrap();
        let lasso = Lasso::default();
        let grid = lasso.lambda_grid(reduced.moments(), 0, 40, 1e-4).unwrap();
        let validation = CrossValidation::new(&lasso, &folds, 0, &grid).unwrap();
        let fit = refit(&reduced, 0, &validation.path, validation.one_standard_error).unwrap();
        assert!(fit.active.contains(&1) && fit.active.contains(&2), "{:?}", fit.active);
        assert!((fit.coefficients[1] - 3.0).abs() < 0.02);
        let empty = refit(&reduced, 0, &validation.path, 0).unwrap_err().to_string();
        assert!(empty.contains("removes every term"), "{empty}");
    }
}
