//! Covariance of a law's coefficients that follows from the estimate of all joints. The torques to which the law is fitted
//! contain errors of the rigid body and of the delay, which the residuals do not show.
//!
//! The estimate has friction terms F with the covariance C of their coefficients. A law has other terms Θ and is fitted to
//! torques with the same errors. So its coefficients have the covariance `P C Pᵀ`. `P = (ΘᵀWΘ)⁻¹ ΘᵀW F` is the least-squares
//! fit of the law to the terms F, with the weights W of the samples. For a nonlinear law, Θ has the derivatives of the law. If
//! the law has the terms of the estimate, P is the identity. P also maps the change of the estimate if the samples near stops
//! are left out.

use super::super::error::Result;
use super::super::estimation::CommonTerms;
use super::super::methods::confidence::{quantile, rescaled};
use super::super::result::CONFIDENCE;
use super::errors::Errors;
use nalgebra::{DMatrix, DVector};

impl Errors {
    /// Standard errors that include two effects that the residuals do not show. The first is the covariance
    /// of the estimate of all joints, if it is larger. The second is the change of the estimate and of the
    /// law if the samples near rests and reversals are left out.
    ///
    /// - `common`: terms of the estimate of all joints, and the matrix that maps their coefficients to those
    ///   of the law
    /// - `changes`: changes of the law itself
    pub(super) fn with_biases(
        mut self,
        common: Option<(&CommonTerms, DMatrix<f64>)>,
        mut changes: DVector<f64>,
    ) -> Result<Self> {
        let mut errors = vec![[0.0, self.freedom]; changes.len()];
        if let Some((other, map)) = common {
            changes += &map * &other.margins;
            let covariance = &map * &other.covariance * map.transpose();
            let error = |k: usize| [covariance[(k, k)].max(0.0).sqrt(), other.freedom];
            errors = (0..changes.len()).map(error).collect();
        }
        for (k, [error, freedom]) in errors.into_iter().enumerate() {
            let own = [self.standard[k], self.freedom];
            let [error, freedom] = if error > own[0] { [error, freedom] } else { own };
            let distance = changes[k].abs();
            self.standard[k] = distance.hypot(error);
            self.reach[k] = Some(distance + quantile(CONFIDENCE, freedom)? * error);
        }
        self.covariance = rescaled(self.covariance, &self.standard);
        Ok(self)
    }
}
