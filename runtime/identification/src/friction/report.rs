//! The law of a joint with what it was chosen from.

use super::super::error::Result;
use super::super::methods::confidence::quantile;
use super::super::methods::cross_validation::CrossValidation;
use super::super::methods::subset::{ModelAverage, SubsetValidation};
use super::super::result::{FrictionResult, FrictionTerm};
use nalgebra::{DMatrix, DVector};

/// The law, and what it was chosen from.
#[derive(Debug, Clone)]
pub struct FrictionReport {
    /// The law with its numbers.
    pub result: FrictionResult,
    /// Candidate terms of the law: the library's without constants, where offsets are separated.
    pub terms: Vec<String>,
    /// Cosines between the candidate terms, offsets taken off `[p × p]`.
    pub correlation: DMatrix<f64>,
    /// Condition number of the candidate terms, columns scaled.
    pub condition: f64,
    /// Covariance of the law's coefficients, for correlated residuals; rows and columns as in the law.
    pub covariance: DMatrix<f64>,
    /// Cross-validated path, for the LASSO.
    pub validation: Option<CrossValidation>,
    /// Pareto table of the choice; none for least squares on all terms and the Stribeck law.
    pub subsets: Option<SubsetValidation>,
    /// Bootstrap; none without draws.
    pub(crate) inclusion: Option<Vec<f64>>,
    /// All subsets of the candidate terms, weighed; none for the Stribeck law and for libraries of more than
    /// twelve terms.
    pub(crate) average: Option<ModelAverage>,
    /// Mean squared error over folds that were left out, and its standard error.
    pub(super) unseen_error: Option<[f64; 2]>,
    /// Torque minus offset minus law at the samples.
    pub residuals: Vec<f64>,
}

/// A term that a law has, or could have had, with what the data say for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate<'a> {
    /// The term in the velocity v, or the name of a Stribeck parameter.
    pub basis: &'a str,
    /// Its coefficient, where the law has it.
    pub chosen: Option<&'a FrictionTerm>,
    /// Share of the bootstrap draws in which it was chosen.
    pub inclusion: Option<f64>,
    /// Its probability: the weight of all subsets of the candidates that have it.
    pub probability: Option<f64>,
}

impl FrictionReport {
    /// The terms of the law with its constant, then those that were left out. Friction under load is in neither.
    pub fn candidates(&self) -> Vec<Candidate<'_>> {
        let law = self.result.law.coefficients();
        let chosen = law.iter().chain(&self.result.constant).map(|term| Candidate {
            basis: &term.basis,
            chosen: Some(term),
            inclusion: term.inclusion,
            probability: term.probability,
        });
        let others = self.terms.iter().enumerate();
        let others = others.filter(|(_, basis)| law.iter().all(|term| term.basis != **basis));
        let others = others.map(|(i, basis)| Candidate {
            basis,
            chosen: None,
            inclusion: self.inclusion.as_ref().map(|shares| shares[i]),
            probability: self.average.as_ref().map(|average| average.inclusion[i]),
        });
        chosen.chain(others).collect()
    }

    /// A report of nothing but the law.
    pub(super) fn alone(result: FrictionResult, residuals: Vec<f64>) -> Self {
        Self {
            result,
            terms: Vec::new(),
            correlation: DMatrix::zeros(0, 0),
            condition: f64::NAN,
            covariance: DMatrix::zeros(0, 0),
            validation: None,
            subsets: None,
            inclusion: None,
            average: None,
            unseen_error: None,
            residuals,
        }
    }

    /// Half the width of the law's confidence band at `velocities`, at `level` (e.g. 0.95).
    ///
    /// # Errors
    /// A level outside (0, 1), or no samples.
    pub fn band(&self, velocities: &[f64], level: f64) -> Result<Vec<f64>> {
        let t = quantile(level, self.result.freedom)?;
        let gradients = self.result.law.gradients(velocities)?;
        let width = |row: DVector<f64>| t * row.dot(&(&self.covariance * &row)).max(0.0).sqrt();
        Ok(gradients.row_iter().map(|row| width(row.transpose())).collect())
    }
}
