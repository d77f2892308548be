//! Data of the optimal-control QP.

#[cfg(not(feature = "std"))]
use crate::no_std::*;
/// Penalty of a soft bound: `linear · v + ½ quadratic · v²` for a violation `v ≥ 0`.
///
/// The linear term makes the penalty exact. If `linear` exceeds the multiplier of the corresponding hard bound, the soft
/// bound is kept like a hard bound (Fletcher, *Practical Methods of Optimization*, 1987, section 14.3; Kerrigan,
/// Maciejowski, *Soft constraints and exact penalty functions in model predictive control*, UKACC 2000).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Penalty {
    /// Cost per unit of violation, > 0.
    pub linear: f64,
    /// Cost per squared unit of violation, ≥ 0.
    pub quadratic: f64,
}

/// Rows `lo ≤ C x + D u ≤ hi` at one node of the horizon, with the states x and the inputs u.
/// [`QpProblem::row_penalty`] selects hard or soft rows.
///
/// A row is scaled by its largest coefficient. Therefore [`QpSettings::feasibility`](super::QpSettings::feasibility) and
/// [`KktResiduals::primal`](super::KktResiduals::primal) do not depend on the unit of the row. A hard row with equal
/// limits is an equality. If all coefficients of a row are zero, the solution has no influence on the row.
///
/// ```
/// use gelenk_runtime::qp::{QpProblem, QpSettings, QpSolver, QpStatus};
///
/// // A mass whose motor produces at most 1 N at rest, and 2 N less per m/s: |u + 2 v| ≤ 1.
/// let mut problem = QpProblem::<2, 1, 1>::new(20);
/// problem.initial_state = [1.0, 0.0];
/// problem.state_weight = [[1.0, 0.0], [0.0, 0.1]];
/// problem.input_weight = [[0.01]];
/// problem.terminal_weight = [[10.0, 0.0], [0.0, 1.0]];
/// for stage in &mut problem.stages {
///     stage.state_matrix = [[1.0, 0.1], [0.0, 1.0]];
///     stage.input_matrix = [[0.005], [0.1]];
///     stage.rows.state_matrix = [[0.0, 2.0]];
///     stage.rows.input_matrix = [[1.0]];
///     (stage.rows.lower, stage.rows.upper) = ([-1.0], [1.0]);
/// }
/// let mut solver = QpSolver::new(20, QpSettings::default())?;
/// assert_eq!(solver.solve(&problem).status, QpStatus::Solved);
/// assert!((solver.input(0)[0] + 1.0).abs() < 1e-6, "all of its force from rest");
/// assert!((solver.input(3)[0] + 2.0 * solver.state(3)[1] + 1.0).abs() < 1e-6, "less of it at speed");
/// # Ok::<(), gelenk_runtime::qp::QpError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct QpRows<const NX: usize, const NU: usize, const NR: usize> {
    /// Coefficients `C` of the states, row by row.
    pub state_matrix: [[f64; NX]; NR],
    /// Coefficients `D` of the inputs, row by row.
    pub input_matrix: [[f64; NU]; NR],
    /// Lower limits `lo`; −∞ for a row without a lower limit.
    pub lower: [f64; NR],
    /// Upper limits `hi`; +∞ for a row without an upper limit.
    pub upper: [f64; NR],
}

impl<const NX: usize, const NU: usize, const NR: usize> Default for QpRows<NX, NU, NR> {
    /// Rows without limits and with zero coefficients.
    fn default() -> Self {
        Self {
            state_matrix: [[0.0; NX]; NR],
            input_matrix: [[0.0; NU]; NR],
            lower: [f64::NEG_INFINITY; NR],
            upper: [f64::INFINITY; NR],
        }
    }
}

impl<const NX: usize, const NU: usize, const NR: usize> QpRows<NX, NU, NR> {
    /// Whether all coefficients are finite, no lower limit exceeds its upper limit, and finite limits remain finite after
    /// division by the largest coefficient.
    fn is_valid(&self) -> bool {
        let coefficients = [self.state_matrix.as_flattened(), self.input_matrix.as_flattened()];
        let mut valid = finite(coefficients) & ordered(&self.lower, &self.upper);
        for r in 0..NR {
            let unit = unit(&self.state_matrix[r], &self.input_matrix[r]);
            for side in [self.lower[r], self.upper[r]] {
                valid &= side.is_infinite() | (side / unit).is_finite();
            }
        }
        valid
    }
}

/// Data of stage `k` with the states x and the inputs u: dynamics `x_{k+1} = A x_k + B u_k + c`, linear cost
/// and bounds of `u_k` and `x_{k+1}`, and rows of `x_k` and `u_k`.
#[derive(Debug, Clone, PartialEq)]
pub struct QpStage<const NX: usize, const NU: usize, const NR: usize = 0> {
    /// State matrix `A_k` of the dynamics, row by row.
    pub state_matrix: [[f64; NX]; NX],
    /// Input matrix `B_k` of the dynamics, row by row.
    pub input_matrix: [[f64; NU]; NX],
    /// Affine term `c_k` of the dynamics.
    pub affine: [f64; NX],
    /// Linear cost `r_k` of the inputs `u_k`.
    pub input_gradient: [f64; NU],
    /// Linear cost `q_{k+1}` of the state `x_{k+1}` after the stage.
    pub state_gradient: [f64; NX],
    /// Lower bounds of the inputs `u_k`; −∞ for an input without a lower bound. Bounds of inputs are hard.
    pub input_lower: [f64; NU],
    /// Upper bounds of the inputs `u_k`; +∞ for an input without an upper bound. Bounds of inputs are hard.
    pub input_upper: [f64; NU],
    /// Lower bounds of the state `x_{k+1}` after the stage, hard or soft according to
    /// [`QpProblem::state_penalty`]; −∞ for a state without a lower bound.
    pub state_lower: [f64; NX],
    /// Upper bounds of the state `x_{k+1}` after the stage, hard or soft according to
    /// [`QpProblem::state_penalty`]; +∞ for a state without an upper bound.
    pub state_upper: [f64; NX],
    /// Rows `lo ≤ C x_k + D u_k ≤ hi` with the state `x_k` before the stage and its inputs `u_k`.
    pub rows: QpRows<NX, NU, NR>,
}

/// The optimal-control QP over a horizon of `N` stages, with `NX` states, `NU` inputs and `NR` rows per
/// stage.
///
/// ```text
///     min  Σ_{k=0}^{N−1} ½ u_kᵀ R u_k + r_kᵀ u_k + ½ (u_k − u_{k−1})ᵀ W (u_k − u_{k−1})
///        + Σ_{k=1}^{N} ½ x_kᵀ Q_k x_k + q_kᵀ x_k      Q_k = Q for k < N, Q_N = P
///     s.t. x_{k+1} = A_k x_k + B_k u_k + c_k,  x_0 given,  u_min ≤ u_k ≤ u_max,  x_min ≤ x_k ≤ x_max (hard or soft)
///          lo_k ≤ C_k x_k + D_k u_k ≤ hi_k for k < N,  lo_N ≤ C_N x_N ≤ hi_N  (hard or soft)
/// ```
///
/// All weights must be symmetric. Q and P must be positive semidefinite. `R + BᵀP_kB` must be positive definite for the
/// cost-to-go matrix P_k of each stage.
#[derive(Debug, Clone, PartialEq)]
pub struct QpProblem<const NX: usize, const NU: usize, const NR: usize = 0> {
    /// Initial state `x_0`.
    pub initial_state: [f64; NX],
    /// Weight `Q` of the states x_1 … x_{N−1}.
    pub state_weight: [[f64; NX]; NX],
    /// Weight `R` of the inputs u_0 … u_{N−1}.
    pub input_weight: [[f64; NU]; NU],
    /// Weight `P` of the last state x_N.
    pub terminal_weight: [[f64; NX]; NX],
    /// Weight `W` of the changes u_k − u_{k−1} of the inputs; zero if changes have no cost. For a weight of
    /// the rate of the inputs, W is this weight divided by T², with the period T.
    pub input_rate_weight: [[f64; NU]; NU],
    /// Input `u_{−1}` before the horizon. It only has an effect if W is not zero.
    pub previous_input: [f64; NU],
    /// Penalties of the bounds of each state; `None` for a state with hard bounds.
    pub state_penalty: [Option<Penalty>; NX],
    /// Penalties of the rows; `None` for a hard row.
    pub row_penalty: [Option<Penalty>; NR],
    /// Rows of the last state `x_N`, without inputs.
    pub terminal_rows: QpRows<NX, 0, NR>,
    /// Stages 0 … N−1 of the horizon.
    pub stages: Vec<QpStage<NX, NU, NR>>,
}

impl<const NX: usize, const NU: usize, const NR: usize> Default for QpStage<NX, NU, NR> {
    /// A stage with zero matrices, without bounds and rows.
    fn default() -> Self {
        Self {
            state_matrix: [[0.0; NX]; NX],
            input_matrix: [[0.0; NU]; NX],
            affine: [0.0; NX],
            input_gradient: [0.0; NU],
            state_gradient: [0.0; NX],
            input_lower: [f64::NEG_INFINITY; NU],
            input_upper: [f64::INFINITY; NU],
            state_lower: [f64::NEG_INFINITY; NX],
            state_upper: [f64::INFINITY; NX],
            rows: QpRows::default(),
        }
    }
}

impl<const NX: usize, const NU: usize, const NR: usize> QpStage<NX, NU, NR> {
    fn is_valid(&self) -> bool {
        let matrices = [self.state_matrix.as_flattened(), self.input_matrix.as_flattened()];
        finite([matrices[0], matrices[1], &self.affine, &self.input_gradient, &self.state_gradient])
            && ordered(&self.input_lower, &self.input_upper)
            && ordered(&self.state_lower, &self.state_upper)
            && (NR == 0 || self.rows.is_valid())
    }
}

/// Whether all numbers are finite. The test multiplies by 0, because 0 times infinity or NaN is NaN. It needs no branch for
/// each number. This matters because the function processes all data of every solve.
fn finite<const K: usize>(all: [&[f64]; K]) -> bool {
    let mut sums = [0.0; 8];
    for numbers in all {
        let (chunks, rest) = numbers.as_chunks::<8>();
        for chunk in chunks {
            for i in 0..8 {
                sums[i] += 0.0 * chunk[i];
            }
        }
        for (sum, number) in sums.iter_mut().zip(rest) {
            *sum += 0.0 * number;
        }
    }
    sums.iter().sum::<f64>() == 0.0
}

/// Whether all `lower ≤ upper`, no lower bound is +∞ and no upper bound is −∞.
fn ordered(lower: &[f64], upper: &[f64]) -> bool {
    lower
        .iter()
        .zip(upper)
        .fold(true, |ok, (l, h)| ok & (l <= h) & (*l < f64::INFINITY) & (*h > f64::NEG_INFINITY))
}

impl<const NX: usize, const NU: usize, const NR: usize> QpProblem<NX, NU, NR> {
    /// Whether the data are valid: all numbers are finite (except infinite bounds), no lower bound exceeds its upper bound,
    /// and the penalties are positive.
    pub(super) fn is_valid(&self) -> bool {
        let weights = [&self.state_weight, &self.terminal_weight].map(|weight| weight.as_flattened());
        let input_weights = [&self.input_weight, &self.input_rate_weight].map(|weight| weight.as_flattened());
        let penalties = self.state_penalty.iter().chain(&self.row_penalty).flatten();
        finite(weights)
            && finite(input_weights)
            && finite([&self.initial_state, &self.previous_input])
            && penalties.fold(true, |ok, p| {
                ok & (p.linear > 0.0) & (p.quadratic >= 0.0) & finite([&[p.linear, p.quadratic]])
            })
            && (NR == 0 || self.terminal_rows.is_valid())
            && self.stages.iter().all(QpStage::is_valid)
    }

    /// A problem with `horizon` stages in which all matrices and weights are zero, without bounds and rows. Set the fields
    /// of the result.
    pub fn new(horizon: usize) -> Self {
        Self {
            initial_state: [0.0; NX],
            state_weight: [[0.0; NX]; NX],
            input_weight: [[0.0; NU]; NU],
            terminal_weight: [[0.0; NX]; NX],
            input_rate_weight: [[0.0; NU]; NU],
            previous_input: [0.0; NU],
            state_penalty: [None; NX],
            row_penalty: [None; NR],
            terminal_rows: QpRows::default(),
            stages: vec![QpStage::default(); horizon],
        }
    }
}

/// Scaling unit of a row, which is the largest power of two that does not exceed the largest coefficient; 1 if all
/// coefficients are zero.
pub(super) fn unit(c: &[f64], d: &[f64]) -> f64 {
    let largest = c.iter().chain(d).fold(0.0_f64, |max, v| v.abs().max(max));
    let power = f64::from_bits(largest.to_bits() & f64::INFINITY.to_bits());
    if power > 0.0 && power.is_finite() { power } else { 1.0 }
}
