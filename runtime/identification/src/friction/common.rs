//! Covariance of a law's coefficients from the common estimate. Errors of the rigid body and of the delay are contained in
//! the torques to which the law is fitted, and no residual shows them.
//!
//! The common estimate has friction terms F of its own, with the covariance C of their coefficients. A law has other terms Θ
//! and is fitted to torques with the same errors. So its coefficients have the covariance `P C Pᵀ`, where `P = (ΘᵀWΘ)⁻¹ ΘᵀW
//! F` is the same least-squares fit. For a nonlinear law, Θ has the derivatives of the law. If the law has the terms of the
//! estimate, P is the identity. The change of the estimate if the samples near stops are left out changes the law by P, too.

use super::super::error::Result;
use super::super::methods::confidence::quantile;
use super::super::result::CONFIDENCE;
use super::errors::{Errors, rescaled};
use super::task::CommonTerms;
use nalgebra::{DMatrix, DVector};

impl Errors {
    /// Errors that include effects that the residuals do not show: the covariance of the common estimate if it is the larger
    /// one, and the changes of the estimate and of the law if the samples near rests and reversals are left out.
    ///
    /// - `common`: terms of the common estimate, and P
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
