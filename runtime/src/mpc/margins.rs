//! Margins of limits for a robot whose friction is uncertain.

use crate::lqr::matrix;
use crate::qp::QpStage;
use nalgebra::SMatrix;

/// Sensitivity S of the state at a stage to errors of the friction.
///
/// The friction of joint j exceeds the model's by `σ_j(v) ε_j`; the ε_j are independent with a standard normal distribution and
/// constant over the horizon. The inputs correct deviations x of the state by `K x`. Then `x_k = S_k ε` with
///
/// ```text
///     S_{k+1} = (A_k + B_k K) S_k − B_k W_k        S_0 = 0        W = B⁺ diag(σ(v_k))
/// ```
///
/// The standard deviation of entry i of the state is the length of row i of S, that of input i the length of row i of K S. S counts
/// an error that changes its sign with the velocity as if it kept its sign, so its effect is not underestimated.
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

    /// Advances by a stage. Returns the standard deviations of its inputs, and of the states after it.
    ///
    /// - `gain`: K
    /// - `by_friction`: W
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

/// Lengths of the rows.
fn lengths<const R: usize, const C: usize>(m: &SMatrix<f64, R, C>) -> [f64; R] {
    core::array::from_fn(|i| m.row(i).norm())
}

/// A range that is smaller by `margin` at both ends, and at most by half of itself.
pub(super) fn narrowed([low, high]: [f64; 2], margin: f64) -> [f64; 2] {
    let margin = margin.min(0.5 * (high - low));
    [low + margin, high - margin]
}

/// z for which a standard normal number is below z with this probability, at least 1/2.
pub(super) fn quantile(probability: f64) -> f64 {
    let (mut low, mut high) = (0.0, 40.0);
    // Sixty halvings leave the last bit.
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

    /// Published quantiles (Abramowitz and Stegun, 1964, table 26.1).
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
