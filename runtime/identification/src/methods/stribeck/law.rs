//! The Stribeck law, and the settings and the result of its regression.

use crate::numeric::kernel::BLOCK;
use gelenk_findings::Finding;
use gelenk_formula::FrictionPart;
use gelenk_kernels::math::exp;
use multiversion::multiversion;
use nalgebra::SMatrix;

pub(crate) const NAMES: [&str; 5] = FrictionPart::STRIBECK_KEYS;

/// Returns the friction torque of the Stribeck law at velocity `v` (in rad/s or m/s), in N·m or N.
///
/// - `a`: parameters of the law `a1 v + a2 tanh(a3 v) + a4 exp(−a5 |v|) tanh(3 a3 v)`
pub fn stribeck_torque(v: f64, a: &[f64; 5]) -> f64 {
    a[0] * v + a[1] * (a[2] * v).tanh() + a[3] * (-a[4] * v.abs()).exp() * (3.0 * a[2] * v).tanh()
}

/// Returns speeds from `speed` down to a ten-thousandth of it.
pub(crate) fn slower(speed: f64) -> impl Iterator<Item = f64> {
    (0..=180).map(move |i| speed * 0.95_f64.powi(i))
}

/// Returns the derivatives of the Stribeck torque at velocity `v` with respect to the parameters a1 … a5.
pub(crate) fn stribeck_gradient(v: f64, a: &[f64; 5]) -> [f64; 5] {
    let mut columns = [[0.0; BLOCK]; 6];
    stribeck_block(&[v], &[0.0], a, &mut columns);
    std::array::from_fn(|i| columns[i][0])
}

/// Computes the derivatives ∂τ/∂a of the torque τ with respect to the parameters a, and the residual of the
/// law, over one block.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2+fma"))]
pub(super) fn stribeck_block(v: &[f64], torque: &[f64], a: &[f64; 5], columns: &mut [[f64; BLOCK]; 6]) {
    let n = v.len().min(torque.len()).min(BLOCK);
    let [c1, c2, c3, c4, c5, residual] = columns;
    for i in 0..n {
        let (x, s) = (v[i], v[i].abs());
        let e = exp(-2.0 * a[2] * s);
        let e3 = e * e * e;
        // tanh is expressed by e. Absolute errors of 1e-16 are small enough for sums of squares.
        let t = ((1.0 - e) / (1.0 + e)).copysign(x);
        let u = ((1.0 - e3) / (1.0 + e3)).copysign(x);
        let decay = exp(-a[4] * s);
        c1[i] = x;
        c2[i] = t;
        c3[i] = a[1] * x * (1.0 - t * t) + 3.0 * a[3] * decay * x * (1.0 - u * u);
        c4[i] = decay * u;
        c5[i] = -a[3] * s * decay * u;
        residual[i] = torque[i] - (a[0] * x + a[1] * t + a[3] * decay * u);
    }
}

/// Settings of the regression of a Stribeck law.
#[derive(Debug, Clone, PartialEq)]
pub struct StribeckRegression {
    /// Number of starts that are refined on a part of the samples. They are the starts with the smallest costs.
    pub starts: usize,
    /// Largest number of passes over all samples, for each set of weights.
    pub max_iterations: usize,
    /// Relative decrease of the cost in one step at which the refinement ends.
    pub tolerance: f64,
}

impl Default for StribeckRegression {
    fn default() -> Self {
        Self { starts: 8, max_iterations: 100, tolerance: 1e-13 }
    }
}

/// Result of the regression of a Stribeck law.
#[derive(Debug, Clone, PartialEq)]
pub struct StribeckFit {
    /// Parameters of the law `a1 v + a2 tanh(a3 v) + a4 exp(−a5 |v|) tanh(3 a3 v)` with the velocity v. For a
    /// revolute joint their units are N·m·s/rad, N·m, s/rad, N·m, s/rad.
    pub parameters: [f64; 5],
    /// Covariance of the parameters for independent errors. Rows and columns of parameters that are not identifiable are zero,
    /// see [`Self::standard_errors`].
    pub covariance: SMatrix<f64, 5, 5>,
    /// Standard error of each parameter; `None` if the data do not determine the parameter.
    pub standard_errors: [Option<f64>; 5],
    /// Residual variance σ², in (N·m)² or N².
    pub variance: f64,
    /// Degrees of freedom of the residual variance.
    pub freedom: usize,
    /// Number of passes over all samples.
    pub iterations: usize,
    /// Whether the iteration reached its tolerance. If it did not, [`Self::warnings`] contains a warning.
    pub converged: bool,
    /// Warnings about the parameters, with numbers.
    pub warnings: Vec<Finding>,
}

impl StribeckFit {
    /// Returns the friction torque of the law at velocity `v`.
    pub(crate) fn torque(&self, v: f64) -> f64 {
        stribeck_torque(v, &self.parameters)
    }
}
