//! Report and settings of a solve.

use thiserror::Error;

/// Status of a solve. The status follows from the residuals of the returned point. The inputs of this point are within
/// their bounds, and its states are computed from the inputs. Cost and gradient are computed from the data of the problem. A
/// number that is not finite counts as a failure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum QpStatus {
    /// The returned point is optimal within the tolerances of [`QpSettings`]. The hard bounds are kept, also if the states
    /// are computed with other rounding errors. The cost exceeds the optimum by at most the allowed gap.
    Solved,
    /// The hard state bounds or rows cannot be kept, or no point that keeps them was found within the iteration limit. The
    /// returned inputs keep their bounds, and minimize the violation by an exact penalty.
    Relaxed,
    /// The problem was not solved, for one of these reasons:
    ///
    /// - The iteration limit was reached.
    /// - Rounding errors prevent further steps.
    /// - The dynamics amplify rounding errors until a hard bound is violated. The residuals do not show this violation.
    ///
    /// The returned point is the best point of all attempts. It is the point with the lowest cost that keeps the bounds. If
    /// no point keeps the bounds, it is the point with the smallest residuals. The inputs keep their bounds. The KKT
    /// residuals show the distance from the optimum.
    IterationLimit,
    /// The QP is not convex, a number is not finite, a lower bound is above its upper bound, or the arithmetic failed. The
    /// returned inputs are the values nearest to zero within the bounds.
    Invalid,
}

/// Residuals of the Karush–Kuhn–Tucker (KKT) conditions at the returned point, as largest absolute values.
/// The multipliers are never negative, so dual feasibility has no residual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KktResiduals {
    /// Stationarity: largest entry of the gradient of the Lagrangian with respect to the inputs. The costates are
    /// eliminated by their recursion.
    pub stationarity: f64,
    /// Largest violation of the hard bounds and rows by the states that follow from the inputs. The violation is relative
    /// to the bound if the magnitude of the bound exceeds 1. A row is scaled by its largest coefficient. The inputs keep
    /// their bounds exactly.
    pub primal: f64,
    /// Upper bound of the difference between the cost and the optimum, in units of the cost. It is the duality gap of
    /// bounds and rows plus the decrease that a Newton step would give. Distances to a bound below 9e-16 count as zero.
    /// They are relative to the bound if the magnitude of the bound exceeds 1.
    pub gap: f64,
}

/// Result of one solve: status, iterations, cost and residuals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QpReport {
    /// Status of the returned point.
    pub status: QpStatus,
    /// Number of iterations of all starts (cold and warm) and of the method of multipliers. Each iteration makes one
    /// factorization. The number is 0 if no bound is active at the optimum and no bound was active at the last solution.
    pub iterations: usize,
    /// Cost of the returned point. It includes the penalties of soft bounds and rows, but not the constant
    /// cost of x_0.
    pub cost: f64,
    /// Residuals of the returned point.
    pub residuals: KktResiduals,
}

/// Tolerances and iteration limit of the solver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QpSettings {
    /// Duality gap at which the iteration stops, relative to the cost including penalties. If quadratic and linear terms
    /// of the cost cancel, the gap is relative to 5e-5 times the quadratic terms.
    ///
    /// A gap up to `w f² + 9e-16 w₁` always counts as zero, so that optima with the cost 0 are found. Here w is the largest
    /// entry of the weights, f is [`Self::feasibility`], and w₁ is the largest linear penalty. This gap is the cost of a
    /// change of one variable by f, plus the cost of a rounding error at a soft bound of size 1.
    pub tolerance: f64,
    /// Largest allowed violation of a hard bound or row by the returned states. The violation is relative to the bound if
    /// the magnitude of the bound exceeds 1, otherwise it is in units of the variable. A row is scaled by its largest
    /// coefficient. If the states are computed with other rounding errors, they keep the bounds within 1e4 times this
    /// value.
    pub feasibility: f64,
    /// Limit of the interior-point iterations of each start. A start that is close to the solution may use the iterations
    /// of later starts. If a start fails, other starts follow. The last attempt is the method of multipliers with the same
    /// limit. In total, a cold start takes at most three times this number of iterations. A warm start takes at most 16
    /// more iterations.
    pub max_iterations: usize,
}

impl Default for QpSettings {
    /// Tolerance 1e-8, feasibility 1e-10, and at most 50 iterations.
    fn default() -> Self {
        Self { tolerance: 1e-8, feasibility: 1e-10, max_iterations: 50 }
    }
}

/// Error of the construction of a solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum QpError {
    /// The horizon is not in 1..=100.
    #[error("the horizon is {0} stages, but must be 1 to 100")]
    Horizon(usize),
    /// `NX` is not in 1..=32, `NU` is not in 1..=32, or `NR` is not in 0..=32.
    #[error(
        "the size of the QP is out of range. It must have 1 to 32 states, 1 to 32 inputs and at most 32 rows per stage"
    )]
    Size,
}
