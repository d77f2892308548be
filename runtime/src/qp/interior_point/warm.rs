//! Warm starts: Newton's method on the last active set, then the interior-point method from the last solution.
//!
//! The interior-point method starts from the last inputs, the states that they lead to, and the last multipliers λ. Slacks are
//! `s = max(d, min(μ/λ, share of the width))` at a distance d into the bound, multipliers `μ/s`: the products have one value μ,
//! so that the start lies on the central path as far as the last solution tells it. If that does not lead to the solution
//! within few iterations, the problem is solved from a cold start.
//!
//! Source: Yildirim, Wright, *Warm-start strategies in interior-point methods for linear programming*, SIAM J. Optim. 12
//! (2002), for starts with a gap that the change of the problem allows.

use super::super::core::{Core, Start};
use super::super::lanes::Vector;
use super::super::problem::QpProblem;
use super::super::status::{QpReport, QpStatus};
use super::judge::LATE;

impl<V: Vector, const NX: usize, const NU: usize, const NR: usize> Core<V, NX, NU, NR> {
    /// Solves the problem from the solution in memory.
    ///
    /// # Errors
    /// The number of iterations if that does not lead to its solution.
    #[inline(always)]
    pub(in crate::qp) fn solve_warm(&mut self, problem: &QpProblem<NX, NU, NR>) -> Result<QpReport, usize> {
        if !self.solved || !self.accepts(problem) {
            return Err(0);
        }
        // A cold start in place of this one forgets what it leaves.
        self.solved = false;
        let soft = self.load(problem);
        let mut tried = 0;
        if self.pause.is_over() {
            let followed = self.follow(problem);
            self.pause = self.pause.after(followed.is_ok());
            match followed {
                Ok(report) => return Ok(report),
                Err(iterations) => tried = iterations,
            }
        }
        match self.approach(problem, soft) {
            Ok(report) => Ok(QpReport { iterations: report.iterations + tried, ..report }),
            Err(further) => Err(tried + further),
        }
    }

    /// The interior-point method from the solution in memory. If no bound is active there, the optimum without bounds is tried
    /// first.
    #[inline(always)]
    fn approach(&mut self, problem: &QpProblem<NX, NU, NR>, soft: bool) -> Result<QpReport, usize> {
        let mut start = Start::Near;
        self.return_to_last();
        if !self.has_active_bounds() {
            self.unconstrained().map_err(|_| 0_usize)?;
            if self.keeps_bounds() {
                start = Start::Cold;
            } else {
                self.return_to_last();
            }
        }
        let outcome = self.run(problem, soft, start, LATE);
        let certificate = outcome.certificate;
        if certificate.holds() && self.status(&certificate) == QpStatus::Solved {
            self.solved = true;
            return Ok(certificate.report(QpStatus::Solved, outcome.iterations));
        }
        Err(outcome.iterations)
    }

    /// Makes the solution in memory the iterate.
    #[inline(always)]
    fn return_to_last(&mut self) {
        self.recall(self.riccati.largest_weight());
        self.rows.evaluate(&mut self.iterate);
    }
}
