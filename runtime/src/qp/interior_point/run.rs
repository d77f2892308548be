//! Runs of the method, with their state from one iteration to the next.

use super::super::core::Start;

/// Limit of a barrier term relative to the largest multiplier of a state. An absolute limit also exists, and
/// the larger limit applies. A smaller value would slow the growth of large multipliers.
pub(super) const STIFFNESS: f64 = 1e6;
/// Factor of both limits of the barrier terms if a factorization failed or its steps were inexact because of rounding.
pub(super) const CAP_CUT: f64 = 1e-2;
/// Number of iterations without progress after which the second-order correction is omitted, because the
/// method can cycle with it (Cartis, *Some disadvantages of a Mehrotra-type primal-dual corrector interior
/// point algorithm*, Appl. Numer. Math. 59, 2009).
pub(super) const PATIENCE: usize = 3;

/// State at the start of an iteration.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct State {
    /// Quadratic part `zᵀHz` of the cost with the Hessian H at the iterate z.
    pub(super) quadratic: f64,
    /// Cost at the iterate.
    pub(super) cost: f64,
    /// Sum `Σ sλ` over slacks s and multipliers λ.
    pub(super) gap: f64,
    /// Largest residual of a bound or row.
    pub(super) residual: f64,
    /// Largest multiplier of a bound or row.
    pub(super) force: f64,
}

/// State of a run of the method from one iteration to the next.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    pub(super) start: Start,
    /// Whether [`Core::restart`] was called. A run has at most one restart.
    pub(super) restarted: bool,
    /// Number of iterations before the present start. It is 0, or the number of iterations up to the restart.
    pub(super) begun: usize,
    /// Number of consecutive steps shorter than `CRAWL`.
    pub(super) crawl: usize,
    /// Whether the problem has soft bounds or rows.
    pub(super) soft: bool,
    /// Number of complementarity pairs, for example of a slack and its multiplier.
    pub(super) count: f64,
    /// Gap at the start of the run.
    pub(super) start_gap: f64,
    /// Largest diagonal term of the Newton system.
    pub(super) cap: f64,
    /// Largest diagonal term relative to the largest multiplier.
    pub(super) stiffness: f64,
    /// Share `Π (1 − α)` of the dual residual that remains after steps of the lengths α.
    pub(super) shrink: f64,
    pub(super) iterations: usize,
    /// Number of iterations after which the present start ends.
    pub(super) limit: usize,
    pub(super) budget: usize,
    /// Smallest merit so far, and the residual of the same iterate. This iterate is in memory.
    pub(super) best: (f64, f64),
    /// Residual at the last test for stalling.
    pub(super) checkpoint: f64,
    /// A merit, and the number of iterations since it was reached. The next merit that is stored is below 90
    /// % of it.
    pub(super) progress: (f64, usize),
    /// A merit, and the number of iterations since it was reached. The next merit that is stored is below 50
    /// % of it.
    pub(super) pace: (f64, usize),
}

impl Run {
    pub(super) fn new(start: Start, soft: bool, cap: usize, budget: usize) -> Self {
        Self {
            start,
            restarted: false,
            begun: 0,
            crawl: 0,
            soft,
            count: 0.0,
            start_gap: 0.0,
            cap: 0.0,
            stiffness: STIFFNESS,
            shrink: 1.0,
            iterations: 0,
            limit: cap.min(budget),
            budget,
            best: (f64::INFINITY, f64::INFINITY),
            checkpoint: f64::INFINITY,
            progress: (f64::INFINITY, 0),
            pace: (f64::INFINITY, 0),
        }
    }

    pub(super) fn note(&mut self, merit: f64) {
        let since = |(last, count): (f64, usize), share: f64| {
            if merit < share * last { (merit, 0) } else { (last, count + 1) }
        };
        self.progress = since(self.progress, 0.9);
        self.pace = since(self.pace, 0.5);
    }
}
