//! How far an iterate is from the solution, and whether the method still gets closer.

use super::super::certificate::allowed_gap;
use super::super::core::Core;
use super::super::lanes::Vector;
use super::run::{PATIENCE, Run, State};
#[cfg(not(feature = "std"))]
use crate::no_std::*;

/// A start is a bad one if its first residual exceeds `FAR`, and from the iteration `JUDGED` on if more than
/// `SLOW` of the residual is left per iteration (looked at in every third one) or if `PATIENCE` steps in a
/// row are shorter than `CRAWL`, while the residual is not yet `NEAR` its tolerance. Judged earlier, starts
/// are found bad where patience would have led to the solution sooner.
const JUDGED: usize = 14;
const FAR: f64 = 1e4;
const SLOW: f64 = 0.7;
pub(super) const CRAWL: f64 = 0.2;
pub(super) const NEAR: f64 = 1e3;
/// From this iteration on the best iterate is kept, and stalling is watched for; nearly all solves have ended
/// by then.
pub(super) const LATE: usize = 12;
/// Iterations between two looks at whether the residual still falls.
const STALL_PERIOD: usize = 6;

impl<V: Vector, const NX: usize, const NU: usize, const NR: usize> Core<V, NX, NU, NR> {
    /// True if the run has had its iterations; beyond the cap, a second start goes on only where the bounds
    /// are about to be kept, and every start with the iterations of later ones while it closes in on the
    /// solution: those would begin far from it.
    pub(super) fn is_over(&self, merit: f64, state: &State, run: &Run) -> bool {
        if merit <= NEAR && run.progress.1 < PATIENCE {
            return run.iterations >= run.budget;
        }
        let near = state.residual <= NEAR * self.settings.feasibility;
        run.iterations >= run.limit || run.iterations >= self.settings.max_iterations && !near
    }

    /// True if the start was a bad one.
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

    /// Multipliers of the iterate, as those of the solution or of the best iterate.
    pub(super) fn take_multipliers(&mut self, best: bool) {
        let [of_inputs, of_states] = if best { &mut self.best_multipliers } else { &mut self.multipliers };
        self.input_bounds.multipliers(of_inputs);
        self.state_bounds.multipliers(of_states);
        self.equalities.multipliers(of_states);
    }

    /// At most 1 if the tolerances are met.
    pub(super) fn merit(&self, state: &State, run: &Run) -> f64 {
        let (gap, residual) = (state.gap, state.residual);
        // Maxima drop NaN.
        if !(state.cost + state.quadratic + gap + residual).is_finite() {
            return f64::INFINITY;
        }
        let allowed = allowed_gap(self.settings.tolerance, state.cost, state.quadratic, self.negligible);
        let gap = gap.max(run.shrink * run.start_gap) / allowed;
        gap.max(residual / self.settings.feasibility)
    }

    /// Keeps the iterate if it is the best so far.
    pub(super) fn keep_best(&mut self, merit: f64, state: &State, run: &mut Run) {
        if merit < run.best.0 || run.best.0.is_infinite() {
            run.best = (merit, state.residual);
            self.best.copy_from(&self.iterate);
            self.take_multipliers(true);
        }
    }

    /// True if the residual of the bounds has ceased to fall, as it does where they cannot be kept.
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
