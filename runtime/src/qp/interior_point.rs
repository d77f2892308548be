//! Mehrotra's predictor–corrector method on the optimal-control QP.
//!
//! Each iteration factorizes the Newton system of the perturbed KKT conditions once ([`super::riccati`]) and solves it twice: for the affine step,
//! whose length tells how much centring is needed, and for the centred step with second-order correction. All iterates satisfy the dynamics, so
//! only the bounds have a primal residual, and equal primal and dual step lengths shrink it and the dual residual by the same factor.
//!
//! Sources: Mehrotra, *On the implementation of a primal-dual interior point method*, SIAM J. Optim. 2 (1992); Wright, *Primal-Dual
//! Interior-Point Methods*, SIAM 1997, chapter 10; Rao, Wright, Rawlings, JOTA 99 (1998), for the structure of the problem.

use super::barrier::Tally;
use super::core::Core;
use super::lanes::{Vector, largest};
use super::ldl::NotPositive;
use super::status::QpStatus;

/// Gap at the start, relative to the cost that keeping the bounds may add. Large: a start far inside takes fewer iterations than one near the boundary.
const START_GAP: f64 = 100.0;
/// The same for a warm start, relative to the cost, with slacks of at least [`WARM_SLACK`] of the distance between the bounds.
const WARM_LEVEL: f64 = 1e-5;
const WARM_SLACK: f64 = 1e-3;
/// Slacks at the start are at least this share of the distance between the bounds.
const START_SLACK: f64 = 0.1;
/// Fraction of the step to the boundary that is taken far from the optimum, and close to it.
const BOUNDARY_FRACTIONS: [f64; 2] = [0.995, 1.0 - 1e-5];
/// Largest barrier term of the Newton system, relative to the largest weight of the cost.
const WEIGHT_CAP: f64 = 1e10;
/// Penalty of a violated bound in a relaxed problem, relative to the largest gradient or weight of the cost.
const RELAXATION: f64 = 1e5;

/// Where the first iterate comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Start {
    /// The unconstrained optimum.
    Cold,
    /// The solution in memory.
    Warm,
}

/// How a run of the method ended.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outcome {
    pub(super) status: QpStatus,
    pub(super) iterations: usize,
    pub(super) gap: f64,
    /// False if the hard bounds could not be reached.
    pub(super) feasible: bool,
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
}

/// Quantities of a run.
#[derive(Debug, Clone, Copy)]
struct Run {
    /// Complementarity pairs.
    count: f64,
    /// Gap at the start.
    start_gap: f64,
    /// `Π (1 − α)`: what is left of the dual residual.
    shrink: f64,
    /// Smallest merit so far, and the state it belongs to; its iterate is in memory.
    best: (f64, State),
    /// Residual some iterations ago.
    checkpoint: f64,
    /// Smallest merit so far, and iterations since it last fell.
    progress: (f64, usize),
}

/// From this iteration on the best iterate is kept, and stalling is watched for; nearly all solves have ended by then.
const LATE: usize = 12;
/// Iterations between two looks at whether the residual still falls.
const STALL_PERIOD: usize = 6;

impl Run {
    #[inline(always)]
    fn note(&mut self, merit: f64) {
        self.progress = if merit < 0.9 * self.progress.0 {
            (merit, 0)
        } else {
            (self.progress.0, self.progress.1 + 1)
        };
    }
}

/// Iterations without progress after which the second-order correction is left out, since with it the method can cycle (Cartis, *Some
/// disadvantages of a Mehrotra-type primal-dual corrector interior point algorithm*, Appl. Numer. Math. 59, 2009), and the centring then taken.
const PATIENCE: usize = 3;
const SAFE_CENTRING: f64 = 0.3;

impl<V: Vector, const NX: usize, const NU: usize> Core<V, NX, NU> {
    /// Solves the problem in memory, `soft` if it has soft bounds. Where its hard state bounds prove out of reach, solves it again with exact
    /// penalties in their place.
    #[inline(always)]
    pub(super) fn optimize(&mut self, soft: bool, start: Start) -> Result<Outcome, NotPositive> {
        let (mut soft, mut start, mut failed) = (soft, start, None);
        loop {
            if start == Start::Cold {
                self.unconstrained()?;
                if failed.is_some() {
                    self.soften();
                }
            } else {
                self.input_bounds.clip(&mut self.iterate.u);
                self.riccati.roll_out(&mut self.iterate, &self.affine);
            }
            let outcome = if start == Start::Cold && self.keeps_bounds() {
                self.multipliers[0].clear();
                self.multipliers[1].clear();
                Outcome {
                    status: QpStatus::Solved,
                    iterations: 0,
                    gap: 0.0,
                    feasible: true,
                }
            } else if soft {
                self.run::<true>(start)
            } else {
                self.run::<false>(start)
            };
            match failed {
                Some(before) => return Ok(self.relaxed(before, outcome)),
                None if outcome.feasible => return Ok(outcome),
                None => (soft, start, failed) = (true, Start::Cold, Some(outcome.iterations)),
            }
        }
    }

    /// True if the iterate keeps all bounds.
    #[inline(always)]
    fn keeps_bounds(&self) -> bool {
        let inputs = self.input_bounds.violation(&self.iterate.u, false);
        inputs.max(self.state_bounds.violation(&self.iterate.x, false)) <= 0.0
    }

    /// Runs the method from the iterate in memory.
    #[inline(always)]
    fn run<const SOFT: bool>(&mut self, start: Start) -> Outcome {
        let mut run = self.begin::<SOFT>(start);
        let mut iterations = 0;
        loop {
            let state = self.linearize::<SOFT>();
            let merit = self.merit(&state, &run);
            if merit <= 1.0 {
                self.input_bounds.multipliers(&mut self.multipliers[0]);
                self.state_bounds.multipliers(&mut self.multipliers[1]);
                return Outcome {
                    status: QpStatus::Solved,
                    iterations,
                    gap: state.gap,
                    feasible: true,
                };
            }
            run.note(merit);
            if iterations >= LATE || iterations == 0 {
                self.keep_best(merit, &state, &mut run);
            }
            let stalled = self.stalled(iterations, &state, &mut run);
            if stalled
                || iterations >= self.settings.max_iterations
                || !self.advance::<SOFT>(&state, &mut run)
            {
                break;
            }
            iterations += 1;
        }
        let state = run.best.1;
        self.iterate.copy_from(&self.best);
        for (kept, best) in self.multipliers.iter_mut().zip(&self.best_multipliers) {
            kept.copy_from(best);
        }
        let feasible = state.residual <= self.settings.feasibility;
        Outcome {
            status: QpStatus::IterationLimit,
            iterations,
            gap: state.gap,
            feasible,
        }
    }

    /// The optimum without bounds, by one factorization.
    #[inline(always)]
    fn unconstrained(&mut self) -> Result<(), NotPositive> {
        self.weight.clear();
        self.riccati.factorize(&self.weight, Some(&self.affine))?;
        self.riccati
            .solve(&self.linear, &mut self.iterate, Some(&self.affine));
        Ok(())
    }

    /// Slacks and multipliers for the first iterate.
    #[inline(always)]
    fn begin<const SOFT: bool>(&mut self, start: Start) -> Run {
        let count = self.input_bounds.count() + self.state_bounds.count();
        let level = if start == Start::Warm {
            WARM_LEVEL * self.cost().abs()
        } else {
            self.excess_energy()
        };
        let cap = WEIGHT_CAP * self.riccati.largest_weight();
        self.input_bounds.cap_weights(f64::INFINITY);
        self.state_bounds.cap_weights(cap);
        let mu = if level > 0.0 {
            START_GAP * level / count
        } else {
            1.0
        };
        let slack = if start == Start::Warm {
            WARM_SLACK
        } else {
            START_SLACK
        };
        self.input_bounds.start::<false>(&self.iterate.u, mu, slack);
        self.state_bounds.start::<SOFT>(&self.iterate.x, mu, slack);
        if start == Start::Warm {
            self.input_bounds.remember::<false>(&self.multipliers[0]);
            self.state_bounds.remember::<SOFT>(&self.multipliers[1]);
        }
        Run {
            count,
            start_gap: mu * count,
            shrink: 1.0,
            best: (f64::INFINITY, State::default()),
            checkpoint: f64::INFINITY,
            progress: (f64::INFINITY, 0),
        }
    }

    /// Cost of the iterate, without penalties.
    #[inline(always)]
    fn cost(&mut self) -> f64 {
        let (quadratic, linear) =
            self.riccati
                .gradient(&self.iterate, &self.linear, &mut self.gradient);
        0.5 * quadratic + linear
    }

    /// What moving the iterate into its bounds, number by number, would cost if it were the optimum without them: the scale of the multipliers.
    #[inline(always)]
    fn excess_energy(&mut self) -> f64 {
        self.step.copy_from(&self.iterate);
        self.input_bounds.clip(&mut self.step.u);
        self.state_bounds.clip(&mut self.step.x);
        self.step.advance(&self.iterate, -1.0);
        self.rhs.clear();
        let (quadratic, _) = self
            .riccati
            .gradient(&self.step, &self.rhs, &mut self.gradient);
        0.5 * quadratic + self.riccati.input_energy(&self.step)
    }

    /// Gradient of the cost, barrier terms and right-hand side of the affine step.
    #[inline(always)]
    fn linearize<const SOFT: bool>(&mut self) -> State {
        let (quadratic, linear) =
            self.riccati
                .gradient(&self.iterate, &self.linear, &mut self.gradient);
        let (z, g, w, h) = (
            &self.iterate,
            &self.gradient,
            &mut self.weight,
            &mut self.rhs,
        );
        let inputs = self
            .input_bounds
            .linearize::<false>(&z.u, &g.u, &mut w.u, &mut h.u);
        let states = self
            .state_bounds
            .linearize::<SOFT>(&z.x, &g.x, &mut w.x, &mut h.x);
        let cost = 0.5 * quadratic + linear;
        State {
            quadratic,
            cost,
            gap: inputs.sum() + states.sum(),
            residual: inputs.max().max(states.max()),
        }
    }

    /// At most 1 where the tolerances are met.
    #[inline(always)]
    fn merit(&self, state: &State, run: &Run) -> f64 {
        let scale = state
            .cost
            .abs()
            .max(5e-5 * state.quadratic)
            .max(1e-12 * run.start_gap);
        let gap = state.gap.max(run.shrink * run.start_gap) / (self.settings.tolerance * scale);
        let merit = gap.max(state.residual / self.settings.feasibility);
        if merit.is_nan() || gap.is_nan() {
            f64::INFINITY
        } else {
            merit
        }
    }

    /// Keeps the iterate if it is the best so far.
    #[inline(always)]
    fn keep_best(&mut self, merit: f64, state: &State, run: &mut Run) {
        if merit < run.best.0 || run.best.0.is_infinite() {
            run.best = (merit, *state);
            self.best.copy_from(&self.iterate);
            self.input_bounds.multipliers(&mut self.best_multipliers[0]);
            self.state_bounds.multipliers(&mut self.best_multipliers[1]);
        }
    }

    /// True if the residual of the bounds has ceased to fall, as it does where they cannot be kept.
    #[inline(always)]
    fn stalled(&self, iterations: usize, state: &State, run: &mut Run) -> bool {
        if iterations < LATE || !iterations.is_multiple_of(STALL_PERIOD) {
            return false;
        }
        let stalled =
            state.residual > self.settings.feasibility && state.residual > 0.5 * run.checkpoint;
        run.checkpoint = state.residual;
        stalled
    }

    /// One iteration. Returns false if the arithmetic broke down, the iterate then being unchanged.
    #[inline(always)]
    fn advance<const SOFT: bool>(&mut self, state: &State, run: &mut Run) -> bool {
        if self.riccati.factorize(&self.weight, None).is_err() {
            return false;
        }
        self.riccati.solve(&self.rhs, &mut self.step, None);
        let (target, correction) = self.centring::<SOFT>(state, run);
        self.input_bounds
            .centre::<false>(&self.gradient.u, target, correction, &mut self.rhs.u);
        self.state_bounds
            .centre::<SOFT>(&self.gradient.x, target, correction, &mut self.rhs.x);
        self.riccati.solve(&self.rhs, &mut self.step, None);
        let inputs = self
            .input_bounds
            .corrector::<false>(&self.step.u, target, correction);
        let states = self
            .state_bounds
            .corrector::<SOFT>(&self.step.x, target, correction);
        let boundary = inverse_step(&inputs, &states);
        // The closer to the optimum, the closer to the boundary: needed for superlinear convergence (Wright 1997, chapter 7).
        let fraction = 1.0
            - (state.gap / state.cost.abs())
                .clamp(1.0 - BOUNDARY_FRACTIONS[1], 1.0 - BOUNDARY_FRACTIONS[0]);
        let length = (fraction / boundary).min(1.0);
        if !length.is_finite() {
            return false;
        }
        self.input_bounds.advance::<false>(length);
        self.state_bounds.advance::<SOFT>(length);
        self.iterate.advance(&self.step, length);
        run.shrink *= 1.0 - length;
        true
    }

    /// Complementarity `σμ` to aim at, from the affine step: `σ = (μ_affine/μ)³` (Mehrotra 1992).
    #[inline(always)]
    fn centring<const SOFT: bool>(&mut self, state: &State, run: &Run) -> (f64, f64) {
        let inputs = self.input_bounds.predictor::<false>(&self.step.u);
        let states = self.state_bounds.predictor::<SOFT>(&self.step.x);
        let length = 1.0 / inverse_step(&inputs, &states).max(1.0);
        let affine = (1.0 - length) * state.gap + length * length * (inputs.sum() + states.sum());
        let ratio = (affine / state.gap).clamp(0.0, 1.0);
        let mu = state.gap / run.count;
        if run.progress.1 >= PATIENCE {
            (SAFE_CENTRING * mu, 0.0)
        } else {
            (ratio * ratio * ratio * mu, length.sqrt())
        }
    }

    /// Exact penalties in place of all hard state bounds, from the unconstrained optimum in memory.
    #[inline(always)]
    fn soften(&mut self) {
        self.riccati
            .gradient(&self.iterate, &self.linear, &mut self.gradient);
        let mut slope = 0.0_f64;
        for g in &self.gradient.x {
            slope = slope.max(largest(g.abs()));
        }
        let weight = RELAXATION * slope.max(self.riccati.largest_weight());
        self.state_bounds.soften(weight);
    }

    /// The outcome of a softened problem after `before` iterations on the hard one.
    #[inline(always)]
    fn relaxed(&self, before: usize, outcome: Outcome) -> Outcome {
        let violation = self.state_bounds.violation(&self.iterate.x, true);
        let kept = violation <= self.settings.feasibility;
        let status = match outcome.status {
            QpStatus::Solved if !kept => QpStatus::Relaxed,
            status => status,
        };
        Outcome {
            status,
            iterations: before + outcome.iterations,
            feasible: true,
            ..outcome
        }
    }
}

/// Inverse of the step to the boundary.
#[inline(always)]
fn inverse_step<V: Vector>(inputs: &Tally<V>, states: &Tally<V>) -> f64 {
    inputs.max().max(states.max())
}
