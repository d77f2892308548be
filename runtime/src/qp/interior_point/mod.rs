//! Mehrotra's predictor–corrector method for the optimal-control QP.
//!
//! Each iteration factorizes the Newton system of the perturbed KKT conditions once ([`super::riccati`]) and
//! solves it twice. The first solution is the affine step, whose length determines the centring. The second
//! solution is the centred step with second-order correction. All iterates satisfy the dynamics, so only the
//! bounds have a primal residual. Equal primal and dual step lengths reduce the primal and the dual residual
//! by the same factor.
//!
//! A start near the last solution uses the inputs of this solution and the states that follow from these inputs. The
//! slacks are `s = max(d, min(μ/λ, share of the width))` for the distance d into a bound whose multiplier was λ. The
//! multipliers are `μ/s`. All products `s λ` are μ, so the start is close to the central path if the last solution is
//! close to the new solution.
//!
//! Sources: Mehrotra, *On the implementation of a primal-dual interior point method*, SIAM J. Optim. 2
//! (1992); Wright, *Primal-Dual Interior-Point Methods*, SIAM 1997, chapter 10. The structure of the problem
//! is from Rao, Wright, Rawlings, JOTA 99 (1998). Warm starts with a gap that accounts for the change of the problem are
//! from Yildirim, Wright, *Warm-start strategies in interior-point methods for linear programming*, SIAM J. Optim. 12
//! (2002).

mod augmented;
mod follow;
mod judge;
mod run;
mod start;
mod step;

use self::judge::{LATE, NEAR};
use self::run::{CAP_CUT, PATIENCE, Run};
use super::certificate::Certificate;
use super::core::{Core, Start};
use super::lanes::Vector;
use super::ldl::NotPositive;
use super::problem::QpProblem;
use super::status::{QpReport, QpStatus};

/// Factor by which the largest barrier term is raised if the method makes little progress. With a too small term, damped
/// multipliers decrease slowly.
const CAP_RAISE: f64 = 10.0;

/// Result of a run of the method.
#[derive(Debug, Clone, Copy)]
struct Outcome {
    certificate: Certificate,
    iterations: usize,
    /// False if the hard bounds were not reached.
    feasible: bool,
}

/// A point that may be the solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Candidate {
    /// The unconstrained optimum, if it keeps the bounds.
    Free,
    /// An iterate of the method.
    Iterate,
    /// The best iterate at the end of the method, even if it is not a solution.
    Last,
}

impl<V: Vector, const NX: usize, const NU: usize, const NR: usize> Core<V, NX, NU, NR> {
    /// Solves the problem in memory. `soft` is true if the problem has soft bounds or rows. If hard state bounds or rows
    /// cannot be kept, the problem is solved again, and exact penalties replace these bounds and rows.
    ///
    /// # Errors
    /// [`NotPositive`] if the unconstrained problem cannot be factorized.
    pub(super) fn optimize(
        &mut self,
        problem: &QpProblem<NX, NU, NR>,
        soft: bool,
        start: Start,
    ) -> Result<QpReport, NotPositive> {
        let (mut soft, mut start, mut iterations, mut near) = (soft, start, 0, 0);
        let most = 2 * self.settings.max_iterations;
        let mut kept: Option<Certificate> = None;
        loop {
            start = self.set_out(start)?;
            soft |= start == Start::Relaxed;
            let budget = if start == Start::Near { LATE } else { most - iterations };
            let outcome = self.run(problem, soft, start, budget);
            if start == Start::Near {
                near = outcome.iterations;
                if outcome.certificate.holds() && self.status(&outcome.certificate) == QpStatus::Solved {
                    return Ok(outcome.certificate.report(QpStatus::Solved, near));
                }
                // The memory is then that of a new solver.
                self.forget();
                soft = self.load(problem);
                start = Start::Cold;
                continue;
            }
            iterations += outcome.iterations;
            let certificate = self.better_of(kept, outcome.certificate);
            start = match start {
                Start::Cold if !outcome.feasible && iterations < most => Start::Relaxed,
                Start::Cold | Start::Relaxed
                    if !certificate.holds() && certificate.is_finite() && iterations < most =>
                {
                    Start::Deep
                }
                _ => {
                    self.unsolved = (!certificate.holds() && certificate.is_finite()).then_some(certificate);
                    return Ok(certificate.report(self.status(&certificate), near + iterations));
                }
            };
            kept = (start == Start::Deep).then_some(certificate);
            if start == Start::Deep && self.softened {
                // For some problems that can keep their bounds, the penalties make the Newton systems ill-conditioned.
                soft = self.load(problem);
            }
        }
    }

    /// Continues with the method of multipliers if the starts did not solve the problem.
    pub(super) fn go_on(&mut self, problem: &QpProblem<NX, NU, NR>, report: QpReport) -> QpReport {
        let Some(first) = self.unsolved.take() else { return report };
        let (certificate, further) = self.multiply(problem, first);
        let report = certificate.report(self.status(&certificate), report.iterations + further);
        self.judge(problem, Ok(report))
    }

    /// Makes the better of two points the solution, and stores this point. The two points are the stored point (if `kept`
    /// is given) and the present point.
    fn better_of(&mut self, kept: Option<Certificate>, present: Certificate) -> Certificate {
        let feasibility = self.settings.feasibility;
        let better = kept.filter(|kept| !present.holds() && kept.is_better_than(&present, feasibility));
        if better.is_some() {
            self.solution.copy_from(&self.kept);
            for (of_solution, kept) in self.multipliers.iter_mut().zip(&self.kept_multipliers) {
                of_solution.copy_from(kept);
            }
        } else if !present.holds() {
            self.kept.copy_from(&self.solution);
            for (kept, of_solution) in self.kept_multipliers.iter_mut().zip(&self.multipliers) {
                kept.copy_from(of_solution);
            }
        }
        better.unwrap_or(present)
    }

    /// Sets the first iterate. If the last solution has no active bounds, the unconstrained optimum is tried
    /// first, unless [`Self::follow`] has found active bounds.
    fn set_out(&mut self, start: Start) -> Result<Start, NotPositive> {
        if start == Start::Near {
            self.recall(self.riccati.largest);
            if self.has_active_bounds() || !self.solved {
                return Ok(start);
            }
        }
        self.unconstrained()?;
        match start {
            Start::Near if self.keeps_bounds() => return Ok(Start::Cold),
            Start::Near => self.recall(self.riccati.largest),
            Start::Relaxed => self.soften(),
            Start::Cold | Start::Deep => {}
        }
        Ok(start)
    }

    /// Status of the solution in memory. Only this function decides whether a point is a solution.
    pub(super) fn status(&mut self, certificate: &Certificate) -> QpStatus {
        if !certificate.is_finite() {
            QpStatus::Invalid
        } else if !certificate.holds() {
            QpStatus::IterationLimit
        } else if self.softened && certificate.residuals.primal > self.settings.feasibility {
            QpStatus::Relaxed
        } else if certificate.residuals.primal <= self.settings.feasibility && self.survives_rounding() {
            QpStatus::Solved
        } else {
            QpStatus::IterationLimit
        }
    }

    /// Whether the problem has a bound or row that can become active.
    fn is_bounded(&self) -> bool {
        self.equalities.any() || self.input_bounds.count() + self.state_bounds.count() > 0.0
    }

    /// Whether the iterate keeps all bounds and rows.
    fn keeps_bounds(&self) -> bool {
        let inputs = self.input_bounds.violation(&self.iterate.u, false);
        let states = self.state_bounds.violation(&self.iterate.x, false);
        inputs.max(states) <= 0.0 && !self.equalities.any()
    }

    /// Runs the method from the iterate in memory.
    fn run(&mut self, problem: &QpProblem<NX, NU, NR>, soft: bool, start: Start, budget: usize) -> Outcome {
        let mut run = Run::new(start, soft, self.settings.max_iterations, budget);
        let mut candidate = None;
        // A start near the last solution that keeps the bounds is not necessarily the optimum.
        if start != Start::Near && self.keeps_bounds() {
            self.multipliers[0].clear();
            self.multipliers[1].clear();
            candidate = Some(Candidate::Free);
        } else {
            self.begin(&mut run);
            if start == Start::Deep && self.settings.max_iterations > 0 {
                self.restart(&mut run);
            }
        }
        loop {
            let mut least = 0.0;
            if let Some(kind) = candidate {
                let certificate = self.certify(problem);
                let ended = kind == Candidate::Last || !self.is_bounded();
                if certificate.holds() || ended {
                    let residual = run.best.1.min(certificate.residuals.primal);
                    return Outcome {
                        certificate,
                        iterations: run.iterations,
                        feasible: kind != Candidate::Last || residual <= self.settings.feasibility,
                    };
                }
                if kind == Candidate::Free {
                    self.begin(&mut run);
                }
                least = certificate.merit;
                if certificate.is_inexact() {
                    run.cap *= CAP_CUT;
                }
                if kind == Candidate::Iterate {
                    run.checkpoint = f64::INFINITY;
                    self.iterate.copy_from(&self.solution);
                    self.input_bounds.loosen(&self.iterate.u);
                    self.state_bounds.loosen(&self.iterate.x);
                }
            }
            candidate = self.iterate(least, &mut run);
        }
    }

    /// Makes one iteration, or returns a candidate for the solution. `least` is the merit of the last
    /// candidate, 0 if there was no candidate.
    fn iterate(&mut self, least: f64, run: &mut Run) -> Option<Candidate> {
        let state = self.linearize(run.soft);
        // This limit is for the next factorization.
        self.state_bounds.cap_weights(run.cap.max(run.stiffness * state.force));
        self.equalities.cap_weights(run.cap);
        let merit = self.merit(&state, run).max(least);
        // A certificate needs a factorization, which is available from iteration 1 on.
        if merit <= 1.0 && run.iterations > 0 {
            self.take_multipliers(false);
            return Some(Candidate::Iterate);
        }
        let stalled = self.stalled(&state, run);
        // A start near the last solution is not restarted. A cold start replaces it.
        let may_restart = !run.restarted && run.start != Start::Near && run.iterations < run.limit;
        if merit.is_finite() && may_restart && (stalled || self.is_slow(&state, run)) {
            self.restart(run);
            return None;
        }
        run.note(merit);
        if run.pace.1 >= PATIENCE && state.residual <= NEAR * self.settings.feasibility {
            run.cap *= CAP_RAISE;
        }
        let stops = stalled
            || run.start == Start::Near && run.progress.1 >= PATIENCE
            || !merit.is_finite()
            || self.is_over(merit, &state, run);
        if stops || run.iterations >= LATE || run.iterations == 0 {
            self.keep_best(merit, &state, run);
        }
        if stops || !self.advance(&state, run) {
            self.iterate.copy_from(&self.best);
            for (kept, best) in self.multipliers.iter_mut().zip(&self.best_multipliers) {
                kept.copy_from(best);
            }
            return Some(Candidate::Last);
        }
        run.iterations += 1;
        None
    }
}
