//! What the common estimate says of a law's coefficients: errors of the rigid body and of the delay stand in the torques
//! that the law is fitted to, and no residual shows them.
//!
//! The common estimate has friction terms F of its own with the covariance C. Where least squares is biased, instrumental
//! variables put their coefficients `d` away, and C is theirs. A law has other terms Θ, and is fitted to torques with the same errors:
//! its coefficients move by `P d` with the covariance `P C Pᵀ`, where `P = (ΘᵀWΘ)⁻¹ ΘᵀW F` is least squares again. Where the law
//! has the terms of the estimate, P is one, and its intervals are those of the estimate.

use super::super::error::Result;
use super::super::methods::confidence::half_width_around;
use super::super::methods::library::Library;
use super::super::result::CONFIDENCE;
use super::design::Design;
use super::errors::{Errors, rescaled};
use super::task::CommonTerms;
use nalgebra::DMatrix;

impl Errors {
    /// Errors that count those of the common estimate: the wider of the two intervals counts.
    ///
    /// - `bread`: `(ΘᵀWΘ)⁻¹` of the chosen terms
    pub(super) fn reaching(
        mut self,
        design: &Design,
        (active, bread): (&[usize], &DMatrix<f64>),
        other: &CommonTerms,
    ) -> Result<Self> {
        let library = Library::new(&other.bases, &["v"])?;
        let map = bread * design.products(active, &library)?;
        let (distances, covariance) = (&map * &other.distances, &map * &other.covariance * map.transpose());
        for (k, distance) in distances.iter().enumerate() {
            let error = covariance[(k, k)].max(0.0).sqrt();
            if distance.hypot(error) > self.standard[k] {
                self.standard[k] = distance.hypot(error);
                self.reach[k] = Some(half_width_around(*distance, error, CONFIDENCE, other.freedom)?);
            }
        }
        self.covariance = rescaled(self.covariance, &self.standard);
        Ok(self)
    }
}
