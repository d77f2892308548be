//! Loss of R² if the inertial parameters differ from the estimate.

use super::result::Estimate;
use nalgebra::{DMatrix, DVector};

/// Products from which the change of the residual sum of squares with the inertial parameters is computed. This sum is a
/// quadratic function of the parameters.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Sensitivity {
    pub(super) joints: Vec<JointSensitivity>,
}

/// Sums of products over the samples of one joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct JointSensitivity {
    /// Indices of the parameters with a column in the joint's equation.
    pub(super) parameters: Vec<usize>,
    /// Products of the parameters' columns, without offsets.
    pub(super) products: DMatrix<f64>,
    /// Products of the parameters' columns with the residual.
    pub(super) slopes: DVector<f64>,
    /// Variation `Σ (τ − τ̄)²` of the measured force τ with the mean τ̄.
    pub(super) variation: f64,
}

impl Estimate {
    /// Returns the decrease of R² of each moving joint if `change` is added to the inertial parameters and all other values
    /// stay the same. A negative entry is an increase. Joints whose decrease is not finite have no entry.
    #[must_use]
    pub fn r_squared_lost(&self, change: &[f64]) -> Vec<f64> {
        let lost = |joint: &JointSensitivity| {
            let changed = joint.parameters.iter().enumerate().filter_map(|(k, parameter)| {
                Some((k, *change.get(*parameter)?)).filter(|(_, change)| *change != 0.0)
            });
            let changed: Vec<(usize, f64)> = changed.collect();
            let more = |&(i, di): &(usize, f64)| {
                let squares: f64 = changed.iter().map(|(k, dk)| joint.products[(i, *k)] * dk).sum();
                di * (squares - 2.0 * joint.slopes[i])
            };
            changed.iter().map(more).sum::<f64>() / joint.variation
        };
        self.sensitivity.joints.iter().map(lost).filter(|lost| lost.is_finite()).collect()
    }
}
