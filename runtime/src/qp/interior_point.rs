//! Mehrotra's predictor–corrector method on the optimal-control QP.
//!
//! Each iteration factorizes the Newton system of the perturbed KKT conditions once ([`super::riccati`]) and
//! solves it twice: for the affine step, whose length tells how much centring is needed, and for the centred
//! step with second-order correction. All iterates satisfy the dynamics, so only the bounds have a primal
//! residual, and equal primal and dual step lengths shrink it and the dual residual by the same factor.
//!
//! Sources: Mehrotra, *On the implementation of a primal-dual interior point method*, SIAM J. Optim. 2
//! (1992); Wright, *Primal-Dual Interior-Point Methods*, SIAM 1997, chapter 10; Rao, Wright, Rawlings, JOTA
//! 99 (1998), for the structure of the problem.

use super::barrier::Tally;
use super::certificate::{Certificate, cost_scale};
use super::core::Core;
use super::lanes::{Vector, largest};
use super::ldl::NotPositive;
use super::problem::QpProblem;
use super::status::{QpReport, QpStatus};

/// Gap at the start, relative to the cost that keeping the bounds may add. Large: a start far inside takes
/// fewer iterations than one near the boundary.
const START_GAP: f64 = 100.0;
/// The same for a warm start, relative to the cost, with slacks of at least [`WARM_SLACK`] of the distance
/// between the bounds.
const WARM_LEVEL: f64 = 1e-5;
const WARM_SLACK: f64 = 1e-3;
/// Slacks at the start are at least this share of the distance between the bounds.
const START_SLACK: f64 = 0.1;
/// Fraction of the step to the boundary that is taken far from the optimum, and close to it.
const BOUNDARY_FRACTIONS: [f64; 2] = [0.995, 1.0 - 1e-5];
/// Largest barrier term of the Newton system, relative to the largest weight of the cost.
const WEIGHT_CAP: f64 = 1e10;
/// Costs below this share of the gap at the start count as none.
const LEAST_COST: f64 = 1e-24;
/// The largest barrier term may be this many times the largest multiplier of a state, where that is more:
/// smaller ones would hold large multipliers back.
const STIFFNESS: f64 = 1e6;
/// What becomes of both where rounding makes a factorization fail or its steps inexact.
const CAP_CUT: f64 = 1e-2;
/// What becomes of the former where the method makes no progress: damped multipliers fall slowly.
const CAP_RAISE: f64 = 10.0;
/// Penalty of a violated bound in a relaxed problem, relative to the largest gradient or weight of the cost.
const RELAXATION: f64 = 1e5;

/// Where the first iterate comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Start {
    /// The unconstrained optimum.
    Cold,
    /// The solution in memory.
    Warm,
    /// A point deep inside the bounds, with the steps that are safest: where the others have not led to a
    /// solution.
    Deep,
    /// The unconstrained optimum, hard state bounds replaced by penalties.
    Relaxed,
}

/// How a run of the method ended.
#[derive(Debug, Clone, Copy)]
struct Outcome {
    certificate: Certificate,
    iterations: usize,
    /// False if the hard bounds could not be reached.
    feasible: bool,
}

/// A point that may be the solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Candidate {
    /// The unconstrained optimum, which keeps the bounds.
    Free,
    /// An iterate.
    Iterate,
    /// The best iterate, whatever it is worth: the method has ended.
    Last,
}

/// What one iteration starts from.
#[derive(Debug, Clone, Copy, Default)]
struct State {
    /// `zᵀHz` and the cost.
    quadratic: f64,
    cost: f64,
    /// `Σ sλ`, and the largest residual of a bound.
    gap: f64,
    residual: f64,
    /// Largest multiplier.
    force: f64,
}

/// Quantities of a run.
#[derive(Debug, Clone, Copy)]
struct Run {
    start: Start,
    /// True after [`Core::restart`], which happens once in a run at most.
    restarted: bool,
    /// Iterations that the run had taken when its present start was made: 0, or those up to and including the
    /// restart.
    begun: usize,
    /// Steps in a row shorter than `CRAWL`.
    crawl: usize,
    /// True if there are soft bounds.
    soft: bool,
    /// Complementarity pairs.
    count: f64,
    /// Gap at the start.
    start_gap: f64,
    /// Largest diagonal term of the Newton system.
    cap: f64,
    /// The same beside the largest multiplier.
    stiffness: f64,
    /// `Π (1 − α)`: what is left of the dual residual.
    shrink: f64,
    iterations: usize,
    /// Iterations after which it ends: the cap of its present start, and those that are left to the solve.
    limit: usize,
    budget: usize,
    /// Smallest merit so far, and the residual that belongs to it; its iterate is in memory.
    best: (f64, f64),
    /// Residual some iterations ago.
    checkpoint: f64,
    /// Smallest merit so far, and iterations since it last fell.
    progress: (f64, usize),
}

/// A start is a bad one if its first residual exceeds `FAR`, and from the iteration `JUDGED` on if more than
/// `SLOW` of the residual is left per iteration (looked at in every third one) or if [`PATIENCE`] steps in a
/// row are shorter than `CRAWL`, while the residual is not yet `NEAR` its tolerance. Judged earlier, starts
/// are found bad where patience would have led to the solution sooner.
const JUDGED: usize = 14;
const FAR: f64 = 1e4;
const SLOW: f64 = 0.7;
const CRAWL: f64 = 0.2;
const NEAR: f64 = 1e3;
/// A step shorter than `BLOCKED` is stopped by pairs far below the mean of the products `sλ`; from `SETTLED`
/// iterations after the start on they are raised to the share `LEAST_PRODUCT` of it.
const BLOCKED: f64 = 1e-2;
const LEAST_PRODUCT: f64 = 1e-2;
const SETTLED: usize = 8;
/// From this iteration on the best iterate is kept, and stalling is watched for; nearly all solves have ended
/// by then.
const LATE: usize = 12;
/// Iterations between two looks at whether the residual still falls.
const STALL_PERIOD: usize = 6;

impl Run {
    fn new(start: Start, soft: bool, cap: usize, budget: usize) -> Self {
        Self {
            start,
            restarted: false,
            begun: 0,
            crawl: 0,
            soft,
            count: 0.0,
            start_gap: 0.0,
            cap: 0.0,
            stiffness: STIFFNESS,
            shrink: 1.0,
            iterations: 0,
            limit: cap.min(budget),
            budget,
            best: (f64::INFINITY, f64::INFINITY),
            checkpoint: f64::INFINITY,
            progress: (f64::INFINITY, 0),
        }
    }

    #[inline(always)]
    fn note(&mut self, merit: f64) {
        self.progress =
            if merit < 0.9 * self.progress.0 { (merit, 0) } else { (self.progress.0, self.progress.1 + 1) };
    }
}

/// Iterations without progress after which the second-order correction is left out, since with it the method
/// can cycle (Cartis, *Some disadvantages of a Mehrotra-type primal-dual corrector interior point algorithm*,
/// Appl. Numer. Math. 59, 2009), and the centring then taken.
const PATIENCE: usize = 3;
const SAFE_CENTRING: f64 = 0.3;

impl<V: Vector, const NX: usize, const NU: usize> Core<V, NX, NU> {
    /// Solves the problem in memory, `soft` if it has soft bounds; from a cold start where a warm one leads
    /// nowhere. Where its hard state bounds prove out of reach, solves it again with exact penalties in their
    /// place.
    #[inline(always)]
    pub(super) fn optimize(
        &mut self,
        problem: &QpProblem<NX, NU>,
        soft: bool,
        start: Start,
    ) -> Result<QpReport, NotPositive> {
        let (mut soft, mut start, mut iterations) = (soft, start, 0);
        let starts = if start == Start::Warm { 3 } else { 2 };
        let most = starts * self.settings.max_iterations;
        let mut kept: Option<Certificate> = None;
        if !self.is_bounded() {
            start = Start::Cold;
        }
        loop {
            self.set_out(start)?;
            soft |= start == Start::Relaxed;
            let outcome = self.run(problem, soft, start, most - iterations);
            iterations += outcome.iterations;
            let certificate = self.better_of(kept, outcome.certificate);
            start = match start {
                Start::Warm if !certificate.holds() => Start::Cold,
                Start::Cold if !outcome.feasible && iterations < most => Start::Relaxed,
                Start::Cold if !certificate.holds() && certificate.is_finite() && iterations < most => {
                    Start::Deep
                }
                _ => return Ok(certificate.report(self.status(&certificate), iterations)),
            };
            kept = (start == Start::Deep).then_some(certificate);
        }
    }

    /// Makes the better one of two points the solution: the one kept in memory, if there is one, or the
    /// present one. Keeps it.
    #[inline(always)]
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

    /// Makes the first iterate.
    #[inline(always)]
    fn set_out(&mut self, start: Start) -> Result<(), NotPositive> {
        if start == Start::Warm {
            self.iterate.copy_from(&self.solution);
            self.input_bounds.clip(&mut self.iterate.u);
            self.fixed.place(&mut self.iterate.u);
            self.riccati.roll_out(&mut self.iterate, &self.affine);
            return Ok(());
        }
        self.unconstrained()?;
        if start == Start::Relaxed {
            self.soften();
        }
        Ok(())
    }

    #[inline(always)]
    fn status(&self, certificate: &Certificate) -> QpStatus {
        if !certificate.is_finite() {
            QpStatus::Invalid
        } else if !certificate.holds() {
            QpStatus::IterationLimit
        } else if self.softened && certificate.residuals.primal > self.settings.feasibility {
            QpStatus::Relaxed
        } else {
            QpStatus::Solved
        }
    }

    /// True if there is a bound that may become active.
    #[inline(always)]
    fn is_bounded(&self) -> bool {
        self.equalities.any() || self.input_bounds.count() + self.state_bounds.count() > 0.0
    }

    /// True if the iterate keeps all bounds.
    #[inline(always)]
    fn keeps_bounds(&self) -> bool {
        let inputs = self.input_bounds.violation(&self.iterate.u, false);
        let states = self.state_bounds.violation(&self.iterate.x, false);
        inputs.max(states) <= 0.0 && !self.equalities.any()
    }

    /// Runs the method from the iterate in memory.
    #[inline(always)]
    fn run(&mut self, problem: &QpProblem<NX, NU>, soft: bool, start: Start, budget: usize) -> Outcome {
        let mut run = Run::new(start, soft, self.settings.max_iterations, budget);
        let mut candidate = None;
        if start != Start::Warm && self.keeps_bounds() {
            self.multipliers[0].clear();
            self.multipliers[1].clear();
            candidate = Some(Candidate::Free);
        } else {
            self.begin(start, &mut run);
            if start == Start::Deep && self.settings.max_iterations > 0 {
                self.restart(&mut run);
            }
        }
        loop {
            let mut least = 0.0;
            if let Some(kind) = candidate {
                let certificate = self.certify(problem, LEAST_COST * run.start_gap);
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
                    self.begin(start, &mut run);
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

    /// One iteration, unless it finds a candidate for the solution; the last one is known to have a merit of
    /// at least `least`, 0 if there was none.
    #[inline(always)]
    fn iterate(&mut self, least: f64, run: &mut Run) -> Option<Candidate> {
        let state = self.linearize(run.soft);
        // For the next one
        self.state_bounds.cap_weights(run.cap.max(run.stiffness * state.force));
        self.equalities.cap_weights(run.cap);
        let merit = self.merit(&state, run).max(least);
        // The factorization that a certificate needs is that of the last iteration.
        if merit <= 1.0 && run.iterations > 0 {
            self.take_multipliers(false);
            return Some(Candidate::Iterate);
        }
        let stalled = self.stalled(&state, run);
        let may_restart = !run.restarted && run.iterations < run.limit;
        if merit.is_finite() && may_restart && (stalled || self.is_slow(&state, run)) {
            if run.start == Start::Warm {
                return Some(Candidate::Last);
            }
            self.restart(run);
            return None;
        }
        run.note(merit);
        if run.progress.1 >= PATIENCE && state.residual <= NEAR * self.settings.feasibility {
            run.cap *= CAP_RAISE;
        }
        let stops = stalled || !merit.is_finite() || self.is_over(&state, run);
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

    /// True if the run has had its iterations; beyond the cap, a second start goes on only where the bounds
    /// are about to be kept.
    #[inline(always)]
    fn is_over(&self, state: &State, run: &Run) -> bool {
        let near = state.residual <= NEAR * self.settings.feasibility;
        run.iterations >= run.limit || run.iterations >= self.settings.max_iterations && !near
    }

    /// True if the start was a bad one.
    #[inline(always)]
    fn is_slow(&self, state: &State, run: &Run) -> bool {
        if state.residual <= NEAR * self.settings.feasibility
            || (run.iterations > 0 && run.iterations < JUDGED)
        {
            return false;
        }
        let far = run.iterations == 0 && run.start != Start::Warm && state.residual > FAR;
        let expected = SLOW.powi(run.iterations as i32);
        far || run.crawl >= PATIENCE
            || run.iterations > 0 && run.iterations.is_multiple_of(3) && run.shrink > expected
    }

    /// Multipliers of the iterate, as those of the solution or of the best iterate.
    #[inline(always)]
    fn take_multipliers(&mut self, best: bool) {
        let [of_inputs, of_states] = if best { &mut self.best_multipliers } else { &mut self.multipliers };
        self.input_bounds.multipliers(of_inputs);
        self.state_bounds.multipliers(of_states);
        self.equalities.multipliers(of_states);
    }

    /// The optimum without bounds, by one factorization.
    #[inline(always)]
    fn unconstrained(&mut self) -> Result<(), NotPositive> {
        self.weight.clear();
        self.fixed.weigh(&mut self.weight.u);
        self.riccati.factorize(&self.weight, Some(&self.affine))?;
        self.rhs.copy_from(&self.linear);
        self.fixed.attract(&mut self.rhs.u);
        self.riccati.solve(&self.rhs, &mut self.iterate, Some(&self.affine));
        self.fixed.place(&mut self.iterate.u);
        Ok(())
    }

    /// Slacks and multipliers for the first iterate.
    #[inline(always)]
    fn begin(&mut self, start: Start, run: &mut Run) {
        let warm = start == Start::Warm;
        let level = if warm { WARM_LEVEL * self.cost().abs() } else { self.excess_energy() };
        run.cap = WEIGHT_CAP * self.riccati.largest_weight();
        self.input_bounds.cap_weights(f64::INFINITY);
        self.cap_weights(run.cap);
        self.equalities.start(warm.then_some(&self.multipliers[1]));
        run.count = self.input_bounds.count() + self.state_bounds.count();
        self.set_slacks(level, start, run);
        if warm {
            let mu = run.start_gap / run.count.max(1.0);
            self.input_bounds.remember(false, &self.multipliers[0], mu);
            self.state_bounds.remember(run.soft, &self.multipliers[1], mu);
        }
    }

    /// Slacks as the iterate has them, and multipliers, for a scale of the cost that keeping the bounds adds.
    #[inline(always)]
    fn set_slacks(&mut self, level: f64, start: Start, run: &mut Run) {
        let mu = if level > 0.0 { START_GAP * level / run.count.max(1.0) } else { 1.0 };
        run.start_gap = mu * run.count;
        run.shrink = 1.0;
        let slack = if start == Start::Warm { WARM_SLACK } else { START_SLACK };
        let far = run.restarted;
        self.input_bounds.start(false, &self.iterate.u, mu, slack, far);
        self.state_bounds.start(run.soft, &self.iterate.x, mu, slack, far);
    }

    /// Starts again from a point that lies as deep inside the bounds as the dynamics allow, with its whole
    /// cost as the scale: where the optimum without bounds lies far outside, what it costs to move it there
    /// tells nothing, and the method creeps along the boundary.
    #[inline(always)]
    fn restart(&mut self, run: &mut Run) {
        if run.iterations > 0 {
            self.iterate.copy_from(&self.best);
        }
        run.iterations += 1;
        run.restarted = true;
        run.begun = run.iterations;
        run.limit = (run.begun + self.settings.max_iterations).min(run.budget);
        run.crawl = 0;
        // What the first start has reached is no measure of the progress of the second.
        run.progress = (f64::INFINITY, 0);
        run.checkpoint = f64::INFINITY;
        let mut size = self.scale();
        let most = 10.0 * size * run.count.max(1.0);
        let mut level = size;
        for _ in 0..4 {
            if self.centre(size).is_ok() {
                self.riccati.solve(&self.rhs, &mut self.iterate, Some(&self.affine));
                self.fixed.place(&mut self.iterate.u);
                level = self.scale();
                if level <= most {
                    break;
                }
            }
            size *= 1e-3;
        }
        self.equalities.start(None);
        self.set_slacks(level, Start::Cold, run);
        run.best = (f64::INFINITY, f64::INFINITY);
    }

    /// Size of the cost at the iterate.
    #[inline(always)]
    fn scale(&mut self) -> f64 {
        self.cost().abs() + self.state_bounds.penalty(&self.iterate.x, true)
    }

    #[inline(always)]
    fn centre(&mut self, size: f64) -> Result<(), NotPositive> {
        self.weight.clear();
        self.rhs.copy_from(&self.linear);
        let (w, h) = (&mut self.weight, &mut self.rhs);
        self.input_bounds.attract(size, &mut w.u, &mut h.u);
        self.state_bounds.attract(size, &mut w.x, &mut h.x);
        self.equalities.attract(&mut w.x, &mut h.x);
        self.fixed.weigh(&mut w.u);
        self.fixed.attract(&mut h.u);
        self.riccati.factorize(&self.weight, Some(&self.affine))
    }

    #[inline(always)]
    fn cap_weights(&mut self, cap: f64) {
        self.state_bounds.cap_weights(cap);
        self.equalities.cap_weights(cap);
    }

    /// Cost of the iterate, without penalties.
    #[inline(always)]
    fn cost(&mut self) -> f64 {
        let (quadratic, linear) = self.riccati.gradient(&self.iterate, &self.linear, &mut self.gradient);
        0.5 * quadratic + linear + self.constant
    }

    /// What moving the iterate into its bounds, number by number, would cost if it were the optimum without
    /// them: the scale of the multipliers.
    #[inline(always)]
    fn excess_energy(&mut self) -> f64 {
        self.step.copy_from(&self.iterate);
        self.input_bounds.clip(&mut self.step.u);
        self.state_bounds.clip(&mut self.step.x);
        self.equalities.place(&mut self.step.x);
        self.step.advance(&self.iterate, -1.0);
        self.rhs.clear();
        let (quadratic, _) = self.riccati.gradient(&self.step, &self.rhs, &mut self.gradient);
        0.5 * quadratic + self.riccati.input_energy(&self.step)
    }

    /// Gradient of the cost, barrier terms and right-hand side of the affine step.
    #[inline(always)]
    fn linearize(&mut self, soft: bool) -> State {
        let (quadratic, linear) = self.riccati.gradient(&self.iterate, &self.linear, &mut self.gradient);
        let (z, g, w, h) = (&self.iterate, &self.gradient, &mut self.weight, &mut self.rhs);
        let inputs = self.input_bounds.linearize(false, &z.u, &g.u, &mut w.u, &mut h.u);
        let states = self.state_bounds.linearize(soft, &z.x, &g.x, &mut w.x, &mut h.x);
        self.fixed.weigh(&mut w.u);
        self.equalities.weigh(&mut w.x);
        self.equalities.pull(&z.x, &mut h.x);
        let unmet = self.equalities.violation(&z.x);
        State {
            quadratic,
            cost: 0.5 * quadratic + linear + self.constant,
            gap: inputs.sum() + states.sum(),
            residual: inputs.max().max(states.max()).max(unmet),
            force: states.force(),
        }
    }

    /// At most 1 where the tolerances are met.
    #[inline(always)]
    fn merit(&self, state: &State, run: &Run) -> f64 {
        let (gap, residual) = (state.gap, state.residual);
        // Maxima drop NaN.
        if !(state.cost + state.quadratic + gap + residual).is_finite() {
            return f64::INFINITY;
        }
        let scale = cost_scale(state.cost, state.quadratic, LEAST_COST * run.start_gap);
        let gap = gap.max(run.shrink * run.start_gap) / (self.settings.tolerance * scale);
        gap.max(residual / self.settings.feasibility)
    }

    /// Keeps the iterate if it is the best so far.
    #[inline(always)]
    fn keep_best(&mut self, merit: f64, state: &State, run: &mut Run) {
        if merit < run.best.0 || run.best.0.is_infinite() {
            run.best = (merit, state.residual);
            self.best.copy_from(&self.iterate);
            self.take_multipliers(true);
        }
    }

    /// True if the residual of the bounds has ceased to fall, as it does where they cannot be kept.
    #[inline(always)]
    fn stalled(&self, state: &State, run: &mut Run) -> bool {
        let iterations = run.iterations - run.begun;
        if iterations < LATE || !iterations.is_multiple_of(STALL_PERIOD) {
            return false;
        }
        let stalled =
            state.residual > NEAR * self.settings.feasibility && state.residual > 0.5 * run.checkpoint;
        run.checkpoint = state.residual;
        stalled
    }

    /// One iteration. Returns false if the arithmetic broke down, the iterate then being unchanged.
    #[inline(always)]
    fn advance(&mut self, state: &State, run: &mut Run) -> bool {
        if self.riccati.factorize(&self.weight, None).is_err() {
            // Rounding beside the largest terms.
            run.cap *= CAP_CUT;
            run.stiffness *= CAP_CUT;
            return run.cap > 0.0;
        }
        self.riccati.solve(&self.rhs, &mut self.step, None);
        let (target, correction) = self.centring(state, run);
        self.input_bounds.centre(false, &self.gradient.u, target, correction, &mut self.rhs.u);
        self.state_bounds.centre(run.soft, &self.gradient.x, target, correction, &mut self.rhs.x);
        self.equalities.pull(&self.iterate.x, &mut self.rhs.x);
        self.riccati.solve(&self.rhs, &mut self.step, None);
        let inputs = self.input_bounds.corrector(false, &self.step.u, target, correction);
        let states = self.state_bounds.corrector(run.soft, &self.step.x, target, correction);
        let boundary = inverse_step(&inputs, &states);
        // The closer to the optimum, the closer to the boundary: needed for superlinear convergence (Wright
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

    /// Complementarity `σμ` to aim at, from the affine step: `σ = (μ_affine/μ)³` (Mehrotra 1992).
    #[inline(always)]
    fn centring(&mut self, state: &State, run: &Run) -> (f64, f64) {
        let inputs = self.input_bounds.predictor(false, &self.step.u);
        let states = self.state_bounds.predictor(run.soft, &self.step.x);
        let length = 1.0 / inverse_step(&inputs, &states).max(1.0);
        let affine = (1.0 - length) * state.gap + length * length * (inputs.sum() + states.sum());
        // Without complementarity pairs there is nothing to centre.
        let ratio = if state.gap > 0.0 { (affine / state.gap).clamp(0.0, 1.0) } else { 0.0 };
        let mu = state.gap / run.count.max(1.0);
        if run.progress.1 >= PATIENCE || run.start == Start::Deep {
            (SAFE_CENTRING * mu, 0.0)
        } else {
            (ratio * ratio * ratio * mu, length.sqrt())
        }
    }

    /// Exact penalties in place of all hard state bounds, from the unconstrained optimum in memory.
    #[inline(always)]
    fn soften(&mut self) {
        self.riccati.gradient(&self.iterate, &self.linear, &mut self.gradient);
        let mut slope = 0.0_f64;
        for g in &self.gradient.x {
            slope = slope.max(largest(g.abs()));
        }
        let weight = RELAXATION * slope.max(self.riccati.largest_weight());
        let bounds = &mut self.state_bounds;
        self.equalities.release(|i, value| bounds.set(i, value, value, None));
        self.state_bounds.soften(weight);
        self.softened = true;
    }
}

/// Inverse of the step to the boundary.
#[inline(always)]
fn inverse_step<V: Vector>(inputs: &Tally<V>, states: &Tally<V>) -> f64 {
    inputs.max().max(states.max())
}
