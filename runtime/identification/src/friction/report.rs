//! Report on the friction law of a joint and on its candidate terms.

use super::super::methods::cross_validation::CrossValidation;
use super::super::methods::subset::SubsetValidation;
use super::super::result::{FrictionResult, FrictionTerm};
use nalgebra::DMatrix;

/// The friction law of a joint, with its candidate terms.
#[derive(Debug, Clone, Default)]
pub struct FrictionReport {
    /// The law with its errors and statistics.
    pub result: FrictionResult,
    /// Candidate terms of the law. These are the terms of the library, without constant terms if offsets are known.
    pub terms: Vec<String>,
    /// Covariance of the law's coefficients for correlated residuals, in the order of the law's terms.
    pub covariance: DMatrix<f64>,
    /// Cross-validated path of the LASSO: laws for decreasing weights λ of the penalty. `None` for other methods.
    pub validation: Option<CrossValidation>,
    /// Pareto table of the choice of terms (error against number of terms); `None` for least squares on all terms and for the
    /// Stribeck law.
    pub subsets: Option<SubsetValidation>,
    /// Probabilities of the candidate terms; `None` for the Stribeck law and for libraries of more than twelve terms.
    pub(crate) probabilities: Option<Vec<f64>>,
    /// Mean squared error over held-out folds, and its standard error; `None` if it is not known.
    pub(super) unseen_error: Option<[f64; 2]>,
    /// Residual of each sample [N·m or N]: friction torque minus law.
    pub residuals: Vec<f64>,
}

/// A candidate term of a friction law, chosen or not, with its coefficient, interval and probability.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate<'a> {
    /// The term as an expression in the velocity v, or the name of a Stribeck parameter.
    pub basis: &'a str,
    /// Coefficient of the term with its errors; `None` if the law does not have the term.
    pub chosen: Option<&'a FrictionTerm>,
    /// Ends of the coefficient's interval at 95 %; `None` if the error is not known.
    pub interval: Option<[f64; 2]>,
    /// Probability that the term belongs to the law: the sum of the probabilities (from BIC) of all subsets of the candidate
    /// terms that contain the term. `None` if it is not known.
    pub probability: Option<f64>,
}

impl FrictionReport {
    /// Returns the terms of the law and its constant, then the candidate terms that were not chosen. Load-dependent friction
    /// is not part of the list.
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
}
