//! The law of a joint with its candidates.

use super::super::methods::cross_validation::CrossValidation;
use super::super::methods::subset::SubsetValidation;
use super::super::result::{FrictionResult, FrictionTerm};
use nalgebra::DMatrix;

/// The law, and its candidates.
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
    /// Probabilities of the candidate terms; none for the Stribeck law and for libraries of more than twelve terms.
    pub(crate) probabilities: Option<Vec<f64>>,
    /// Mean squared error over folds that were left out, and its standard error.
    pub(super) unseen_error: Option<[f64; 2]>,
    /// Torque minus offset minus law at the samples.
    pub residuals: Vec<f64>,
}

/// A term that a law has, or could have had, with its evidence in the data.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate<'a> {
    /// The term in the velocity v, or the name of a Stribeck parameter.
    pub basis: &'a str,
    /// Its coefficient, if the law has it.
    pub chosen: Option<&'a FrictionTerm>,
    /// Ends of its interval at 95 %, if its error is known.
    pub interval: Option<[f64; 2]>,
    /// Its probability: the weight of all subsets of the candidates that have it.
    pub probability: Option<f64>,
}

impl FrictionReport {
    /// The terms of the law with its constant, then those that were left out. Friction under load is in neither.
    pub fn candidates(&self) -> Vec<Candidate<'_>> {
        let law = self.result.law.coefficients();
        let t = self.result.interval_factor();
        let chosen = law.iter().chain(&self.result.constant).map(|term| Candidate {
            basis: &term.basis,
            chosen: Some(term),
            interval: term.ends(t),
            probability: term.probability,
        });
        let others = self.terms.iter().enumerate();
        let others = others.filter(|(_, basis)| law.iter().all(|term| term.basis != **basis));
        let others = others.map(|(i, basis)| Candidate {
            basis,
            chosen: None,
            interval: None,
            probability: self.probabilities.as_ref().map(|shares| shares[i]),
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
            probabilities: None,
            unseen_error: None,
            residuals,
        }
    }
}
