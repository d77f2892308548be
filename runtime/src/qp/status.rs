//! Report and settings of a solve.

use thiserror::Error;

/// Status of a solve. The residuals of the returned point decide it: the inputs are within their bounds, the
/// states are computed from the inputs, and cost and gradient from the data of the problem. A number that is
/// not finite counts as a failure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum QpStatus {
    /// The returned point is optimal to the tolerances of [`QpSettings`]. The hard bounds are kept, also by
    /// states that are computed with another order of rounding. The cost is proven to exceed the optimum at
    /// most by the allowed gap.
    Solved,
    /// The hard state bounds or rows cannot be kept, or no point that keeps them was found within the limit
    /// of iterations. The returned inputs minimize the violation by an exact penalty and keep their own
    /// bounds.
    Relaxed,
    /// The problem was not solved. Reasons are: the limit of iterations was reached, rounding allows no
    /// further step, or the dynamics amplify rounding errors until a hard bound is violated, which the
    /// residuals do not show. Of the points of all attempts, the one with the least cost that keeps the
    /// bounds is returned, or else the one with the smallest residuals. The inputs keep their bounds. The KKT
    /// residuals show the distance from the optimum.
    IterationLimit,
    /// The data are not a convex QP with finite numbers and ordered bounds, or the arithmetic failed. The
    /// returned inputs are those nearest to zero within their bounds.
    Invalid,
}

/// Residuals of the Karush–Kuhn–Tucker (KKT) conditions at the returned point, as largest absolute values.
/// The multipliers are never negative, so dual feasibility has no residual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KktResiduals {
    /// Stationarity: the gradient of the Lagrangian with respect to the inputs. The costates are eliminated
    /// by their recursion.
    pub stationarity: f64,
    /// Violation of the hard bounds and rows by the states that follow from the inputs. It is relative to the
    /// bound if the magnitude of the bound exceeds 1. A row is scaled by its largest coefficient. The inputs
    /// keep their bounds.
    pub primal: f64,
    /// Upper bound of the distance of the cost from the optimum, in units of the cost: the duality gap of
    /// bounds and rows plus the decrease that a Newton step would give. Distances to a bound below 9e-16
    /// count as zero, relative to the bound if its magnitude exceeds 1.
    pub gap: f64,
}

/// Result of one solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QpReport {
    /// Status of the returned point.
    pub status: QpStatus,
    /// Number of iterations of all starts, cold and warm, and of the method of multipliers. Each iteration is
    /// one factorization. 0 if no bound is active at the optimum and no bound was active at the last
    /// solution.
    pub iterations: usize,
    /// Cost of the returned point. It includes the penalties of soft bounds and rows, but not the constant
    /// cost of x_0.
    pub cost: f64,
    /// Residuals of the returned point.
    pub residuals: KktResiduals,
}

/// Tolerances and the limit of iterations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QpSettings {
    /// Duality gap at which the iteration stops, relative to the cost with its penalties, or to 5e-5 of its
    /// quadratic terms if these are canceled by the linear terms. A gap up to `w f² + 9e-16 w₁` always counts
    /// as zero, so that optima with the cost 0 are found. w is the largest entry of the weights, f is
    /// [`Self::feasibility`], and w₁ is the largest linear penalty. This gap is the cost of a change of one
    /// variable by f, or of a violation of a soft bound of size 1 by rounding.
    pub tolerance: f64,
    /// Largest violation of a hard bound or row by the returned states. It is relative to the bound if the
    /// magnitude of the bound exceeds 1, otherwise in units of the variable. The value 1e-10 is at most 1e-6
    /// of every bound from 1e-4 on. A row is scaled by its largest coefficient. States that are computed with
    /// another order of rounding keep the bounds to 1e4 times this value.
    pub feasibility: f64,
    /// Limit of the interior-point iterations of each start. A start that is close to the solution may use
    /// the iterations of later starts. If a start fails, other starts follow. The last attempt is the method
    /// of multipliers with the same limit. Altogether a solve takes at most three times this number of
    /// iterations with a cold start, and 16 more with a warm start.
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
    #[error("horizon is {0} stages; it must be 1 to 100")]
    Horizon(usize),
    /// `NX` is not in 1..=32, `NU` is not in 1..=32, or `NR` is not in 0..=32.
    #[error("a QP needs 1 to 32 states, 1 to 32 inputs and at most 32 rows per stage")]
    Size,
}
