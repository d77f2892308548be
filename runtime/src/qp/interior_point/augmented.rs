//! Method of multipliers, for problems that the interior-point method does not solve.
//!
//! Every bound and row becomes a term ψ of the cost. This term depends on the distance `d` into the bound, the multiplier
//! λ, the weight W and, for a soft bound, the penalty φ:
//!
//! ```text
//!     ψ(d) = min_{v ≥ 0} φ(v) + (max(λ − W (d + v), 0)² − λ²) / 2W        v = 0 if it is hard
//! ```
//!
//! Newton's method with a line search minimizes the sum. After a full step the forces `−ψ′` become the multipliers. The
//! multipliers start at zero, and no interior is needed. In contrast, if the interior between bounds is very small, the
//! multipliers of the interior-point method grow until rounding errors stop the method. Each gradient is computed from
//! the data of the problem, so a step also corrects rounding errors of the previous step.
//!
//! Sources: Rockafellar, *Augmented Lagrangians and applications of the proximal point algorithm in convex
//! programming*, Math. Oper. Res. 1 (1976). The steps are from Hermans, Themelis, Patrinos, *QPALM*, Math.
//! Program. Comput. 14 (2022).

use super::super::certificate::Certificate;
use super::super::core::Core;
use super::super::lanes::Vector;
use super::super::problem::QpProblem;
use super::run::CAP_CUT;

/// First and largest weight W, relative to the largest weight of the cost. If more than the share `FALL` of the violation
/// remains after a change of the multipliers, W is multiplied by `RAISE`.
const FIRST_WEIGHT: f64 = 1e2;
const MOST_WEIGHT: f64 = 1e16;
const RAISE: f64 = 10.0;
const FALL: f64 = 0.25;
/// Share of the slope at the beginning of a step that may remain at its end.
const SLOPE_LEFT: f64 = 0.1;
/// Number of bisections in the search for the length of a step.
const HALVINGS: usize = 20;

impl<V: Vector, const NX: usize, const NU: usize, const NR: usize> Core<V, NX, NU, NR> {
    /// Continues from the point in memory with the certificate `first`, which does not meet the tolerances. Keeps the better
    /// of the old and the new point. Returns the certificate of this point and the number of factorizations.
    pub(super) fn multiply(
        &mut self,
        problem: &QpProblem<NX, NU, NR>,
        first: Certificate,
    ) -> (Certificate, usize) {
        let largest = self.riccati.largest;
        let (mut w, mut violation) = (FIRST_WEIGHT * largest, f64::INFINITY);
        let mut kept = self.better_of(None, first);
        self.iterate.copy_from(&self.solution);
        self.input_bounds.start_augmented();
        self.state_bounds.start_augmented();
        self.equalities.start(None);
        for iteration in 1..=self.settings.max_iterations {
            self.augment([w, w], false);
            if self.riccati.factorize(&self.weight, None, &self.rows).is_err() {
                w *= CAP_CUT;
                continue;
            }
            self.augmented_step();
            let length = self.augmented_length(w);
            self.iterate.advance(&self.step, length);
            self.rows.evaluate(&mut self.iterate);
            if length < 1.0 {
                continue;
            }
            let left = self.take_forces([w, w]);
            let certificate = self.certify(problem);
            if certificate.holds() {
                return (certificate, iteration);
            }
            kept = self.better_of(Some(kept), certificate);
            if left > FALL * violation {
                w = (RAISE * w).min(MOST_WEIGHT * largest);
            }
            violation = left;
        }
        (kept, self.settings.max_iterations)
    }

    /// Computes gradient and diagonal terms at the iterate, for the weights W of inputs and of states. The
    /// gradient of the cost remains in memory. If `known` is true, the multipliers select the quadratic
    /// pieces of the terms. Otherwise the iterate selects them.
    pub(super) fn augment(&mut self, [of_inputs, of_states]: [f64; 2], known: bool) {
        self.rows.evaluate(&mut self.iterate);
        self.riccati.gradient(&self.iterate, &self.linear, &mut self.gradient);
        let (z, g, weight, h) = (&self.iterate, &self.gradient, &mut self.weight, &mut self.rhs);
        self.input_bounds.augment(of_inputs, known, &z.u, &g.u, &mut weight.u, &mut h.u);
        self.state_bounds.augment(of_states, known, &z.x, &g.x, &mut weight.x, &mut h.x);
        self.fixed.weigh(&mut weight.u);
        self.equalities.cap_weights(of_states);
        self.equalities.weigh(&mut weight.x);
        self.equalities.pull(&z.x, &mut h.x);
        self.rows.fold(h);
    }

    /// Computes the Newton step from the iterate.
    pub(super) fn augmented_step(&mut self) {
        self.solve_step();
        self.fixed.hold(&mut self.step.u);
    }

    /// Length of the step. The length is 1, or less if the cost would rise again before the end of the step.
    fn augmented_length(&mut self, w: f64) -> f64 {
        let linear = self.gradient.inner(&self.step);
        self.rhs.clear();
        let (quadratic, _) = self.riccati.gradient(&self.step, &self.rhs, &mut self.gradient);
        let (z, dz) = (&self.iterate, &self.step);
        let slope = |length: f64| {
            linear
                + length * quadratic
                + self.input_bounds.slope(w, &z.u, &dz.u, length)
                + self.state_bounds.slope(w, &z.x, &dz.x, length)
                + self.equalities.slope(&z.x, &dz.x, length)
        };
        let left = SLOPE_LEFT * slope(0.0).abs();
        let (mut low, mut high) = (0.0, 2.0);
        for _ in 0..HALVINGS {
            let (length, here) = (0.5 * (low + high), slope(0.5 * (low + high)));
            if here > left {
                high = length;
            } else if here < -left && length < 1.0 {
                low = length;
            } else {
                return length;
            }
        }
        0.5 * (low + high)
    }

    /// Sets the multipliers of the iterate and of the solution to the forces at the iterate. Returns the largest violation
    /// of a hard bound or row.
    pub(super) fn take_forces(&mut self, [of_inputs, of_states]: [f64; 2]) -> f64 {
        let z = &self.iterate;
        self.input_bounds.take_forces(of_inputs, &z.u);
        self.state_bounds.take_forces(of_states, &z.x);
        self.rhs.clear();
        self.equalities.corrector(&z.x, &self.rhs.x);
        self.equalities.advance(1.0);
        let hard = self.state_bounds.violation(&z.x, true).max(self.equalities.violation(&z.x));
        let violation = hard.max(self.input_bounds.violation(&z.u, true));
        self.take_multipliers(false);
        violation
    }
}
