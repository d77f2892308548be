//! Discrete-time linear-quadratic regulators.
//!
//! [`Lqr`] is the infinite-horizon regulator of a time-invariant system. [`TimeVaryingLqr`] is the regulator of a
//! time-varying system over a finite horizon. For the system `x⁺ = A x + B u` and the cost `Σ xᵀQx + uᵀRu`, the
//! matrix P of the infinite horizon solves the discrete algebraic Riccati equation
//!
//! ```text
//!     P = Q + AᵀPA − AᵀPB (R + BᵀPB)⁻¹ BᵀPA        K = −(R + BᵀPB)⁻¹ BᵀPA        u = K x
//! ```
//!
//! A regulator does not know limits of inputs and states. For limits use [`crate::mpc`].
//!
//! [`JointLqr`](crate::control_loop::JointLqr) is the regulator of a robot as a law of the control loop. For
//! robots with quaternions, x is the deviation `(y ⊖ y_ref, v − v_ref)`. This example stabilizes a hovering
//! quadrotor:
//!
//! ```
//! use gelenk_runtime::control_loop::{JointLaw, JointLqr, LqrWeights};
//! use gelenk_runtime::dynamics::{Discretizable, Dynamics};
//! use gelenk_runtime::trajectory::Sample;
//! gelenk_runtime::dynamics!(struct Quadrotor = gelenk_generated::quadrotor);
//!
//! let hover = Quadrotor.neutral();
//! let weights = LqrWeights::from_deviations([1.0; 6], [1.0; 6], [3.0; 4]);
//! let law = JointLqr::new(Quadrotor, &hover, 0.02, weights)?;
//!
//! let desired = Sample::at_rest(hover);
//! let (mut y, mut v) = (Quadrotor.integrate(&hover, &[0.3, -0.2, 0.1, 0.5, -0.4, 1.0]), [0.0; 6]);
//! for _ in 0..500 {
//!     let inputs = law.inputs(&desired, &y, &v)?;
//!     (y, v) = Quadrotor.step(&y, &v, &inputs, 0.02);
//! }
//! assert!(Quadrotor.difference(&hover, &y).iter().all(|d| d.abs() < 1e-3));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The Riccati equation is solved in two steps:
//!
//! 1. The structure-preserving doubling algorithm computes a first gain. It converges quadratically, but loses too
//!    many digits if weights differ by many orders of magnitude. In this case the Riccati recursion of the QP
//!    ([`crate::qp`]) computes the first gain.
//! 2. Policy iteration refines the gain, also with quadratic convergence. Each iteration computes the cost of the
//!    gain, as a sum of semidefinite terms without cancellation, and then the optimal gain for this cost. The
//!    residual of the equation is the change of the cost in the last iteration.
//!
//! Sources: Anderson, Moore, *Optimal Control: Linear Quadratic Methods*, 1990, chapters 2 and 4. Doubling:
//! Chu, Fan, Lin, Wang, *Structure-preserving algorithms for periodic discrete-time algebraic Riccati
//! equations*, Int. J. Control 77 (2004), section 2. Policy iteration: Hewer, *An iterative technique for the
//! computation of the steady state gains for the discrete optimal regulator*, IEEE Trans. Automatic Control
//! 16 (1971). Margins: Shaked, *Guaranteed stability margins for the discrete-time linear quadratic optimal
//! regulator*, IEEE Trans. Automatic Control 31 (1986). Rounding of products: Higham, *Accuracy and Stability
//! of Numerical Algorithms*, 2002, section 3.5.

#[cfg(not(feature = "std"))]
use crate::no_std::*;
use crate::qp::lanes::Portable;
use crate::qp::riccati::Riccati;
use crate::qp::{MAX_HORIZON, MAX_SIZE};
use core::fmt;
use nalgebra::SMatrix;
use thiserror::Error;

/// Largest number of doublings. Each doubling squares the closed-loop matrix. If the doublings have not converged
/// after this number, the Riccati equation has no stabilizing solution.
const MAX_DOUBLINGS: usize = 60;
/// Largest number of steps of the recursion that searches for a stabilizing gain.
const MAX_RECURSIONS: usize = 4096;
/// Largest number of steps of policy iteration. Each step doubles the number of correct digits.
const MAX_REFINEMENTS: usize = 20;
/// Number of squarings of a matrix. The trace of the resulting power then gives the largest eigenvalue with a
/// relative error of 1e-15 · ln(32).
const EIGENVALUE_DOUBLINGS: usize = 50;
/// Largest accepted residual of the Riccati equation relative to its solution, unless the rounding error of
/// the residual is larger.
const RESIDUAL: f64 = 1e-9;
/// Largest accepted residual of the Riccati equation relative to its solution, for every rounding error.
const WORST_RESIDUAL: f64 = 1e-6;

/// Reason why a regulator cannot be computed.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum LqrError {
    /// A size is not in 1..=32, or a horizon is not in 1..=100.
    #[error("sizes must be 1 to {MAX_SIZE}, and horizons 1 to {MAX_HORIZON}")]
    Size,
    /// A number is NaN or infinite.
    #[error("the system or its weights contain a number that is not finite")]
    NotFinite,
    /// `R + BᵀPB` is not positive definite, with the input weights R, the input matrix B and the cost-to-go
    /// P.
    #[error("R + BᵀPB is not positive definite: choose a positive definite input weight")]
    NotPositive,
    /// The Riccati equation has no stabilizing solution. Either the inputs cannot stabilize the system, or a
    /// mode of the system on or outside the unit circle does not appear in the cost. The number is the
    /// relative residual after the last iteration.
    #[error(
        "the Riccati equation has no stabilizing solution (residual {0:.1e}). Check that every unstable mode is controllable and \
         has a state weight"
    )]
    NotStabilizable(f64),
    /// A stabilizing gain was computed, but its residual is too large: above 1e-6, or above 1e-9 and above its
    /// rounding error. The reason is usually that weights differ by many orders of magnitude. The number is the
    /// relative residual.
    #[error(
        "the Riccati equation was solved only to a residual of {0:.1e}. Choose weights or units that differ by fewer orders of magnitude"
    )]
    Inaccurate(f64),
}

/// Infinite-horizon regulator `u = K x` of the system `x⁺ = A x + B u` with the cost `Σ xᵀQx + uᵀRu` of the
/// states x and the inputs u.
#[derive(Debug, Clone, PartialEq)]
pub struct Lqr<const NX: usize, const NU: usize> {
    /// Gain K of `u = K x`, row by row. The minus sign of the feedback is included.
    pub gain: [[f64; NX]; NU],
    /// Stabilizing solution P of the Riccati equation. `xᵀPx` is the cost from the state x.
    pub cost_to_go: [[f64; NX]; NX],
    /// Largest residual of the Riccati equation, relative to the largest entry of its solution P.
    pub residual: f64,
    /// Upper bound of the rounding error of `residual`, also relative to the largest entry of the solution P.
    /// The bound is `2 NX ε (|Q| + |K|ᵀ|R||K| + Wᵀ|P|W)` with `W = |A| + |B||K|`, the system matrices A and
    /// B, the weights Q and R, the gain K and the machine precision ε.
    pub rounding: f64,
    /// Lower bound α = 1/√λ_max(I + R⁻¹BᵀPB) of the return difference, with the input weights R, the input
    /// matrix B and the cost-to-go P. The [`margins`](Self::margins) follow from α.
    pub return_difference: f64,
}

/// Stability margins: changes of all inputs by a common factor or phase shift for which the closed loop remains
/// stable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margins {
    /// Smallest and largest factor of the inputs.
    pub gain: [f64; 2],
    /// Largest phase shift of the inputs, in both directions \[rad\].
    pub phase: f64,
}

impl fmt::Display for Margins {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, high] = self.gain;
        let phase = self.phase.to_degrees();
        write!(
            f,
            "the loop is stable for gain factors from {low:.2} to {high:.2} and for phase shifts up to ±{phase:.1}°"
        )
    }
}

impl<const NX: usize, const NU: usize> Lqr<NX, NU> {
    /// Computes the regulator by solving the discrete algebraic Riccati equation. Matrices are given row by
    /// row. The state weights Q must be positive semidefinite, and the input weights R positive definite. The
    /// solution is accepted if its relative residual is below 1e-9, or below 1e-6 and below its rounding
    /// error.
    ///
    /// # Errors
    /// [`LqrError`] for wrong sizes, numbers that are not finite, an R that is not positive definite, or an
    /// equation without an accurate stabilizing solution.
    pub fn new(
        state_matrix: &[[f64; NX]; NX],
        input_matrix: &[[f64; NU]; NX],
        state_weight: &[[f64; NX]; NX],
        input_weight: &[[f64; NU]; NU],
    ) -> Result<Self, LqrError> {
        let lqr = Self::stabilizing(state_matrix, input_matrix, state_weight, input_weight)?;
        if lqr.is_accurate() { Ok(lqr) } else { Err(LqrError::Inaccurate(lqr.residual)) }
    }

    /// Computes the regulator like [`new`](Self::new), but without a limit of the residual. P is the cost of a
    /// stabilizing gain, and K is the optimal gain for this P.
    pub(crate) fn stabilizing(
        state_matrix: &[[f64; NX]; NX],
        input_matrix: &[[f64; NU]; NX],
        state_weight: &[[f64; NX]; NX],
        input_weight: &[[f64; NU]; NU],
    ) -> Result<Self, LqrError> {
        let mut equation = Equation::new(state_matrix, input_matrix, state_weight, input_weight)?;
        let mut gain = equation.stabilizing_gain()?;
        let mut best: Option<Self> = None;
        for _ in 0..MAX_REFINEMENTS {
            let Some(cost) = equation.cost_of(&gain) else {
                break;
            };
            let next = equation.gain_of(&cost)?;
            let residual = equation.residual(&next, &cost);
            // This form ends the iteration if the residual is NaN.
            let better = residual < best.as_ref().map_or(f64::INFINITY, |best| 0.5 * best.residual);
            if !better || !equation.is_stable(&next) {
                break;
            }
            best = Some(Self {
                gain: rows(&next),
                cost_to_go: rows(&cost),
                residual,
                rounding: equation.rounding(&next, &cost),
                return_difference: equation.return_difference(&cost)?,
            });
            gain = next;
        }
        best.ok_or(LqrError::NotStabilizable(f64::NAN))
    }

    /// Whether the residual is within its limits; false for NaN.
    pub(crate) fn is_accurate(&self) -> bool {
        self.residual <= RESIDUAL.max(self.rounding).min(WORST_RESIDUAL)
    }

    /// Guaranteed stability margins at the inputs:
    ///
    /// ```text
    ///     gains from 1/(1 + α) to 1/(1 − α)        phases to ±2 arcsin(α/2)
    /// ```
    ///
    /// The number α is [`return_difference`](Self::return_difference), a lower bound of the return difference I + L
    /// with the loop gain `L(z) = −K (z I − A)⁻¹ B`. The equation `(I + L)* (R + BᵀPB) (I + L) = R + G* Q G` with
    /// `G = (z I − A)⁻¹ B` gives `σ_min(R^½ (I + L) R^−½) ≥ 1/√λ_max(I + R⁻¹BᵀPB) = α` on the unit circle
    /// (Shaked 1986). The margins follow from α (Lehtomaki, Sandell, Athans, *Robustness results in
    /// linear-quadratic Gaussian based multivariable control designs*, IEEE Trans. Automatic Control 26,
    /// 1981, theorem 1). They are valid for a change of either gain or phase that is the same for all inputs.
    /// If R is diagonal, the margins are also valid for a different change of each input. The actual margins are at
    /// least as large as the guaranteed margins.
    pub fn margins(&self) -> Margins {
        let alpha = self.return_difference;
        Margins { gain: [1.0 / (1.0 + alpha), 1.0 / (1.0 - alpha)], phase: 2.0 * (0.5 * alpha).asin() }
    }

    /// The input `K x` for the state x, with the gain K.
    pub fn input(&self, state: &[f64; NX]) -> [f64; NU] {
        self.gain.map(|row| row.iter().zip(state).map(|(k, x)| k * x).sum())
    }
}

/// Regulator `u_k = K_k x_k` of the time-varying system `x_{k+1} = A_k x_k + B_k u_k` over a finite horizon. The
/// gains are computed by the Riccati recursion of the QP solver. Memory is allocated only by [`new`](Self::new).
#[derive(Debug, Clone)]
pub struct TimeVaryingLqr<const NX: usize, const NU: usize> {
    horizon: usize,
    riccati: Riccati<Portable, NX, NU>,
}

impl<const NX: usize, const NU: usize> TimeVaryingLqr<NX, NU> {
    /// Allocates the regulator for `horizon` stages. All `A_k` and `B_k` are initially zero.
    ///
    /// # Errors
    /// [`LqrError::Size`] if a size is not in 1..=32, or the horizon is not in 1..=100.
    pub fn new(horizon: usize) -> Result<Self, LqrError> {
        let sizes = (1..=MAX_SIZE).contains(&NX) && (1..=MAX_SIZE).contains(&NU);
        if !sizes || !(1..=MAX_HORIZON).contains(&horizon) {
            return Err(LqrError::Size);
        }
        Ok(Self { horizon, riccati: Riccati::new(horizon) })
    }

    /// Sets `A_k` and `B_k`, row by row. Stages beyond the horizon are ignored.
    pub fn set_stage(&mut self, k: usize, state_matrix: &[[f64; NX]; NX], input_matrix: &[[f64; NU]; NX]) {
        if k < self.horizon {
            self.riccati.set_stage(k, state_matrix, input_matrix);
        }
    }

    /// Computes the gains by the backward recursion of the cost-to-go matrices from `P_N = terminal_weight`
    /// to P_0.
    ///
    /// # Errors
    /// [`LqrError::NotPositive`] if `R + BᵀPB` is not positive definite, with the input weights R, the input
    /// matrix B and the cost-to-go P of a stage. The gains are then undefined.
    pub fn solve(
        &mut self,
        state_weight: &[[f64; NX]; NX],
        input_weight: &[[f64; NU]; NU],
        terminal_weight: &[[f64; NX]; NX],
    ) -> Result<(), LqrError> {
        self.riccati.set_weights(state_weight, input_weight, terminal_weight, &[[0.0; NU]; NU]);
        self.riccati.regulate().map_err(|_| LqrError::NotPositive)
    }

    /// Gain `K_k` of stage k; zeros beyond the horizon.
    pub fn gain(&self, k: usize) -> [[f64; NX]; NU] {
        if k < self.horizon { self.riccati.gain(k) } else { [[0.0; NX]; NU] }
    }

    /// Cost-to-go matrix `P_0` of the first stage. The cost of the horizon is `x_0ᵀ P_0 x_0` for the initial
    /// state x_0.
    pub fn cost_to_go(&self) -> [[f64; NX]; NX] {
        self.riccati.cost_to_go()
    }
}

/// The Riccati equation, with memory for the recursion.
struct Equation<const NX: usize, const NU: usize> {
    a: SMatrix<f64, NX, NX>,
    b: SMatrix<f64, NX, NU>,
    q: SMatrix<f64, NX, NX>,
    r: SMatrix<f64, NU, NU>,
    recursion: TimeVaryingLqr<NX, NU>,
}

impl<const NX: usize, const NU: usize> Equation<NX, NU> {
    fn new(
        a: &[[f64; NX]; NX],
        b: &[[f64; NU]; NX],
        q: &[[f64; NX]; NX],
        r: &[[f64; NU]; NU],
    ) -> Result<Self, LqrError> {
        let states = a.iter().chain(q).flatten();
        let inputs = b.iter().flatten().chain(r.iter().flatten());
        if !states.chain(inputs).all(|v| v.is_finite()) {
            return Err(LqrError::NotFinite);
        }
        let mut recursion = TimeVaryingLqr::new(1)?;
        recursion.set_stage(0, a, b);
        Ok(Self { a: matrix(a), b: matrix(b), q: matrix(q), r: matrix(r), recursion })
    }

    /// A stabilizing gain by the doubling algorithm. If this algorithm fails, the Riccati recursion that
    /// starts at the state weights Q computes the gain.
    fn stabilizing_gain(&mut self) -> Result<SMatrix<f64, NU, NX>, LqrError> {
        if let Some(cost) = self.doubling()?
            && let Ok(gain) = self.gain_of(&cost)
            && self.is_stable(&gain)
        {
            return Ok(gain);
        }
        let (mut cost, mut residual) = (self.q, f64::NAN);
        for step in 1..=MAX_RECURSIONS {
            let Ok(gain) = self.gain_of(&cost) else { break };
            // The stability check takes as long as many steps, so it is made only after 1, 2, 4, 8, … steps.
            if step.is_power_of_two() && self.is_stable(&gain) {
                return Ok(gain);
            }
            residual = self.residual(&gain, &cost);
            cost = self.closed_loop_cost(&gain, &cost);
        }
        Err(LqrError::NotStabilizable(residual))
    }

    /// The gain `−(R + BᵀPB)⁻¹ BᵀPA` of a cost-to-go P, with the input weights R and the system matrices A
    /// and B.
    fn gain_of(&mut self, cost: &SMatrix<f64, NX, NX>) -> Result<SMatrix<f64, NU, NX>, LqrError> {
        self.recursion.solve(&rows(&self.q), &rows(&self.r), &rows(cost))?;
        Ok(matrix(&self.recursion.gain(0)))
    }

    /// The infinite-horizon cost of a gain K, `Σ (A_cᵀ)ᵏ (Q + KᵀRK) A_cᵏ` with the weights Q and R and the
    /// closed-loop matrix `A_c = A + B K`. Each step doubles the number of terms. `None` if the sum does not
    /// converge.
    fn cost_of(&self, gain: &SMatrix<f64, NU, NX>) -> Option<SMatrix<f64, NX, NX>> {
        let mut power = self.a + self.b * gain;
        let mut sum = self.q + gain.transpose() * self.r * gain;
        for _ in 0..MAX_DOUBLINGS {
            let added = symmetric(&(power.transpose() * sum * power));
            sum = symmetric(&(sum + added));
            if !sum.iter().all(|x| x.is_finite()) {
                return None;
            }
            // The terms are semidefinite, so their diagonals bound all entries.
            if (0..NX).all(|i| added[(i, i)] <= f64::EPSILON * sum[(i, i)]) {
                return Some(sum);
            }
            power *= power;
        }
        None
    }

    /// The right-hand side `Q + KᵀRK + (A + BK)ᵀ P (A + BK)` of the Riccati equation for the optimal gain K
    /// of the cost-to-go P. In contrast to the usual form, this form has no cancellation. An error of K has
    /// only a second-order effect (Anderson, Moore 1990, section 3.3).
    fn closed_loop_cost(
        &self,
        gain: &SMatrix<f64, NU, NX>,
        cost: &SMatrix<f64, NX, NX>,
    ) -> SMatrix<f64, NX, NX> {
        let closed = self.a + self.b * gain;
        symmetric(&(self.q + gain.transpose() * self.r * gain + closed.transpose() * cost * closed))
    }

    fn residual(&self, gain: &SMatrix<f64, NU, NX>, cost: &SMatrix<f64, NX, NX>) -> f64 {
        let change = self.closed_loop_cost(gain, cost) - cost;
        largest(&change) / largest(cost).max(f64::MIN_POSITIVE)
    }

    /// Upper bound of the rounding error of [`residual`](Self::residual). The rounding error of a scalar product with
    /// n terms is at most n ε times the scalar product of the magnitudes.
    fn rounding(&self, gain: &SMatrix<f64, NU, NX>, cost: &SMatrix<f64, NX, NX>) -> f64 {
        let (k, p) = (gain.abs(), cost.abs());
        let closed = self.a.abs() + self.b.abs() * k;
        let size = self.q.abs() + k.transpose() * self.r.abs() * k + closed.transpose() * p * closed;
        2.0 * NX as f64 * f64::EPSILON * largest(&size) / largest(cost).max(f64::MIN_POSITIVE)
    }

    /// The bound 1/√λ_max(N) with N = I + R⁻¹BᵀPB. All eigenvalues of N are real and at least 1. Therefore the trace
    /// of N^(2^k) to the power 2^−k is an upper bound of the largest eigenvalue, and converges to this eigenvalue.
    fn return_difference(&self, cost: &SMatrix<f64, NX, NX>) -> Result<f64, LqrError> {
        let r = self.r.cholesky().ok_or(LqrError::NotPositive)?;
        let mut power = SMatrix::identity() + r.solve(&(self.b.transpose() * cost * self.b));
        let (mut log, mut share) = (0.0, 1.0);
        for _ in 0..EIGENVALUE_DOUBLINGS {
            let trace = power.trace();
            log += share * trace.ln();
            share *= 0.5;
            power /= trace;
            power *= power;
        }
        Ok((-0.5 * log).exp().clamp(0.0, 1.0))
    }

    /// Whether the powers of the closed-loop matrix `A + B K` converge to 0.
    fn is_stable(&self, gain: &SMatrix<f64, NU, NX>) -> bool {
        let mut power = self.a + self.b * gain;
        for _ in 0..40 {
            let size = power.amax();
            if !size.is_finite() {
                return false;
            }
            if size < 1e-3 {
                return true;
            }
            power *= power;
        }
        false
    }

    /// The solution P by the doubling iteration `A⁺ = A W⁻¹ A`, `G⁺ = G + A W⁻¹ G Aᵀ`, `H⁺ = H + Aᵀ H W⁻¹ A` with
    /// `W = I + G H`. It starts at `G = B R⁻¹ Bᵀ`, `H = Q`. H converges to P. Returns `None` if W is singular.
    fn doubling(&self) -> Result<Option<SMatrix<f64, NX, NX>>, LqrError> {
        let (mut a, mut h) = (self.a, self.q);
        let cholesky = self.r.cholesky().ok_or(LqrError::NotPositive)?;
        let mut g = self.b * cholesky.solve(&self.b.transpose());
        for _ in 0..MAX_DOUBLINGS {
            let w = SMatrix::<f64, NX, NX>::identity() + g * h;
            let Some(inverse) = w.try_inverse() else {
                return Ok(None);
            };
            let wa = inverse * a;
            let next = h + a.transpose() * h * wa;
            g += a * inverse * g * a.transpose();
            a *= wa;
            let change = (next - h).amax();
            h = symmetric(&next);
            g = symmetric(&g);
            if change <= 1e-15 * h.amax() || change.is_nan() {
                break;
            }
        }
        Ok(Some(h))
    }
}

/// Largest magnitude; NaN if an entry is NaN.
fn largest<const R: usize, const C: usize>(m: &SMatrix<f64, R, C>) -> f64 {
    m.iter().fold(0.0, |max: f64, v| if v.is_nan() || max.is_nan() { f64::NAN } else { max.max(v.abs()) })
}

fn symmetric<const N: usize>(m: &SMatrix<f64, N, N>) -> SMatrix<f64, N, N> {
    (m + m.transpose()) * 0.5
}

/// A matrix from its rows.
pub(crate) fn matrix<const R: usize, const C: usize>(rows: &[[f64; C]; R]) -> SMatrix<f64, R, C> {
    SMatrix::from_fn(|i, j| rows[i][j])
}

fn rows<const R: usize, const C: usize>(m: &SMatrix<f64, R, C>) -> [[f64; C]; R] {
    core::array::from_fn(|i| core::array::from_fn(|j| m[(i, j)]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The limit of the residual is the larger of 1e-9 and the rounding error, but at most 1e-6. NaN is not accurate.
    #[test]
    fn residuals_are_judged_by_what_rounding_explains() {
        let accurate = |residual, rounding| {
            Lqr { gain: [[0.0]], cost_to_go: [[1.0]], residual, rounding, return_difference: 1.0 }
                .is_accurate()
        };
        assert!(accurate(0.9e-9, 0.0) && accurate(0.9e-7, 1e-7) && accurate(0.9e-6, 1.0));
        assert!(!accurate(1.1e-9, 0.0) && !accurate(1.1e-7, 1e-7) && !accurate(1.1e-6, 1.0));
        assert!(!accurate(f64::NAN, 1e-7) && accurate(1e-10, f64::NAN));
    }
}
