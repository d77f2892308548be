//! What a point is worth that the solver returns: cost and residuals of exactly this point, from the
//! problem's own data.
//!
//! The method's own quantities tell when to look; whether a problem counts as solved is decided here. With
//! inputs in their bounds and states rolled out from them, the cost is at most `Σ gap + ½ ‖g‖²` above the
//! optimum: the gaps of bounds and rows by Fenchel's inequality, and what a Newton step would gain from the
//! gradient g of the Lagrangian that is left (Boyd, Vandenberghe, *Convex Optimization*, 2004, sections 5.5
//! and 9.5).

use super::certificate::{Certificate, cost_scale};
use super::core::Core;
use super::lanes::Vector;
use super::problem::QpProblem;
use super::status::{KktResiduals, QpSettings};

impl<V: Vector, const NX: usize, const NU: usize, const NR: usize> Core<V, NX, NU, NR> {
    /// Makes the iterate the solution, with the multipliers in memory: inputs into their bounds, states from
    /// the dynamics. Needs a factorization; overwrites `gradient`, `rhs` and `step`. `least` is a scale of
    /// the cost below which nothing counts.
    #[inline(always)]
    pub(super) fn certify(&mut self, problem: &QpProblem<NX, NU, NR>, least: f64) -> Certificate {
        self.solution.copy_from(&self.iterate);
        self.riccati.project(&mut self.solution, &self.affine, |k, u| {
            let stage = &problem.stages[k];
            // Not by max and min, which would make NaN a bound.
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
        let penalized = cost + self.state_bounds.penalty(&z.x, true);
        let scale = cost_scale(penalized, quadratic, least);
        // Largest values drop NaN; sums over all inputs and states do not.
        let finite = (penalized + quadratic + decrease + gap).is_finite();
        Certificate {
            cost: cost + self.state_bounds.penalty(&z.x, false),
            residuals,
            decrease,
            merit: if finite {
                merit(&residuals, scale, &self.settings, self.softened)
            } else {
                f64::INFINITY
            },
        }
    }
}

/// In a problem whose hard bounds were softened, violations are no residual.
#[inline(always)]
fn merit(residuals: &KktResiduals, scale: f64, settings: &QpSettings, softened: bool) -> f64 {
    let r = residuals;
    if !(r.stationarity + r.primal + r.gap + scale).is_finite() {
        return f64::INFINITY;
    }
    // A zero gap of a zero cost.
    let gap = if r.gap <= 0.0 { 0.0 } else { r.gap / (settings.tolerance * scale) };
    if softened { gap } else { gap.max(r.primal / settings.feasibility) }
}
