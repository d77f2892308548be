//! Tests of the distance of an iterate from the solution, and of the progress of the method.

use super::super::certificate::allowed_gap;
use super::super::core::Core;
use super::super::lanes::Vector;
use super::run::{PATIENCE, Run, State};
#[cfg(not(feature = "std"))]
use crate::no_std::*;

/// Constants of the test for a bad start. While the residual is not yet `NEAR` its tolerance, a start is bad in three
/// cases:
///
/// - Its first residual exceeds `FAR`.
/// - More than the share `SLOW` of the residual remains per iteration. This is tested in every third iteration from
///   iteration `JUDGED` on. An earlier test would reject starts that lead to the solution sooner.
/// - `PATIENCE` consecutive steps are shorter than `CRAWL`.
const JUDGED: usize = 14;
const FAR: f64 = 1e4;
const SLOW: f64 = 0.7;
pub(super) const CRAWL: f64 = 0.2;
pub(super) const NEAR: f64 = 1e3;
/// First iteration in which the best iterate is stored and stalling is tested. Nearly all solves end earlier.
pub(super) const LATE: usize = 12;
/// Number of iterations between two tests whether the residual still decreases.
const STALL_PERIOD: usize = 6;

impl<V: Vector, const NX: usize, const NU: usize, const NR: usize> Core<V, NX, NU, NR> {
    /// Whether the run has used its iterations. Beyond its limit, a run only continues if the bounds are nearly kept. A run
    /// that approaches the solution may use the iterations of later starts, because later starts would begin far from the
    /// solution.
    pub(super) fn is_over(&self, merit: f64, state: &State, run: &Run) -> bool {
        if merit <= NEAR && run.progress.1 < PATIENCE {
            return run.iterations >= run.budget;
        }
        let near = state.residual <= NEAR * self.settings.feasibility;
        run.iterations >= run.limit || run.iterations >= self.settings.max_iterations && !near
    }

    /// Whether the start is bad: its residual is too large or decreases too slowly, or its steps are too
    /// short ([`JUDGED`]).
    pub(super) fn is_slow(&self, state: &State, run: &Run) -> bool {
        if state.residual <= NEAR * self.settings.feasibility
            || (run.iterations > 0 && run.iterations < JUDGED)
        {
            return false;
        }
        let far = run.iterations == 0 && state.residual > FAR;
        let expected = SLOW.powi(run.iterations as i32);
        far || run.crawl >= PATIENCE
            || run.iterations > 0 && run.iterations.is_multiple_of(3) && run.shrink > expected
    }

    /// Stores the multipliers of the iterate as those of the solution, or of the best iterate if `best` is
    /// true.
    pub(super) fn take_multipliers(&mut self, best: bool) {
        let [of_inputs, of_states] = if best { &mut self.best_multipliers } else { &mut self.multipliers };
        self.input_bounds.multipliers(of_inputs);
        self.state_bounds.multipliers(of_states);
        self.equalities.multipliers(of_states);
    }

    /// Largest ratio of gap and residual to their tolerances, at most 1 for a solution.
    pub(super) fn merit(&self, state: &State, run: &Run) -> f64 {
        let (gap, residual) = (state.gap, state.residual);
        // Maxima ignore NaN, so the sum is tested.
        if !(state.cost + state.quadratic + gap + residual).is_finite() {
            return f64::INFINITY;
        }
        let allowed = allowed_gap(self.settings.tolerance, state.cost, state.quadratic, self.negligible);
        let gap = gap.max(run.shrink * run.start_gap) / allowed;
        gap.max(residual / self.settings.feasibility)
    }

    /// Stores the iterate if it is the best so far.
    pub(super) fn keep_best(&mut self, merit: f64, state: &State, run: &mut Run) {
        if merit < run.best.0 || run.best.0.is_infinite() {
            run.best = (merit, state.residual);
            self.best.copy_from(&self.iterate);
            self.take_multipliers(true);
        }
    }

    /// Whether the residual of the bounds no longer decreases, for example because the bounds cannot be kept.
    pub(super) fn stalled(&self, state: &State, run: &mut Run) -> bool {
        let iterations = run.iterations - run.begun;
        if iterations < LATE || !iterations.is_multiple_of(STALL_PERIOD) {
            return false;
        }
        let stalled =
            state.residual > NEAR * self.settings.feasibility && state.residual > 0.5 * run.checkpoint;
        run.checkpoint = state.residual;
        stalled
    }
}
