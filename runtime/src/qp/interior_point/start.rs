//! Points from which the method starts and restarts.

use super::super::core::{Core, Start};
use super::super::lanes::Vector;
use super::super::ldl::NotPositive;
use super::run::Run;

/// Gap at the start, relative to an estimate of the cost of keeping the bounds. The gap is large, because a start far
/// inside the bounds takes fewer iterations than a start near the boundary.
const START_GAP: f64 = 100.0;
/// Gap at a start near the last solution, relative to the cost. In the benchmark `control_step`, the value 1 takes up to
/// 23 % more iterations, and the value 0.01 up to 8 % more.
const NEAR_GAP: f64 = 0.1;
/// Smallest slack at the start, relative to the distance between the bounds.
const START_SLACK: f64 = 0.1;
/// Largest barrier term of the Newton system, relative to the largest weight of the cost.
const WEIGHT_CAP: f64 = 1e10;
/// Penalty of a violated bound in a relaxed problem, relative to the largest gradient or weight of the cost.
const RELAXATION: f64 = 1e5;
/// Smallest penalty of a violated hard bound, relative to the steepest penalty of a soft bound. With a smaller penalty, the
/// optimum could violate a hard bound to keep a soft bound.
const ABOVE_SOFT: f64 = 1e3;

impl<V: Vector, const NX: usize, const NU: usize, const NR: usize> Core<V, NX, NU, NR> {
    /// Computes the optimum without bounds by one factorization.
    pub(super) fn unconstrained(&mut self) -> Result<(), NotPositive> {
        self.weight.clear();
        self.fixed.weigh(&mut self.weight.u);
        self.riccati.factorize(&self.weight, Some(&self.affine), &self.rows)?;
        self.rhs.copy_from(&self.linear);
        self.fixed.attract(&mut self.rhs.u);
        self.riccati.solve(&self.rhs, &mut self.iterate, Some(&self.affine));
        self.fixed.place(&mut self.iterate.u);
        self.rows.evaluate(&mut self.iterate);
        Ok(())
    }

    /// Sets slacks and multipliers of the first iterate.
    pub(super) fn begin(&mut self, run: &mut Run) {
        let gap = match run.start {
            Start::Near => NEAR_GAP * self.cost().abs(),
            _ => START_GAP * self.excess_energy(),
        };
        run.cap = WEIGHT_CAP * self.riccati.largest;
        self.input_bounds.cap_weights(f64::INFINITY);
        self.cap_weights(run.cap);
        self.equalities.start((run.start == Start::Near).then_some(&self.multipliers[1]));
        self.set_slacks(gap, run);
    }

    /// Computes slacks from the iterate, and multipliers for which the sum of the products of slacks and
    /// multipliers equals `gap`.
    fn set_slacks(&mut self, gap: f64, run: &mut Run) {
        run.count = self.input_bounds.count() + self.state_bounds.count();
        let mu = if gap > 0.0 { gap / run.count.max(1.0) } else { 1.0 };
        run.start_gap = mu * run.count;
        run.shrink = 1.0;
        let far = run.restarted;
        let last = |side: usize| (run.start == Start::Near).then_some(&self.multipliers[side]);
        self.input_bounds.start(false, &self.iterate.u, mu, START_SLACK, far, last(0));
        self.state_bounds.start(run.soft, &self.iterate.x, mu, START_SLACK, far, last(1));
    }

    /// Restarts from a point as deep inside the bounds as the dynamics allow. The scale of the gap is the whole cost of this
    /// point. The usual scale is the cost of moving the optimum without bounds into the bounds. If this optimum is far outside
    /// the bounds, the usual scale is not suitable, and the method proceeds slowly along the boundary.
    pub(super) fn restart(&mut self, run: &mut Run) {
        if run.iterations > 0 {
            self.iterate.copy_from(&self.best);
        }
        run.iterations += 1;
        run.restarted = true;
        run.begun = run.iterations;
        run.limit = (run.begun + self.settings.max_iterations).min(run.budget);
        run.crawl = 0;
        // The progress of the second start is measured independently of the first start.
        (run.progress, run.pace) = ((f64::INFINITY, 0), (f64::INFINITY, 0));
        run.checkpoint = f64::INFINITY;
        let mut size = self.scale();
        let most = 10.0 * size * run.count.max(1.0);
        let mut level = size;
        for _ in 0..4 {
            if self.centre(size).is_ok() {
                self.riccati.solve(&self.rhs, &mut self.iterate, Some(&self.affine));
                self.fixed.place(&mut self.iterate.u);
                self.rows.evaluate(&mut self.iterate);
                level = self.scale();
                if level <= most {
                    break;
                }
            }
            size *= 1e-3;
        }
        self.equalities.start(None);
        self.set_slacks(START_GAP * level, run);
        run.best = (f64::INFINITY, f64::INFINITY);
    }

    /// Magnitude of the cost at the iterate, with penalties.
    fn scale(&mut self) -> f64 {
        self.cost().abs() + self.state_bounds.penalty(&self.iterate.x, true)
    }

    fn centre(&mut self, size: f64) -> Result<(), NotPositive> {
        self.weight.clear();
        self.rhs.copy_from(&self.linear);
        let (w, h) = (&mut self.weight, &mut self.rhs);
        self.input_bounds.attract(size, &mut w.u, &mut h.u);
        self.state_bounds.attract(size, &mut w.x, &mut h.x);
        self.equalities.attract(&mut w.x, &mut h.x);
        self.fixed.weigh(&mut w.u);
        self.fixed.attract(&mut h.u);
        self.rows.attract(w, h);
        self.rows.fold(h);
        self.riccati.factorize(&self.weight, Some(&self.affine), &self.rows)
    }

    fn cap_weights(&mut self, cap: f64) {
        self.state_bounds.cap_weights(cap);
        self.equalities.cap_weights(cap);
    }

    /// Cost of the iterate, without penalties.
    fn cost(&mut self) -> f64 {
        let (quadratic, linear) = self.riccati.gradient(&self.iterate, &self.linear, &mut self.gradient);
        0.5 * quadratic + linear + self.constant
    }

    /// Scale of the multipliers. It is an estimate of the cost of moving each number of the iterate into its bounds and rows.
    /// The iterate must be the optimum without bounds.
    fn excess_energy(&mut self) -> f64 {
        self.step.copy_from(&self.iterate);
        self.input_bounds.clip(&mut self.step.u);
        self.state_bounds.clip(&mut self.step.x);
        self.equalities.place(&mut self.step.x);
        self.step.advance(&self.iterate, -1.0);
        if NR > 0 {
            self.rows.move_along(&mut self.step);
            self.fixed.hold(&mut self.step.u);
        }
        self.rhs.clear();
        let (quadratic, _) = self.riccati.gradient(&self.step, &self.rhs, &mut self.gradient);
        0.5 * quadratic + self.riccati.input_energy(&self.step)
    }

    /// Replaces all hard state bounds and rows by exact penalties. The unconstrained optimum must be in memory.
    pub(super) fn soften(&mut self) {
        self.riccati.gradient(&self.iterate, &self.linear, &mut self.gradient);
        let mut slope = self.gradient.largest_state();
        if NR > 0 {
            slope = slope.max(self.gradient.largest_input());
        }
        let weight = RELAXATION * slope.max(self.riccati.largest);
        let weight = weight.max(ABOVE_SOFT * self.state_bounds.steepest());
        let bounds = &mut self.state_bounds;
        self.equalities.release(|i, value| bounds.set(i, value, value, None));
        self.state_bounds.soften(weight);
        self.softened = true;
    }
}
