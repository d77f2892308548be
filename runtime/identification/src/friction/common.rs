//! Covariance of a law's coefficients from the common estimate: errors of the rigid body and of the delay are in the torques
//! that the law is fitted to, and no residual shows them.
//!
//! The common estimate has friction terms F of its own with the covariance C. A law has other terms Θ, and is fitted to torques with
//! the same errors: its coefficients have the covariance `P C Pᵀ`, and `P = (ΘᵀWΘ)⁻¹ ΘᵀW F` is the same least-squares fit; for a
//! nonlinear law, Θ contains its derivatives. If the law
//! has the terms of the estimate, P is one. Changes of the estimate without the samples near stops move the law by P in the same way.

use super::super::error::Result;
use super::super::methods::confidence::quantile;
use super::super::result::CONFIDENCE;
use super::errors::{Errors, rescaled};
use super::task::CommonTerms;
use nalgebra::{DMatrix, DVector};

impl Errors {
    /// Errors that count what the residuals do not show: the covariance of the common estimate if it is the larger one, and the
    /// changes of this and of the law itself without the samples near rests and reversals.
    ///
    /// - `common`: the common estimate, and P; `changes`: of the law itself
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
