//! Standard errors of coefficients with correlated residuals ([`Correlated`]).

use super::super::error::Result;
use super::super::estimation::CommonTerms;
use super::super::methods::confidence::{Correlated, LongRun};
use super::super::methods::least_squares::{Reduced, triangular_factor};
use super::super::methods::library::Library;
use super::super::methods::margin::change;
use super::super::methods::moments::{Moments, Samples};
use super::super::numeric::spectrum;
use super::super::numeric::statistics::median;
use super::super::result::FrictionTerm;
use super::design::runs;
use super::task::FrictionData;
use nalgebra::{DMatrix, DVector};
use std::borrow::Cow;

/// Standard errors of the coefficients of the chosen terms.
pub(super) struct Errors {
    pub(super) covariance: DMatrix<f64>,
    pub(super) standard: Vec<f64>,
    /// Half the width of the interval; `None` if the width follows from the standard error and Student's t
    /// ([`FrictionTerm::reach`]).
    pub(super) reach: Vec<Option<f64>>,
    /// Standard error of each coefficient if all other coefficients were known.
    pub(super) resolution: Vec<f64>,
    pub(super) freedom: f64,
    /// Number of samples with independent errors that would give the same information.
    pub(super) effective_samples: f64,
}

impl Errors {
    /// Errors of the coefficients for correlated residuals.
    ///
    /// - `samples`: columns of the chosen terms, or derivatives of a nonlinear law with respect to its parameters
    /// - `binding`: rows of active constraints. The combinations of coefficients that they fix count as known.
    pub(super) fn of_samples(
        data: &FrictionData,
        samples: &Samples,
        binding: &DMatrix<f64>,
        residuals: &[f64],
    ) -> Result<Self> {
        let (columns, runs) = (samples.terms(), runs(data));
        let root = triangular_factor(samples).view((0, 0), (columns.len(), columns.len())).into_owned();
        let bread = inverse_on_face(root, binding);
        let scores: Vec<Vec<f64>> = columns.iter().map(|column| products(column, residuals)).collect();
        let errors = Correlated::new(&bread, &scores, &runs);
        let alone = |(column, score): (&Cow<[f64]>, &Vec<f64>)| {
            LongRun::of_sum(score, &runs).standard_error() / sum(&products(column, column))
        };
        let found = Self {
            covariance: errors.covariance,
            standard: errors.standard,
            reach: vec![None; columns.len()],
            resolution: columns.iter().zip(&scores).map(alone).collect(),
            freedom: errors.freedom.min(1e9),
            effective_samples: residuals.len() as f64 / median(errors.inflation).map_or(1.0, |x| x.max(1.0)),
        };
        if data.common.is_none() && data.filtered.is_none() {
            return Ok(found);
        }
        let changes = changes(data, columns, binding, &scores);
        let map = |common: &CommonTerms| -> Result<DMatrix<f64>> {
            let others = data.columns(&Library::new(&common.bases, &["v"])?)?;
            let product = |i: usize, k: usize| sum(&products(&columns[i], &others[k]));
            Ok(&bread * DMatrix::from_fn(columns.len(), others.len(), product))
        };
        let common = data.common.map(|common| map(common).map(|map| (common, map)));
        found.with_biases(common.transpose()?, changes)
    }

    /// Standard errors from the scores of shares, which are independent groups of samples.
    pub(super) fn of_shares(
        reduced: &Reduced,
        shares: &[Moments],
        coefficients: &DVector<f64>,
        active: &[usize],
        binding: &DMatrix<f64>,
    ) -> Self {
        let gram = reduced.moments().gram().select_rows(active).select_columns(active);
        let bread = inverse_on_face(root(&gram), &binding.select_columns(active));
        let count = shares.len() as f64;
        let mut scores = DMatrix::zeros(active.len(), active.len());
        for share in shares {
            let score = (share.projection(0) - share.gram() * coefficients).select_rows(active);
            scores += &score * score.transpose();
        }
        scores *= count / (count - 1.0).max(1.0);
        let covariance = &bread * &scores * &bread;
        let samples = reduced.moments().samples() as f64;
        let variance = reduced.moments().residual(0, coefficients) / samples;
        let all = 0..active.len();
        let inflation = |k: usize| covariance[(k, k)] / (variance * bread[(k, k)]).max(f64::MIN_POSITIVE);
        let median = median(all.clone().map(inflation)).unwrap_or(1.0);
        Self {
            standard: all.clone().map(|k| covariance[(k, k)].max(0.0).sqrt()).collect(),
            reach: vec![None; active.len()],
            resolution: all.map(|k| scores[(k, k)].max(0.0).sqrt() / gram[(k, k)]).collect(),
            freedom: (count - 1.0).max(1.0),
            effective_samples: (samples / median.max(1.0)).max(2.0),
            covariance,
        }
    }

    /// The k-th chosen coefficient as a term with its errors.
    pub(super) fn term(&self, k: usize, basis: &str, coefficient: f64) -> FrictionTerm {
        let known = |error: f64| Some(error).filter(|e| e.is_finite());
        FrictionTerm {
            basis: basis.into(),
            coefficient,
            standard_error: known(self.standard[k]),
            reach: self.reach[k],
            resolution: known(self.resolution[k]),
            ..FrictionTerm::default()
        }
    }
}

fn products(one: &[f64], other: &[f64]) -> Vec<f64> {
    one.iter().zip(other).map(|(x, y)| x * y).collect()
}

fn sum(series: &[f64]) -> f64 {
    series.iter().sum()
}

/// Changes of the coefficients if the samples near rests and reversals are left out, within the subspace that active
/// constraints leave.
///
/// - `scores`: scores of the samples, for each coefficient
fn changes(
    data: &FrictionData,
    columns: &[Cow<[f64]>],
    binding: &DMatrix<f64>,
    scores: &[Vec<f64>],
) -> DVector<f64> {
    let Some(filtered) = data.filtered else { return DVector::zeros(columns.len()) };
    let near = filtered.near();
    let away = |series: &[f64]| series.iter().zip(&near).filter(|(_, near)| !**near).map(|(x, _)| x).sum();
    let face = null_space(binding, columns.len());
    let gram = |part: &dyn Fn(&[f64]) -> f64| {
        let product = |i: usize, k: usize| part(&products(&columns[i], &columns[k]));
        face.tr_mul(&DMatrix::from_fn(columns.len(), columns.len(), product)) * &face
    };
    let left = DVector::from_iterator(columns.len(), scores.iter().map(|series| away(series)));
    &face * change(&gram(&sum), &gram(&away), &face.tr_mul(&left))
}

/// A matrix R with `RᵀR` = G. Combinations of columns that rounding makes indistinguishable from zero are zero in R.
fn root(gram: &DMatrix<f64>) -> DMatrix<f64> {
    let eigen = spectrum::symmetric_eigen(gram.clone());
    let limit = 1e-14 * eigen.eigenvalues.amax();
    let sizes = eigen.eigenvalues.map(|square| if square > limit { square.sqrt() } else { 0.0 });
    DMatrix::from_diagonal(&sizes) * eigen.eigenvectors.transpose()
}

/// `(RᵀR)⁻¹` within the subspace that active constraints leave, by orthogonal factorization.
fn inverse_on_face(root: DMatrix<f64>, binding: &DMatrix<f64>) -> DMatrix<f64> {
    let count = root.ncols();
    let z = null_space(binding, count);
    // Constraints may fix all coefficients.
    let svd = (z.ncols() > 0).then(|| spectrum::svd(root * &z));
    let Some((values, v_t)) = svd.and_then(|svd| Some((svd.singular_values, svd.v_t?))) else {
        return DMatrix::zeros(count, count);
    };
    let limit = 1e-12 * values.amax();
    let inverse = values.map(|s| if s > limit { 1.0 / (s * s) } else { 0.0 });
    let half = z * v_t.transpose();
    &half * DMatrix::from_diagonal(&inverse) * half.transpose()
}

/// Orthonormal columns that span the null space of the rows.
fn null_space(rows: &DMatrix<f64>, count: usize) -> DMatrix<f64> {
    if rows.nrows() == 0 {
        return DMatrix::identity(count, count);
    }
    let eigen = spectrum::symmetric_eigen(rows.transpose() * rows);
    let limit = 1e-10 * eigen.eigenvalues.amax();
    let kept: Vec<usize> = (0..count).filter(|&i| eigen.eigenvalues[i] <= limit).collect();
    eigen.eigenvectors.select_columns(&kept)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "test code")]

    use super::*;

    /// Equal columns and a column of zeros do not change the error of another column.
    #[test]
    fn the_inverse_of_dependent_columns_is_the_pseudo_inverse() {
        let x = |i: usize| [(0.1 * i as f64).sin(), (0.37 * i as f64).cos(), 0.0];
        let columns = DMatrix::from_fn(50, 4, |i, k| x(i)[[0, 1, 1, 2][k]]);
        let gram = columns.tr_mul(&columns);
        let found = inverse_on_face(root(&gram), &DMatrix::zeros(0, 4));
        let expected = gram.clone().pseudo_inverse(1e-10).unwrap();
        assert!((&found - &expected).amax() < 1e-12 * expected.amax(), "{found}{expected}");
        assert!(found[(0, 0)] > 0.9 / gram[(0, 0)]);
        let held = DMatrix::identity(4, 4).rows(1, 3).into_owned();
        let alone = inverse_on_face(root(&gram), &held);
        assert!((alone[(0, 0)] * gram[(0, 0)] - 1.0).abs() < 1e-12);
    }
}
