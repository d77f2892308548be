//! Certificate of the returned point: cost and residuals, computed from the data of the problem.
//!
//! The iteration decides when a point is tested. This module decides whether the problem is solved. For inputs within
//! their bounds, and states that follow from these inputs, the cost is at most `Σ gap + ½ ‖g‖²` above the optimum. The
//! first term is the sum of the gaps of bounds and rows by Fenchel's inequality. The second term is the decrease that a
//! Newton step would give along the remaining gradient g of the Lagrangian (Boyd, Vandenberghe, *Convex
//! Optimization*, 2004, sections 5.5 and 9.5).

use super::certificate::{Certificate, allowed_gap};
use super::core::Core;
use super::lanes::Vector;
use super::problem::QpProblem;
use super::status::KktResiduals;

/// Largest violation of a hard bound in a second roll-out with other rounding, relative to the tolerance of the first
/// roll-out.
const ROUNDED: f64 = 1e4;

impl<V: Vector, const NX: usize, const NU: usize, const NR: usize> Core<V, NX, NU, NR> {
    /// Makes the iterate the solution, with the multipliers in memory. Clamps the inputs to their bounds and computes the
    /// states from the dynamics. Needs a factorization. Overwrites `gradient`, `rhs` and `step`.
    pub(super) fn certify(&mut self, problem: &QpProblem<NX, NU, NR>) -> Certificate {
        self.solution.copy_from(&self.iterate);
        self.riccati.project(&mut self.solution, &self.affine, |k, u| {
            let stage = &problem.stages[k];
            // `max` and `min` would replace NaN by a bound, so `clamp` is used.
            core::array::from_fn(|i| u[i].clamp(stage.input_lower[i], stage.input_upper[i]))
        });
        self.rows.evaluate(&mut self.solution);
        let z = &self.solution;
        let (quadratic, linear) = self.riccati.gradient(z, &self.linear, &mut self.gradient);
        let cost = 0.5 * quadratic + linear + self.constant;
        let [of_inputs, of_states] = &mut self.multipliers;
        of_inputs.subtract_from(&mut self.gradient.u);
        of_states.subtract_from(&mut self.gradient.x);
        self.rows.fold(&mut self.gradient);
        let decrease = self.riccati.decrease(&self.gradient, &mut self.rhs);
        self.riccati.reduce(&mut self.gradient);
        self.fixed.absorb(&mut self.gradient.u, of_inputs);
        let gap = self.input_bounds.gap(&z.u, of_inputs)
            + self.state_bounds.gap(&z.x, of_states)
            + self.equalities.gap(&z.x, of_states);
        let hard = self.state_bounds.violation(&z.x, true);
        let residuals = KktResiduals {
            stationarity: self.gradient.largest_input(),
            primal: hard.max(self.equalities.violation(&z.x)),
            gap: gap + decrease,
        };
        let penalty = self.state_bounds.penalty(&z.x, false);
        let of_all = self.state_bounds.penalty(&z.x, true);
        let penalized = cost + of_all;
        let allowed = allowed_gap(self.settings.tolerance, penalized, quadratic, self.negligible);
        // Maxima ignore NaN. Sums over all inputs and states do not.
        let finite = (penalized + quadratic + decrease + gap).is_finite();
        Certificate {
            cost: cost + penalty,
            residuals,
            decrease,
            allowed,
            merit: if finite {
                merit(&residuals, allowed, self.settings.feasibility, of_all - penalty)
            } else {
                f64::INFINITY
            },
        }
    }

    /// Whether the solution keeps its hard bounds and rows within [`ROUNDED`] times their tolerance if the sums of the
    /// roll-out are rounded differently. If the dynamics amplify rounding errors too much, the order of the sums decides
    /// whether the bounds are kept. Such a solution is not reliable.
    pub(super) fn survives_rounding(&mut self) -> bool {
        self.step.copy_from(&self.solution);
        self.riccati.roll_out_otherwise(&mut self.step, &self.affine);
        self.rows.evaluate(&mut self.step);
        self.step.advance(&self.solution, -1.0);
        let allowed = ROUNDED * self.settings.feasibility;
        // This is nearly always the case, because the solution violates the bounds by less than half of `allowed`.
        if self.step.largest_state() <= 0.5 * allowed {
            return true;
        }
        // Another order of the sums can change the states in both directions.
        self.violation_beside(1.0).max(self.violation_beside(-1.0)) <= allowed
    }

    /// Largest violation of a hard bound or row at the solution plus `length` times `step`.
    fn violation_beside(&mut self, length: f64) -> f64 {
        self.rhs.copy_from(&self.solution);
        self.rhs.advance(&self.step, length);
        let x = &self.rhs.x;
        self.state_bounds.violation(x, true).max(self.equalities.violation(x))
    }
}

/// Largest ratio of a residual to its tolerance. `penalty` is the cost of violations of hard bounds that were softened; 0
/// if no bound was softened. If the penalty exceeds the gap, the optimum of the softened problem also violates these
/// bounds, and the violation is not a residual.
fn merit(residuals: &KktResiduals, allowed: f64, feasibility: f64, penalty: f64) -> f64 {
    let r = residuals;
    if !(r.stationarity + r.primal + r.gap + allowed).is_finite() {
        return f64::INFINITY;
    }
    // Gap and allowed gap can both be zero if the cost is zero.
    let gap = if r.gap <= 0.0 { 0.0 } else { r.gap / allowed };
    if penalty > r.gap.max(0.0) { gap } else { gap.max(r.primal / feasibility) }
}
