//! One step of the method: Newton system, affine step, centred and corrected step.

use super::super::barrier::Totals;
use super::super::core::{Core, Start};
use super::super::lanes::Vector;
use super::judge::CRAWL;
use super::run::{CAP_CUT, PATIENCE, Run, State};
#[cfg(not(feature = "std"))]
use crate::no_std::*;

/// Fraction of the step to the boundary: first value far from the optimum, second value close to the optimum.
const BOUNDARY_FRACTIONS: [f64; 2] = [0.995, 1.0 - 1e-5];
/// Step length below which a step counts as blocked. Pairs of slack s and multiplier λ whose product `sλ` is
/// far below the mean cause such steps. From `SETTLED` iterations after the start on, these products are then
/// raised to `LEAST_PRODUCT` times the mean.
const BLOCKED: f64 = 1e-2;
const LEAST_PRODUCT: f64 = 1e-2;
const SETTLED: usize = 8;
/// Centring parameter after [`PATIENCE`] iterations without progress.
const SAFE_CENTRING: f64 = 0.3;

impl<V: Vector, const NX: usize, const NU: usize, const NR: usize> Core<V, NX, NU, NR> {
    /// Computes the gradient of the cost, barrier terms and the right-hand side of the affine step.
    pub(super) fn linearize(&mut self, soft: bool) -> State {
        self.rows.evaluate(&mut self.iterate);
        let (quadratic, linear) = self.riccati.gradient(&self.iterate, &self.linear, &mut self.gradient);
        let (z, g, w, h) = (&self.iterate, &self.gradient, &mut self.weight, &mut self.rhs);
        let inputs = self.input_bounds.linearize(false, &z.u, &g.u, &mut w.u, &mut h.u);
        let states = self.state_bounds.linearize(soft, &z.x, &g.x, &mut w.x, &mut h.x);
        self.fixed.weigh(&mut w.u);
        self.equalities.weigh(&mut w.x);
        self.equalities.pull(&z.x, &mut h.x);
        self.rows.fold(h);
        let unmet = self.equalities.violation(&z.x);
        State {
            quadratic,
            cost: 0.5 * quadratic + linear + self.constant,
            gap: inputs.sum + states.sum,
            residual: inputs.max.max(states.max).max(unmet),
            force: states.force,
        }
    }

    /// Makes one iteration. Returns false, with an unchanged iterate, if the arithmetic failed.
    pub(super) fn advance(&mut self, state: &State, run: &mut Run) -> bool {
        if self.riccati.factorize(&self.weight, None, &self.rows).is_err() {
            // The reason is usually rounding relative to the largest barrier terms.
            run.cap *= CAP_CUT;
            run.stiffness *= CAP_CUT;
            return run.cap > 0.0;
        }
        self.solve_step();
        let (target, correction) = self.centring(state, run);
        self.input_bounds.centre(false, &self.gradient.u, target, correction, &mut self.rhs.u);
        self.state_bounds.centre(run.soft, &self.gradient.x, target, correction, &mut self.rhs.x);
        self.equalities.pull(&self.iterate.x, &mut self.rhs.x);
        self.rows.fold(&mut self.rhs);
        self.solve_step();
        let inputs = self.input_bounds.corrector(false, &self.step.u, target, correction);
        let states = self.state_bounds.corrector(run.soft, &self.step.x, target, correction);
        let boundary = inverse_step(&inputs, &states);
        // Close to the optimum, the step goes closer to the boundary. Superlinear convergence requires this (Wright
        // 1997, chapter 7).
        let fraction = 1.0
            - (state.gap / state.cost.abs()).clamp(1.0 - BOUNDARY_FRACTIONS[1], 1.0 - BOUNDARY_FRACTIONS[0]);
        let length = (fraction / boundary).min(1.0);
        if !length.is_finite() {
            return false;
        }
        self.input_bounds.advance(false, length);
        self.state_bounds.advance(run.soft, length);
        self.equalities.corrector(&self.iterate.x, &self.step.x);
        self.equalities.advance(length);
        self.iterate.advance(&self.step, length);
        run.shrink *= 1.0 - length;
        run.crawl = if length < CRAWL { run.crawl + 1 } else { 0 };
        if length < BLOCKED && run.iterations >= run.begun + SETTLED {
            let least = LEAST_PRODUCT * state.gap / run.count.max(1.0);
            self.input_bounds.recentre(least);
            self.state_bounds.recentre(least);
        }
        true
    }

    /// Computes the step for the right-hand side in memory.
    pub(super) fn solve_step(&mut self) {
        self.riccati.solve(&self.rhs, &mut self.step, None);
        self.rows.follow(&mut self.step);
    }

    /// Product `σμ` of slack and multiplier to which the centred step leads. μ is the mean product, and `σ =
    /// (μ_affine/μ)³` follows from the affine step (Mehrotra 1992). The second result is the factor of the
    /// second-order correction.
    fn centring(&mut self, state: &State, run: &Run) -> (f64, f64) {
        let inputs = self.input_bounds.predictor(false, &self.step.u);
        let states = self.state_bounds.predictor(run.soft, &self.step.x);
        let length = 1.0 / inverse_step(&inputs, &states).max(1.0);
        let affine = (1.0 - length) * state.gap + length * length * (inputs.sum + states.sum);
        // Without complementarity pairs no centring is needed.
        let ratio = if state.gap > 0.0 { (affine / state.gap).clamp(0.0, 1.0) } else { 0.0 };
        let mu = state.gap / run.count.max(1.0);
        if run.progress.1 >= PATIENCE || run.start == Start::Deep {
            (SAFE_CENTRING * mu, 0.0)
        } else {
            (ratio * ratio * ratio * mu, length.sqrt())
        }
    }
}

/// Inverse of the step to the boundary.
fn inverse_step(inputs: &Totals, states: &Totals) -> f64 {
    inputs.max.max(states.max)
}
