//! Report and settings of a solve.

use thiserror::Error;

/// How a solve ended. Decided by the residuals of the point that is returned: inputs within their bounds,
/// states rolled out from them, cost and gradient from the problem's own data. A number that is not finite
/// counts as a failure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum QpStatus {
    /// The optimum, to the tolerances of [`QpSettings`]: hard bounds are kept, also by states whose sums are rounded
    /// otherwise, and the cost is proven to lie no further above the least one.
    Solved,
    /// The hard state bounds or rows cannot be kept (or no point that keeps them was found within the cap): the
    /// inputs returned minimize the violation by an exact penalty and keep their own bounds.
    Relaxed,
    /// The cap on iterations was reached, or rounding allows no further step, or the dynamics let rounding grow
    /// until a hard bound is violated (residuals do not show that). Of the points that all starts
    /// led to, the cheapest one that keeps the bounds is returned, or else the one with the smallest
    /// residuals. The inputs keep their bounds, the KKT residuals tell how far they are from the optimum.
    IterationLimit,
    /// The data are not a convex QP with finite numbers and ordered bounds, or the arithmetic broke down: the
    /// inputs returned are those nearest zero within their bounds.
    Invalid,
}

/// Residuals of the Karush–Kuhn–Tucker conditions at the point returned, largest absolute values. The
/// multipliers are never negative, so dual feasibility has no residual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KktResiduals {
    /// Stationarity: the gradient of the Lagrangian with respect to the inputs, the costates eliminated by
    /// their own recursion.
    pub stationarity: f64,
    /// Violation of the hard bounds and rows by the states rolled out through the dynamics, relative to the
    /// bound where that exceeds 1; a row counts as divided by its largest coefficient. The inputs keep their
    /// bounds.
    pub primal: f64,
    /// How far the cost may lie above the optimum: the duality gap of bounds and rows, and what a Newton step
    /// would still gain. In units of the cost. Distances to a bound below 9e-16 count as none, relative to the bound
    /// where its magnitude exceeds 1.
    pub gap: f64,
}

/// Result of one solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QpReport {
    /// How it ended.
    pub status: QpStatus,
    /// Iterations, each one factorization, of all starts, warm ones included, and of the method of multipliers
    /// together; 0 if no bound is active at the optimum and none was at the last one.
    pub iterations: usize,
    /// Cost of the iterate returned, penalties of soft bounds and rows included, the constant cost of x_0 not.
    pub cost: f64,
    /// Residuals at the iterate returned.
    pub residuals: KktResiduals,
}

/// Tolerances and caps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QpSettings {
    /// Duality gap at which the iteration stops, relative to the cost with its penalties, or to 5e-5 of its quadratic
    /// terms where these cancel. A gap up to `w f² + 9e-16 w₁` counts as none, so that optima without cost are
    /// found: w is the largest entry of the weights, f [`Self::feasibility`], and w₁ the largest linear penalty.
    /// That is what moving one variable by f costs, or one of size 1 by rounding past its soft bound.
    pub tolerance: f64,
    /// Largest violation of a hard bound or row by the states returned, relative to the bound where its magnitude
    /// exceeds 1, else in units of the variable: 1e-10 is at most 1e-6 of every bound from 1e-4 on. A row counts
    /// as divided by its largest coefficient. States that are rolled out with sums rounded otherwise keep the bounds to
    /// 1e4 times this.
    pub feasibility: f64,
    /// Cap on interior-point iterations of each start. A start that closes in on the solution goes on with those of
    /// later ones. Where a start leads nowhere, others follow, and the
    /// method of multipliers last, with as many again: a solve takes at most three times as many iterations
    /// from a cold start, and four more from a warm one.
    pub max_iterations: usize,
}

impl Default for QpSettings {
    /// Tolerance 1e-8, feasibility 1e-10, at most 50 iterations.
    fn default() -> Self {
        Self { tolerance: 1e-8, feasibility: 1e-10, max_iterations: 50 }
    }
}

/// A solver cannot be constructed with these sizes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum QpError {
    /// The horizon must be 1..=100.
    #[error("horizon is {0} stages; it must be 1 to 100")]
    Horizon(usize),
    /// `NX` must be 1..=32, `NU` 1..=32 and `NR` 0..=32.
    #[error("a QP needs 1 to 32 states, 1 to 32 inputs and at most 32 rows per stage")]
    Size,
}
