//! Memory of the method, generic over the lanes (vectors of four numbers), and loading of a problem.

use super::barrier::{Bounds, ROUNDING};
use super::certificate::Certificate;
use super::equality::{Equalities, Fixed};
use super::lanes::{Vector, flat_mut, lanes, zeros};
use super::ldl::NotPositive;
use super::multipliers::Multipliers;
use super::pause::Pause;
use super::problem::{QpProblem, QpStage};
use super::riccati::Riccati;
use super::rows::{Limits, Rows};
use super::status::{KktResiduals, QpReport, QpSettings, QpStatus};
use super::trajectory::Trajectory;
#[cfg(not(feature = "std"))]
use crate::no_std::*;

/// Bounds that are closer than this distance count as equal, with the value in their middle, because rounding would leave
/// no interior between them. The distance is relative to the lower bound if the magnitude of this bound exceeds 1.
const LEAST_WIDTH: f64 = 1e-10;

/// Choice of the first iterate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Start {
    /// The first iterate is the unconstrained optimum.
    Cold,
    /// The first iterate is near the last solution.
    Near,
    /// The first iterate is deep inside the bounds, and the steps are cautious. This start is for problems
    /// that the other starts do not solve.
    Deep,
    /// The first iterate is the unconstrained optimum, and penalties replace hard state bounds and rows.
    Relaxed,
}

#[derive(Debug, Clone)]
pub(super) struct Core<V, const NX: usize, const NU: usize, const NR: usize> {
    pub(super) horizon: usize,
    pub(super) settings: QpSettings,
    pub(super) riccati: Riccati<V, NX, NU>,
    pub(super) rows: Rows<V, NX, NU, NR>,
    /// Bounds of the inputs.
    pub(super) input_bounds: Bounds<V>,
    /// Bounds of the states and rows.
    pub(super) state_bounds: Bounds<V>,
    /// Inputs whose bounds are equal.
    pub(super) fixed: Fixed<V>,
    /// Hard states and rows whose bounds are equal.
    pub(super) equalities: Equalities<V>,
    /// Whether penalties have replaced hard bounds and rows.
    pub(super) softened: bool,
    /// Affine terms `c_k` of the dynamics `x⁺ = A x + B u + c`. c_0 includes the contribution `A_0 x_0` of
    /// the initial state.
    pub(super) affine: Vec<V>,
    /// Gap that always counts as zero, see [`QpSettings::tolerance`].
    pub(super) negligible: f64,
    /// Linear part of the cost: its gradient at zero inputs and states.
    pub(super) linear: Trajectory<V>,
    /// Constant cost of the input before the horizon.
    pub(super) constant: f64,
    pub(super) iterate: Trajectory<V>,
    /// The solution that is returned.
    pub(super) solution: Trajectory<V>,
    pub(super) step: Trajectory<V>,
    /// Gradient of the cost at the iterate.
    pub(super) gradient: Trajectory<V>,
    /// Right-hand side of the Newton step.
    pub(super) rhs: Trajectory<V>,
    /// Diagonal barrier terms.
    pub(super) weight: Trajectory<V>,
    /// Multipliers of the solution.
    pub(super) multipliers: [Multipliers<V>; 2],
    /// Iterate with the smallest residuals. It is only stored if a solve needs many iterations.
    pub(super) best: Trajectory<V>,
    pub(super) best_multipliers: [Multipliers<V>; 2],
    /// Best point of the previous starts if none of them is a solution.
    pub(super) kept: Trajectory<V>,
    pub(super) kept_multipliers: [Multipliers<V>; 2],
    /// Certificate after all starts; `None` if the problem is solved.
    pub(super) unsolved: Option<Certificate>,
    /// Whether the last problem was solved.
    pub(super) solved: bool,
    /// Pause of Newton's method after failed warm starts.
    pub(super) pause: Pause,
    /// Stored solution: the point, its multipliers, whether it is solved, and the pause. A rehearsal (a solve only to warm
    /// up the processor caches) restores it.
    spare: (Trajectory<V>, [Multipliers<V>; 2], bool, Pause),
}

impl<V: Vector, const NX: usize, const NU: usize, const NR: usize> Core<V, NX, NU, NR> {
    const RX: usize = lanes::<V>(NX);

    /// Memory for `horizon` stages.
    pub(super) fn new(horizon: usize, settings: QpSettings) -> Self {
        let rows = Rows::<V, NX, NU, NR>::lanes(horizon);
        let (nu, nx) = (lanes::<V>(horizon * NU), horizon * Self::RX + rows);
        let trajectory = Trajectory::new(horizon, NX, NU, rows);
        let multipliers = [Multipliers::new(nu), Multipliers::new(nx)];
        Self {
            horizon,
            settings,
            riccati: Riccati::new(horizon),
            rows: Rows::new(horizon),
            input_bounds: Bounds::new(nu),
            state_bounds: Bounds::new(nx),
            fixed: Fixed::new(nu),
            equalities: Equalities::new(nx),
            softened: false,
            affine: zeros(horizon * Self::RX),
            negligible: 0.0,
            linear: trajectory.clone(),
            constant: 0.0,
            iterate: trajectory.clone(),
            solution: trajectory.clone(),
            step: trajectory.clone(),
            gradient: trajectory.clone(),
            rhs: trajectory.clone(),
            weight: trajectory.clone(),
            multipliers: multipliers.clone(),
            best: trajectory.clone(),
            best_multipliers: multipliers.clone(),
            kept: trajectory.clone(),
            kept_multipliers: multipliers.clone(),
            spare: (trajectory, multipliers, false, Pause::default()),
            unsolved: None,
            solved: false,
            pause: Pause::default(),
        }
    }

    /// Shifts the last solution by one stage and repeats its last stage. The next [`Self::follow`] of a receding horizon
    /// starts at the shifted solution.
    pub(super) fn shift(&mut self) {
        let padded = Self::RX * V::WIDTH;
        let (u, x) = (flat_mut(&mut self.solution.u), flat_mut(&mut self.solution.x));
        u.copy_within(NU..self.horizon * NU, 0);
        self.multipliers[0].shift(0, NU, self.horizon * NU);
        let states = self.horizon * padded;
        x.copy_within(padded..states, 0);
        self.multipliers[1].shift(0, padded, states);
        if NR > 0 {
            // The rows of the last node do not change.
            let (padded, end) =
                (lanes::<V>(NR) * V::WIDTH, states + self.horizon * lanes::<V>(NR) * V::WIDTH);
            x.copy_within(states + padded..end, states);
            self.multipliers[1].shift(states, padded, end - states);
        }
    }

    /// Input `u_k` of the solution; zeros beyond the last stage.
    pub(super) fn input(&self, k: usize) -> [f64; NU] {
        if k < self.horizon { self.solution.input(k) } else { [0.0; NU] }
    }

    /// State `x_k` of the solution after k of the N stages, `1 ≤ k ≤ N`, computed from the inputs by the
    /// dynamics; zeros for other `k`.
    pub(super) fn state(&self, k: usize) -> [f64; NX] {
        if (1..=self.horizon).contains(&k) { self.solution.state(k - 1) } else { [0.0; NX] }
    }

    /// Multipliers `[lower, upper]` of the bounds of the input `u_k`, all ≥ 0; zeros beyond the last stage.
    pub(super) fn input_multipliers(&self, k: usize) -> [[f64; 2]; NU] {
        core::array::from_fn(
            |i| {
                if k < self.horizon { self.multipliers[0].get(k * NU + i) } else { [0.0; 2] }
            },
        )
    }

    /// Multipliers `[lower, upper]` of the bounds of the state `x_k` after k of the N stages, `1 ≤ k ≤ N`,
    /// all ≥ 0; zeros for other `k`.
    pub(super) fn state_multipliers(&self, k: usize) -> [[f64; 2]; NX] {
        let padded = Self::RX * V::WIDTH;
        let inside = (1..=self.horizon).contains(&k);
        core::array::from_fn(
            |i| {
                if inside { self.multipliers[1].get((k - 1) * padded + i) } else { [0.0; 2] }
            },
        )
    }

    /// Multipliers `[lower, upper]` of the rows of node `k`, `0 ≤ k ≤ N` for N stages, all ≥ 0; zeros for
    /// other `k`.
    pub(super) fn row_multipliers(&self, k: usize) -> [[f64; 2]; NR] {
        let place = (self.horizon * Self::RX + k * lanes::<V>(NR)) * V::WIDTH;
        core::array::from_fn(|r| {
            if k <= self.horizon {
                self.multipliers[1].get(place + r).map(|l| l / self.rows.unit(k, r))
            } else {
                [0.0; 2]
            }
        })
    }

    /// Whether the data are valid and have the horizon of this solver.
    pub(super) fn accepts(&self, problem: &QpProblem<NX, NU, NR>) -> bool {
        problem.stages.len() == self.horizon && problem.is_valid()
    }

    /// Solves a problem with a cold start or with a start near the solution in memory. [`Self::accepts`] must be true for
    /// the problem.
    pub(super) fn solve(&mut self, problem: &QpProblem<NX, NU, NR>, start: Start) -> QpReport {
        self.unsolved = None;
        if start == Start::Cold && !self.solved {
            self.forget();
        }
        let soft = self.load(problem);
        self.solve_loaded(problem, soft, start)
    }

    /// Solves a problem from the last solution, or with a cold start if the last problem was not solved. [`Self::accepts`] must
    /// be true for the problem.
    pub(super) fn solve_warm(&mut self, problem: &QpProblem<NX, NU, NR>) -> QpReport {
        if !self.solved {
            return self.solve(problem, Start::Cold);
        }
        self.unsolved = None;
        let soft = self.load(problem);
        self.follow(problem).unwrap_or_else(|tried| {
            let report = self.solve_loaded(problem, soft, Start::Near);
            QpReport { iterations: report.iterations + tried, ..report }
        })
    }

    fn solve_loaded(&mut self, problem: &QpProblem<NX, NU, NR>, soft: bool, start: Start) -> QpReport {
        let report = self.optimize(problem, soft, start);
        let report = self.judge(problem, report);
        self.go_on(problem, report)
    }

    /// Stores whether the next solve can start at the solution of this solve. Converts a failure to the invalid report.
    pub(super) fn judge(
        &mut self,
        problem: &QpProblem<NX, NU, NR>,
        report: Result<QpReport, NotPositive>,
    ) -> QpReport {
        match report {
            Ok(report) if report.status != QpStatus::Invalid => {
                self.solved = report.status == QpStatus::Solved;
                report
            }
            Ok(_) | Err(NotPositive) => self.invalid(problem),
        }
    }

    /// Stores the solution and the pause of Newton's method until [`Self::take_back`]. Until then Newton's
    /// method is tried without a pause.
    pub(super) fn set_aside(&mut self) {
        let (solution, multipliers, solved, pause) = &mut self.spare;
        solution.copy_from(&self.solution);
        multipliers.iter_mut().zip(&self.multipliers).for_each(|(kept, last)| kept.copy_from(last));
        *solved = self.solved;
        *pause = ::core::mem::take(&mut self.pause);
    }

    /// Restores the stored solution.
    pub(super) fn take_back(&mut self) {
        if !self.solved {
            self.forget();
        }
        let (solution, multipliers, solved, pause) = &self.spare;
        self.solution.copy_from(solution);
        self.multipliers.iter_mut().zip(multipliers).for_each(|(last, kept)| last.copy_from(kept));
        self.solved = *solved;
        self.pause = *pause;
    }

    /// Clears the memory after a solve without a solution. Otherwise numbers that are not finite would remain, because
    /// masks are applied by multiplication.
    pub(super) fn forget(&mut self) {
        self.riccati.forget();
        self.input_bounds.forget();
        self.state_bounds.forget();
        let trajectories = [
            &mut self.iterate,
            &mut self.solution,
            &mut self.step,
            &mut self.gradient,
            &mut self.rhs,
            &mut self.weight,
            &mut self.best,
            &mut self.kept,
        ];
        for trajectory in trajectories {
            trajectory.clear();
        }
        for multipliers in
            self.multipliers.iter_mut().chain(&mut self.best_multipliers).chain(&mut self.kept_multipliers)
        {
            multipliers.clear();
        }
    }

    /// Loads the data of a problem. Returns whether the problem has soft bounds or rows.
    pub(super) fn load(&mut self, problem: &QpProblem<NX, NU, NR>) -> bool {
        let p = problem;
        self.riccati.set_weights(&p.state_weight, &p.input_weight, &p.terminal_weight, &p.input_rate_weight);
        let penalty = p.state_penalty.map(|p| p.map(|p| (p.linear, p.quadratic)));
        self.state_bounds.harden();
        self.fixed.clear();
        self.equalities.clear();
        self.softened = false;
        for (k, stage) in p.stages.iter().enumerate() {
            self.load_stage(k, stage, &penalty);
        }
        self.load_rows(p);
        self.negligible = self.riccati.largest * self.settings.feasibility.powi(2)
            + self.state_bounds.steepest() * ROUNDING;
        let first = &p.stages[0];
        let mut c = first.affine;
        let mut r = first.input_gradient;
        for i in 0..NX {
            for j in 0..NX {
                c[i] += first.state_matrix[i][j] * p.initial_state[j];
            }
        }
        self.constant = 0.0;
        for i in 0..NU {
            for j in 0..NU {
                let weight = 0.5 * (p.input_rate_weight[i][j] + p.input_rate_weight[j][i]);
                r[i] -= weight * p.previous_input[j];
                self.constant += 0.5 * weight * p.previous_input[i] * p.previous_input[j];
            }
        }
        flat_mut(&mut self.affine[..Self::RX])[..NX].copy_from_slice(&c);
        self.linear.set_input(0, &r);
        penalty.iter().any(Option::is_some) || p.row_penalty.iter().any(Option::is_some)
    }

    fn load_rows(&mut self, problem: &QpProblem<NX, NU, NR>) {
        let behind = self.horizon * Self::RX * V::WIDTH;
        let Self { rows, equalities, state_bounds, .. } = self;
        rows.load(problem, |Limits { place, sides: [lower, upper], penalty }| {
            set_bounds(equalities, state_bounds, behind + place, [lower, upper], penalty);
        });
    }

    fn load_stage(&mut self, k: usize, stage: &QpStage<NX, NU, NR>, penalty: &[Option<(f64, f64)>; NX]) {
        let padded = Self::RX * V::WIDTH;
        self.riccati.set_stage(k, &stage.state_matrix, &stage.input_matrix);
        self.linear.set_input(k, &stage.input_gradient);
        self.linear.set_state(k, &stage.state_gradient);
        flat_mut(&mut self.affine[k * Self::RX..][..Self::RX])[..NX].copy_from_slice(&stage.affine);
        for i in 0..NU {
            let (place, [lower, upper]) = (k * NU + i, [stage.input_lower[i], stage.input_upper[i]]);
            if let Some(value) = single_value(lower, upper) {
                self.fixed.set(place, value);
                self.input_bounds.set(place, -f64::INFINITY, f64::INFINITY, None);
            } else {
                self.input_bounds.set(place, lower, upper, None);
            }
        }
        for i in 0..NX {
            let (place, [lower, upper]) = (k * padded + i, [stage.state_lower[i], stage.state_upper[i]]);
            set_bounds(&mut self.equalities, &mut self.state_bounds, place, [lower, upper], penalty[i]);
        }
    }

    /// Result for an invalid problem: the inputs nearest to zero within valid bounds.
    pub(super) fn invalid(&mut self, problem: &QpProblem<NX, NU, NR>) -> QpReport {
        self.solved = false;
        self.solution.clear();
        self.multipliers[0].clear();
        self.multipliers[1].clear();
        for (k, stage) in problem.stages.iter().take(self.horizon).enumerate() {
            let u = core::array::from_fn(|i| nearest_zero(stage.input_lower[i], stage.input_upper[i]));
            self.solution.set_input::<NU>(k, &u);
        }
        let nan = f64::NAN;
        QpReport {
            status: QpStatus::Invalid,
            iterations: 0,
            cost: nan,
            residuals: KktResiduals { stationarity: nan, primal: nan, gap: nan },
        }
    }
}

/// Sets the bounds of number `i` of the padded states and rows. Hard bounds that allow only one value become an equality.
fn set_bounds<V: Vector>(
    equalities: &mut Equalities<V>,
    bounds: &mut Bounds<V>,
    i: usize,
    [lower, upper]: [f64; 2],
    penalty: Option<(f64, f64)>,
) {
    match single_value(lower, upper) {
        Some(value) if penalty.is_none() => {
            equalities.set(i, value);
            bounds.set(i, -f64::INFINITY, f64::INFINITY, None);
        }
        _ => bounds.set(i, lower, upper, penalty),
    }
}

/// Value of a variable whose bounds are equal; `None` for other bounds.
fn single_value(lower: f64, upper: f64) -> Option<f64> {
    let width = upper - lower;
    let single = width.is_finite() && width <= LEAST_WIDTH * lower.abs().max(1.0);
    single.then_some(lower + 0.5 * (upper - lower))
}

/// Number nearest to zero between two bounds, or zero if they are not in order.
fn nearest_zero(lower: f64, upper: f64) -> f64 {
    let nearest = if lower <= upper { 0.0_f64.max(lower).min(upper) } else { 0.0 };
    if nearest.is_finite() { nearest } else { 0.0 }
}
