//! Margins to limits for a robot with uncertain friction.

use crate::lqr::matrix;
use crate::qp::QpStage;
use nalgebra::SMatrix;

/// Sensitivity S of the state at a stage to errors of the friction.
///
/// The friction of joint j exceeds that of the model by `σ_j(v) ε_j`. The numbers ε_j are independent, have a standard normal
/// distribution, and are constant over the horizon. The inputs correct deviations x of the state by `K x`. Then `x_k = S_k ε` with
///
/// ```text
///     S_{k+1} = (A_k + B_k K) S_k − B_k W_k        S_0 = 0        W = B⁺ diag(σ(v_k))
/// ```
///
/// The standard deviation of entry i of the state is the length of row i of S. The standard deviation of input i is the length of
/// row i of K S. A friction error actually changes its sign with the velocity. S assumes a constant sign, so the effect is not
/// underestimated.
///
/// Source: Schwarm, Nikolaou, *Chance-constrained model predictive control*, AIChE Journal 45 (1999).
#[derive(Debug, Clone)]
pub(super) struct Margins<const N: usize, const NX: usize> {
    sensitivity: SMatrix<f64, NX, N>,
}

impl<const N: usize, const NX: usize> Margins<N, NX> {
    pub(super) fn new() -> Self {
        Self { sensitivity: SMatrix::zeros() }
    }

    /// Advances the sensitivity S by a stage. Returns the standard deviations of the inputs of this stage and
    /// of the states after it.
    ///
    /// - `gain`: gain K of the feedback
    /// - `by_friction`: matrix W, whose column j contains the inputs that act like one standard deviation of
    ///   the friction of joint j
    pub(super) fn advance<const M: usize, const NR: usize>(
        &mut self,
        stage: &QpStage<NX, M, NR>,
        gain: &[[f64; NX]; M],
        by_friction: &[[f64; N]; M],
    ) -> ([f64; M], [f64; NX]) {
        let feedback = matrix(gain) * self.sensitivity;
        let inputs = feedback - matrix(by_friction);
        self.sensitivity =
            matrix(&stage.state_matrix) * self.sensitivity + matrix(&stage.input_matrix) * inputs;
        (lengths(&feedback), lengths(&self.sensitivity))
    }
}

/// Euclidean lengths of the rows of a matrix.
fn lengths<const R: usize, const C: usize>(m: &SMatrix<f64, R, C>) -> [f64; R] {
    core::array::from_fn(|i| m.row(i).norm())
}

/// The range narrowed by `margin` at both ends. At least half of the range remains.
pub(super) fn narrowed([low, high]: [f64; 2], margin: f64) -> [f64; 2] {
    let margin = margin.min(0.5 * (high - low));
    [low + margin, high - margin]
}

/// Quantile of the standard normal distribution for a `probability` of at least 1/2.
pub(super) fn quantile(probability: f64) -> f64 {
    let (mut low, mut high) = (0.0, 40.0);
    // After 60 halvings of the interval the result is accurate to the last bit.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let above = 0.5 * libm::erfc(middle * core::f64::consts::FRAC_1_SQRT_2);
        if above > 1.0 - probability { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with published quantiles (Abramowitz and Stegun, 1964, table 26.1).
    #[test]
    fn quantiles_are_those_of_tables() {
        for (probability, z) in
            [(0.5, 0.0), (0.9, 1.281_551_565_5), (0.95, 1.644_853_626_9), (0.999, 3.090_232_306_2)]
        {
            assert!((quantile(probability) - z).abs() < 1e-9, "{probability}: {}", quantile(probability));
        }
    }

    #[test]
    fn ranges_stay_ranges() {
        assert_eq!(narrowed([-1.0, 2.0], 0.5), [-0.5, 1.5]);
        assert_eq!(narrowed([-1.0, 2.0], 9.0), [0.5, 0.5]);
        assert_eq!(narrowed([f64::NEG_INFINITY, 2.0], 0.5), [f64::NEG_INFINITY, 1.5]);
    }
}
