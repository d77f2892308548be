//! Warm starts: Newton's method from the active set of the last solution.
//!
//! The terms of the method of multipliers ([`super::augmented`]) are quadratic on each piece: off the bound, at it, and
//! beyond a soft one. One Newton step reaches the minimum of the pieces that it assumes. If the pieces there are those
//! that were assumed, the forces become multipliers and the point is certified; what is left of it by the finite weight
//! W goes in further steps with the same factorization. Otherwise the pieces there are assumed next. The first step
//! assumes those of the last solution. A set that changes much is not pursued: the interior-point method solves such a
//! problem in fewer iterations.
//!
//! Source: Hintermüller, Ito, Kunisch, *The primal-dual active set strategy as a semismooth Newton method*, SIAM J.
//! Optim. 13 (2002), section 3.

use super::super::core::Core;
use super::super::lanes::Vector;
use super::super::problem::QpProblem;
use super::super::status::{QpReport, QpStatus};

/// Most factorizations, and steps that repeat one.
const MOST: usize = 6;
const REPEATED: usize = 3;
/// The weight W of states and rows, relative to the largest weight of the cost; that of inputs is `RIGID` times as
/// large, since that of the states acts on them through the dynamics.
const WEIGHT: f64 = 1e7;
const RIGID: f64 = 1e3;

impl<V: Vector, const NX: usize, const NU: usize, const NR: usize> Core<V, NX, NU, NR> {
    /// Solves the problem from the active set of the solution in memory.
    ///
    /// # Errors
    /// The number of iterations if that does not lead to its solution.
    #[inline(always)]
    pub(in crate::qp) fn follow(&mut self, problem: &QpProblem<NX, NU, NR>) -> Result<QpReport, usize> {
        if !self.solved || !self.accepts(problem) {
            return Err(0);
        }
        // A cold start in place of this one forgets what it leaves.
        self.solved = false;
        self.load(problem);
        let scale = self.riccati.largest_weight();
        let w = [RIGID * WEIGHT * scale, WEIGHT * scale];
        self.recall(scale);
        self.augment(w, true);
        let (most, mut iterations, mut repeated) = (MOST.min(self.settings.max_iterations), 0, 0);
        let mut known = false;
        while known || iterations < most {
            if !known {
                self.riccati.factorize(&self.weight, None, &self.rows).map_err(|_| iterations)?;
                // The set that is factorized.
                self.best.copy_from(&self.weight);
                iterations += 1;
            }
            self.augmented_step();
            self.iterate.advance(&self.step, 1.0);
            self.augment(w, false);
            known = self.weight.equals(&self.best);
            if known {
                self.take_forces(w);
                let certificate = self.certify(problem);
                if certificate.holds() && self.status(&certificate) == QpStatus::Solved {
                    self.solved = true;
                    return Ok(certificate.report(QpStatus::Solved, self.counted(iterations)));
                }
                if repeated == REPEATED {
                    break;
                }
                repeated += 1;
                self.augment(w, false);
                known = self.weight.equals(&self.best);
            }
        }
        Err(iterations)
    }

    /// The inputs of the solution in memory and where they lead to, with the multipliers of its active set.
    #[inline(always)]
    fn recall(&mut self, scale: f64) {
        self.iterate.copy_from(&self.solution);
        let [of_inputs, of_states] = &self.multipliers;
        self.input_bounds.recall(scale, &self.iterate.u, of_inputs);
        self.state_bounds.recall(scale, &self.iterate.x, of_states);
        self.equalities.start(Some(of_states));
        self.fixed.place(&mut self.iterate.u);
        self.riccati.roll_out(&mut self.iterate, &self.affine);
    }

    /// 0 for one iteration that has found no bound active.
    #[inline(always)]
    fn counted(&self, iterations: usize) -> usize {
        let active = self.equalities.any() || self.input_bounds.is_active() || self.state_bounds.is_active();
        if active { iterations } else { iterations - 1 }
    }
}
