//! The law, the settings of its regression, and what a regression gives.

use super::super::confidence;
use super::super::error::Result;
use super::super::kernel::{BLOCK, stribeck_block};
use gelenk_formula::FrictionPart;
use nalgebra::{SMatrix, SVector};

pub(crate) const NAMES: [&str; 5] = FrictionPart::STRIBECK_KEYS;

/// The law's value at velocity `v` [N·m or N].
pub fn stribeck_torque(v: f64, a: &[f64; 5]) -> f64 {
    a[0] * v + a[1] * (a[2] * v).tanh() + a[3] * (-a[4] * v.abs()).exp() * (3.0 * a[2] * v).tanh()
}

/// The law's derivatives by a1 … a5 at velocity `v`.
pub fn stribeck_gradient(v: f64, a: &[f64; 5]) -> [f64; 5] {
    let mut columns = [[0.0; BLOCK]; 6];
    stribeck_block(&[v], &[0.0], a, &mut columns);
    std::array::from_fn(|i| columns[i][0])
}

/// Weights against outliers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Robustness {
    /// Least squares.
    None,
    /// Huber's weights `min(1, k s/|r|)`; k = 1.345 keeps 95 % of the efficiency under normal errors.
    Huber(f64),
}

/// Settings of the regression.
#[derive(Debug, Clone, PartialEq)]
pub struct StribeckRegression {
    /// How many of the best starts are refined on the binned data.
    pub starts: usize,
    /// Whether each run has a constant torque beside the law.
    pub offset: bool,
    /// Weights against outliers.
    pub robustness: Robustness,
    /// Limit of the passes over all samples, for each set of weights.
    pub max_iterations: usize,
    /// The refinement ends when a step lowers the cost by less than this share.
    pub tolerance: f64,
}

impl Default for StribeckRegression {
    fn default() -> Self {
        Self { starts: 5, offset: true, robustness: Robustness::None, max_iterations: 100, tolerance: 1e-13 }
    }
}

/// Result of the regression.
#[derive(Debug, Clone, PartialEq)]
pub struct StribeckFit {
    /// a1 … a5 [N·m·s/rad, N·m, s/rad, N·m, s/rad].
    pub parameters: [f64; 5],
    /// The constant torque of each run; none where the regression has none.
    pub offsets: Vec<f64>,
    /// Covariance of the parameters for independent errors, or for correlated ones after
    /// [`Self::with_correlated_errors`]; rows and columns of parameters that are not identifiable are zero, see
    /// [`Self::standard_errors`].
    pub covariance: SMatrix<f64, 5, 5>,
    /// Standard errors; `None` where a parameter is not identifiable from these data.
    pub standard_errors: [Option<f64>; 5],
    /// Standard errors if all other parameters were known.
    pub resolutions: [Option<f64>; 5],
    /// Residual variance σ² [(N·m)²].
    pub variance: f64,
    /// Degrees of freedom.
    pub freedom: usize,
    /// Condition number of the sensitivities, columns scaled.
    pub condition: f64,
    /// Passes over all samples.
    pub iterations: usize,
    /// Whether the iteration reached its tolerance; if not, a warning says so.
    pub converged: bool,
    /// Doubts about the parameters, with numbers.
    pub warnings: Vec<String>,
    /// JᵀWJ at the result, offsets eliminated.
    pub(super) information: SMatrix<f64, 5, 5>,
}

impl StribeckFit {
    /// The law at velocity `v`, without an offset.
    pub fn torque(&self, v: f64) -> f64 {
        stribeck_torque(v, &self.parameters)
    }

    /// Confidence interval of each parameter at `level` (e.g. 0.95); `None` where not identifiable.
    ///
    /// # Errors
    /// A level outside (0, 1).
    pub fn confidence_intervals(&self, level: f64) -> Result<[Option<[f64; 2]>; 5]> {
        let t = self.quantile(level)?;
        Ok(std::array::from_fn(|i| {
            self.standard_errors[i].map(|s| [self.parameters[i] - t * s, self.parameters[i] + t * s])
        }))
    }

    /// Half widths at velocity `v`: of the confidence band of the law, and of the prediction band of a new
    /// sample without its offset.
    ///
    /// # Errors
    /// A level outside (0, 1).
    pub fn half_widths(&self, v: f64, level: f64) -> Result<[f64; 2]> {
        let t = self.quantile(level)?;
        let g = SVector::<f64, 5>::from(stribeck_gradient(v, &self.parameters));
        let law = g.dot(&(self.covariance * g)).max(0.0);
        Ok([t * law.sqrt(), t * (law + self.variance).sqrt()])
    }

    fn quantile(&self, level: f64) -> Result<f64> {
        confidence::quantile(level, self.freedom.max(1) as f64)
    }
}
