//! Linear-quadratic regulators: infinite-horizon (discrete algebraic Riccati equation) and time-varying.
//!
//! ```text
//!     P = Q + AᵀPA − AᵀPB (R + BᵀPB)⁻¹ BᵀPA        K = −(R + BᵀPB)⁻¹ BᵀPA        u = K x
//! ```
//!
//! The equation is solved by the structure-preserving doubling algorithm, which converges quadratically, and its solution is then refined by the
//! Riccati recursion of the QP ([`crate::qp`]), whose gain is returned: weights far apart cost the doubling digits, and the recursion, which
//! contracts by the closed loop, wins them back. The residual of the equation is what its last step changes.
//!
//! Sources: Anderson, Moore, *Optimal Control: Linear Quadratic Methods*, 1990, chapters 2 and 4; Chu, Fan, Lin, Wang, *Structure-preserving
//! algorithms for periodic discrete-time algebraic Riccati equations*, Int. J. Control 77 (2004), section 2.

use crate::qp::lanes::Portable;
use crate::qp::riccati::Riccati;
use crate::qp::{MAX_HORIZON, MAX_SIZE};
use nalgebra::SMatrix;
use std::fmt;

/// Doublings after which a Riccati equation without a stabilizing solution is given up; each squares the closed loop.
const MAX_DOUBLINGS: usize = 60;
/// Steps of the recursion after the doubling, at most.
const MAX_REFINEMENTS: usize = 50;
/// Largest residual of the Riccati equation, relative to P.
const RESIDUAL: f64 = 1e-9;

/// Why there is no regulator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LqrError {
    /// Sizes not 1..=32, or a horizon not 1..=100.
    Size,
    /// A number is NaN or infinite.
    NotFinite,
    /// `R + BᵀPB` is not positive definite.
    NotPositive,
    /// No stabilizing solution: (A, B) is not stabilizable, or a mode of A on or outside the unit circle does not appear in the cost.
    /// The number is the relative residual where the method ended.
    NotStabilizable(f64),
}

impl fmt::Display for LqrError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size => write!(
                f,
                "sizes must be 1 to {MAX_SIZE}, horizons 1 to {MAX_HORIZON}"
            ),
            Self::NotFinite => write!(f, "a number of the system or its weights is not finite"),
            Self::NotPositive => write!(
                f,
                "R + BᵀPB is not positive definite; choose a positive definite input weight"
            ),
            Self::NotStabilizable(residual) => write!(
                f,
                "no stabilizing solution of the Riccati equation (residual {residual:.1e}): check that every unstable mode can be \
                 reached by an input and appears in the state weight"
            ),
        }
    }
}

impl std::error::Error for LqrError {}

/// Infinite-horizon regulator `u = K x` of `x⁺ = A x + B u` with the cost `Σ xᵀQx + uᵀRu`.
#[derive(Debug, Clone, PartialEq)]
pub struct Lqr<const NX: usize, const NU: usize> {
    /// K, rows first, sign included.
    pub gain: [[f64; NX]; NU],
    /// P, the stabilizing solution of the Riccati equation: `xᵀPx` is the cost from x on.
    pub cost_to_go: [[f64; NX]; NX],
    /// Largest residual of the equation, relative to the largest entry of P.
    pub residual: f64,
}

impl<const NX: usize, const NU: usize> Lqr<NX, NU> {
    /// Solves the discrete algebraic Riccati equation. All matrices rows first; Q positive semidefinite, R positive definite.
    ///
    /// # Errors
    /// [`LqrError`].
    pub fn new(
        state_matrix: &[[f64; NX]; NX],
        input_matrix: &[[f64; NU]; NX],
        state_weight: &[[f64; NX]; NX],
        input_weight: &[[f64; NU]; NU],
    ) -> Result<Self, LqrError> {
        let states = state_matrix.iter().chain(state_weight).flatten();
        let inputs = input_matrix
            .iter()
            .flatten()
            .chain(input_weight.iter().flatten());
        if !states.chain(inputs).all(|v| v.is_finite()) {
            return Err(LqrError::NotFinite);
        }
        let mut p = doubling(state_matrix, input_matrix, state_weight, input_weight)?;
        let mut last = TimeVaryingLqr::new(1)?;
        last.set_stage(0, state_matrix, input_matrix);
        let (mut gain, mut cost_to_go, mut residual) = ([[0.0; NX]; NU], p, f64::INFINITY);
        for _ in 0..MAX_REFINEMENTS {
            last.solve(state_weight, input_weight, &p)
                .map_err(|_| LqrError::NotStabilizable(f64::NAN))?;
            let k = last.gain(0);
            let next = closed_loop_cost(
                state_matrix,
                input_matrix,
                state_weight,
                input_weight,
                &k,
                &p,
            );
            let change = distance(&next, &p);
            // Written so that NaN ends it.
            let better = change < 0.9 * residual;
            if !better {
                break;
            }
            (gain, cost_to_go, residual) = (k, next, change);
            p = next;
        }
        // Written so that NaN counts as failure.
        let solved = residual <= RESIDUAL && is_stable(state_matrix, input_matrix, &gain);
        if solved {
            Ok(Self {
                gain,
                cost_to_go,
                residual,
            })
        } else {
            Err(LqrError::NotStabilizable(residual))
        }
    }

    /// `K x`.
    pub fn input(&self, state: &[f64; NX]) -> [f64; NU] {
        self.gain
            .map(|row| row.iter().zip(state).map(|(k, x)| k * x).sum())
    }
}

/// Regulator over a finite horizon of time-varying dynamics, `u_k = K_k x_k`, by the recursion of the QP. Memory is allocated at construction only.
#[derive(Debug, Clone)]
pub struct TimeVaryingLqr<const NX: usize, const NU: usize> {
    horizon: usize,
    riccati: Riccati<Portable, NX, NU>,
}

impl<const NX: usize, const NU: usize> TimeVaryingLqr<NX, NU> {
    /// Memory for `horizon` stages.
    ///
    /// # Errors
    /// [`LqrError::Size`].
    pub fn new(horizon: usize) -> Result<Self, LqrError> {
        let sizes = (1..=MAX_SIZE).contains(&NX) && (1..=MAX_SIZE).contains(&NU);
        if !sizes || !(1..=MAX_HORIZON).contains(&horizon) {
            return Err(LqrError::Size);
        }
        Ok(Self {
            horizon,
            riccati: Riccati::new(horizon),
        })
    }

    /// `A_k` and `B_k`, rows first; stages beyond the horizon are ignored.
    pub fn set_stage(
        &mut self,
        k: usize,
        state_matrix: &[[f64; NX]; NX],
        input_matrix: &[[f64; NU]; NX],
    ) {
        if k < self.horizon {
            self.riccati.set_stage(k, state_matrix, input_matrix);
        }
    }

    /// Runs the recursion from `P_N = terminal_weight` down to P_0.
    ///
    /// # Errors
    /// [`LqrError::NotPositive`]; the gains are then not defined.
    pub fn solve(
        &mut self,
        state_weight: &[[f64; NX]; NX],
        input_weight: &[[f64; NU]; NU],
        terminal_weight: &[[f64; NX]; NX],
    ) -> Result<(), LqrError> {
        self.riccati.set_weights(
            state_weight,
            input_weight,
            terminal_weight,
            &[[0.0; NU]; NU],
        );
        self.riccati.regulate().map_err(|_| LqrError::NotPositive)
    }

    /// `K_k`; zeros beyond the horizon.
    pub fn gain(&self, k: usize) -> [[f64; NX]; NU] {
        if k < self.horizon {
            self.riccati.gain(k)
        } else {
            [[0.0; NX]; NU]
        }
    }

    /// `P_0`: `x_0ᵀ P_0 x_0` is the cost of the horizon.
    pub fn cost_to_go(&self) -> [[f64; NX]; NX] {
        self.riccati.cost_to_go()
    }
}

fn largest<const R: usize, const C: usize>(m: &[[f64; C]; R]) -> f64 {
    m.iter().flatten().fold(0.0, |max: f64, v| {
        if v.is_nan() {
            f64::NAN
        } else {
            max.max(v.abs())
        }
    })
}

/// `Q + KᵀRK + (A + BK)ᵀ P (A + BK)`: the right-hand side of the equation at its optimal gain, without the cancellation of the usual form, to which an
/// error of K contributes in second order only (Anderson, Moore 1990, section 3.3).
fn closed_loop_cost<const NX: usize, const NU: usize>(
    a: &[[f64; NX]; NX],
    b: &[[f64; NU]; NX],
    q: &[[f64; NX]; NX],
    r: &[[f64; NU]; NU],
    k: &[[f64; NX]; NU],
    p: &[[f64; NX]; NX],
) -> [[f64; NX]; NX] {
    let (k, p) = (matrix(k), matrix(p));
    let closed = matrix(a) + matrix(b) * k;
    let cost = matrix(q) + k.transpose() * matrix(r) * k + closed.transpose() * p * closed;
    core::array::from_fn(|i| core::array::from_fn(|j| 0.5 * (cost[(i, j)] + cost[(j, i)])))
}

/// Largest difference, relative to the largest entry of the first.
fn distance<const N: usize>(a: &[[f64; N]; N], b: &[[f64; N]; N]) -> f64 {
    let size = largest(a).max(f64::MIN_POSITIVE);
    largest::<N, N>(&core::array::from_fn(|i| {
        core::array::from_fn(|j| a[i][j] - b[i][j])
    })) / size
}

fn matrix<const R: usize, const C: usize>(rows: &[[f64; C]; R]) -> SMatrix<f64, R, C> {
    SMatrix::from_fn(|i, j| rows[i][j])
}

/// The doubling iteration: with `W = I + G H`, `A⁺ = A W⁻¹ A`, `G⁺ = G + A W⁻¹ G Aᵀ`, `H⁺ = H + Aᵀ H W⁻¹ A`, from `G = B R⁻¹ Bᵀ`, `H = Q`;
/// H converges to P.
fn doubling<const NX: usize, const NU: usize>(
    a: &[[f64; NX]; NX],
    b: &[[f64; NU]; NX],
    q: &[[f64; NX]; NX],
    r: &[[f64; NU]; NU],
) -> Result<[[f64; NX]; NX], LqrError> {
    let (mut a, b, mut h, r) = (matrix(a), matrix(b), matrix(q), matrix(r));
    let cholesky = r.cholesky().ok_or(LqrError::NotPositive)?;
    let mut g = b * cholesky.solve(&b.transpose());
    for _ in 0..MAX_DOUBLINGS {
        let w = SMatrix::<f64, NX, NX>::identity() + g * h;
        let inverse = w.try_inverse().ok_or(LqrError::NotStabilizable(f64::NAN))?;
        let wa = inverse * a;
        let next = h + a.transpose() * h * wa;
        g += a * inverse * g * a.transpose();
        a *= wa;
        let change = (next - h).amax();
        h = (next + next.transpose()) * 0.5;
        g = (g + g.transpose()) * 0.5;
        if change <= 1e-15 * h.amax() || change.is_nan() {
            break;
        }
    }
    Ok(core::array::from_fn(|i| {
        core::array::from_fn(|j| h[(i, j)])
    }))
}

/// True if the powers of `A + B K` vanish.
fn is_stable<const NX: usize, const NU: usize>(
    a: &[[f64; NX]; NX],
    b: &[[f64; NU]; NX],
    k: &[[f64; NX]; NU],
) -> bool {
    let mut power = matrix(a) + matrix(b) * matrix(k);
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
