//! LASSO for a sequence of weights λ of the penalty, by coordinate descent on the Gram matrix (Friedman, Hastie, Tibshirani
//! 2010).
//!
//! Every λ in this crate follows the convention of glmnet and scikit-learn: `min 1/(2N) ‖y − Θ ξ‖² + λ Σ ωᵢ |ξᵢ|` over the
//! coefficients ξ, with the target y, the matrix Θ of the terms, N samples and the penalty weights ωᵢ. In the form
//! `‖y − Θ ξ‖² + λ' ‖ξ‖₁` the value is `λ' = 2 N λ` (`paper_lambda`).

mod descent;
#[cfg(test)]
mod tests;

use super::super::error::{Result, everything_removed, require_setting};
use super::moments::Moments;
use descent::{Problem, State};
use nalgebra::{DMatrix, DVector};

/// Converts the weight λ of `1/(2N) ‖y − Θ ξ‖² + λ ‖ξ‖₁` to the weight λ' of `‖y − Θ ξ‖² + λ' ‖ξ‖₁`, for N
/// samples of the target y and the terms Θ with the coefficients ξ.
pub(crate) fn paper_lambda(lambda: f64, samples: usize) -> f64 {
    2.0 * samples as f64 * lambda
}

/// Settings of the LASSO.
#[derive(Debug, Clone, PartialEq)]
pub struct Lasso {
    /// Whether the penalty weight ωᵢ of a term is the root mean square of the term's column instead of 1.
    pub standardize: bool,
    /// Duality gap at which the iteration ends, as a share of `‖y‖²/(2N)` for N samples of the target y.
    pub tolerance: f64,
    /// Largest number of sweeps over all terms for each λ.
    pub max_sweeps: usize,
}

impl Default for Lasso {
    fn default() -> Self {
        Self { standardize: false, tolerance: 1e-10, max_sweeps: 100_000 }
    }
}

/// Solutions of the LASSO for a sequence of weights λ of the penalty.
#[derive(Debug, Clone, PartialEq)]
pub struct LassoPath {
    /// Weights λ of the penalty, descending.
    pub lambdas: Vec<f64>,
    /// Coefficients ξ of the terms: one row for each term, one column for each λ.
    pub coefficients: DMatrix<f64>,
    /// Duality gap of each solution: an upper bound of its objective minus the smallest objective.
    pub gaps: Vec<f64>,
}

impl Lasso {
    /// Returns the smallest λ at which every coefficient is zero.
    ///
    /// # Errors
    /// - `ZeroColumn`: the target or a term is zero
    /// - `Setting`, `Shape`: a setting is out of its range
    pub(crate) fn largest_lambda(&self, moments: &Moments, target: usize) -> Result<f64> {
        let problem = Problem::new(self, moments, target)?;
        let bound = |j: usize| problem.b[j].abs() / (problem.samples * problem.weights[j]);
        // A few units in the last place are added, so that rounding does not leave a non-zero coefficient at this λ.
        Ok((0..problem.b.len()).map(bound).fold(0.0, f64::max) * (1.0 + 4.0 * f64::EPSILON))
    }

    /// Returns `count` values of λ in a geometric sequence. The first one is the smallest λ that removes every term, the
    /// last one is `ratio` times as large.
    ///
    /// - `target`: index of the target column
    ///
    /// # Errors
    /// [`Setting`](crate::IdentificationError::Setting) if `ratio` is outside (0, 1) or `count` is below 2, and
    /// [`ZeroColumn`](crate::IdentificationError::ZeroColumn) if the target or a term is zero.
    pub fn lambda_grid(
        &self,
        moments: &Moments,
        target: usize,
        count: usize,
        ratio: f64,
    ) -> Result<Vec<f64>> {
        require_setting("ratio of λ", ratio, ratio > 0.0 && ratio < 1.0, "it must lie between 0 and 1")?;
        require_setting("number of λ", count as f64, count >= 2, "at least two are needed")?;
        let largest = self.largest_lambda(moments, target)?;
        let step = |i: usize| largest * ratio.powf(i as f64 / (count - 1) as f64);
        Ok((0..count).map(step).collect())
    }

    /// Computes the solution for each λ. Each solution is the start of the iteration for the next λ.
    ///
    /// # Errors
    /// - `Setting`: a λ is negative or NaN
    /// - `ZeroColumn`: the target or a term is zero
    /// - `NotConverged`: a duality gap stays above the tolerance
    pub(crate) fn path(&self, moments: &Moments, target: usize, lambdas: &[f64]) -> Result<LassoPath> {
        let problem = Problem::new(self, moments, target)?;
        let mut path = LassoPath {
            lambdas: lambdas.to_vec(),
            coefficients: DMatrix::zeros(moments.terms(), lambdas.len()),
            gaps: Vec::with_capacity(lambdas.len()),
        };
        let mut state = State::new(&problem);
        for (column, &lambda) in lambdas.iter().enumerate() {
            require_setting("λ", lambda, lambda >= 0.0, "it must be finite and not negative")?;
            path.gaps.push(problem.solve(lambda, &mut state, self)?);
            path.coefficients.set_column(column, &state.w);
        }
        Ok(path)
    }

    /// Returns the coefficients and the chosen terms for one λ.
    ///
    /// # Errors
    /// [`EverythingRemoved`](crate::IdentificationError::EverythingRemoved) with the largest λ that keeps a term, if no
    /// term is chosen. The other errors are those of [`Self::path`].
    pub(crate) fn fit(
        &self,
        moments: &Moments,
        target: usize,
        lambda: f64,
    ) -> Result<(DVector<f64>, Vec<usize>)> {
        let path = self.path(moments, target, &[lambda])?;
        let coefficients = path.coefficients.column(0).into_owned();
        let active = active_terms(&coefficients);
        if active.is_empty() {
            return Err(everything_removed("lambda", lambda, self.largest_lambda(moments, target)?));
        }
        Ok((coefficients, active))
    }
}

/// Returns the indices of the coefficients that are not zero.
pub(crate) fn active_terms(coefficients: &DVector<f64>) -> Vec<usize> {
    (0..coefficients.len()).filter(|&i| coefficients[i] != 0.0).collect()
}
