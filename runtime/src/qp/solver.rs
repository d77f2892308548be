//! The solver: memory, loading of a problem, reading of its solution.

use super::barrier::{Bounds, Multipliers};
use super::interior_point::{Outcome, Start};
use super::lanes::{Lane, WIDTH, flat_mut, lanes, zeros};
use super::problem::{QpProblem, QpStage};
use super::riccati::{NotPositive, Riccati};
use super::status::{KktResiduals, QpError, QpReport, QpSettings, QpStatus};
use super::trajectory::Trajectory;

/// Longest horizon.
pub const MAX_HORIZON: usize = 100;
/// Largest number of states and of inputs.
pub const MAX_SIZE: usize = 32;

/// Interior-point solver for optimal-control QPs of one size. All memory is allocated at construction; a solve allocates nothing, takes at most
/// twice [`QpSettings::max_iterations`] iterations, never panics, and depends on the problem alone: a solve of changed data equals, bit for bit,
/// a solve by a new solver.
///
/// ```
/// use gelenk_runtime::qp::{QpProblem, QpSettings, QpSolver, QpStatus};
///
/// // A mass pushed with at most 1 N, sampled every 0.1 s.
/// let mut problem = QpProblem::<2, 1>::new(20);
/// problem.initial_state = [1.0, 0.0];
/// problem.state_weight = [[1.0, 0.0], [0.0, 0.1]];
/// problem.input_weight = [[0.01]];
/// problem.terminal_weight = [[10.0, 0.0], [0.0, 1.0]];
/// for stage in &mut problem.stages {
///     stage.state_matrix = [[1.0, 0.1], [0.0, 1.0]];
///     stage.input_matrix = [[0.005], [0.1]];
///     stage.input_lower = [-1.0];
///     stage.input_upper = [1.0];
/// }
/// let mut solver = QpSolver::new(20, QpSettings::default())?;
/// let report = solver.solve(&problem);
/// assert_eq!(report.status, QpStatus::Solved);
/// assert!((solver.input(0)[0] + 1.0).abs() < 1e-6);
/// # Ok::<(), gelenk_runtime::qp::QpError>(())
/// ```
#[derive(Debug, Clone)]
pub struct QpSolver<const NX: usize, const NU: usize> {
    pub(super) horizon: usize,
    pub(super) settings: QpSettings,
    pub(super) riccati: Riccati<NX, NU>,
    pub(super) input_bounds: Bounds,
    pub(super) state_bounds: Bounds,
    /// `c_k`, with `A_0 x_0` in c_0.
    pub(super) affine: Vec<Lane>,
    /// Linear cost.
    pub(super) linear: Trajectory,
    /// Iterate; after a solve the solution.
    pub(super) iterate: Trajectory,
    pub(super) step: Trajectory,
    /// Gradient of the cost at the iterate.
    pub(super) gradient: Trajectory,
    /// Gradient of the Newton step, and its diagonal barrier terms.
    pub(super) rhs: Trajectory,
    pub(super) weight: Trajectory,
    /// Multipliers of the solution.
    pub(super) multipliers: [Multipliers; 2],
    /// The iterate with the smallest residuals, kept once a solve takes long.
    pub(super) best: Trajectory,
    pub(super) best_multipliers: [Multipliers; 2],
    solved: bool,
}

impl<const NX: usize, const NU: usize> QpSolver<NX, NU> {
    const RX: usize = lanes(NX);

    /// A solver for horizons of `horizon` stages.
    ///
    /// # Errors
    /// [`QpError`] if the horizon is not 1..=[`MAX_HORIZON`], or `NX` or `NU` not 1..=[`MAX_SIZE`].
    pub fn new(horizon: usize, settings: QpSettings) -> Result<Self, QpError> {
        if !(1..=MAX_HORIZON).contains(&horizon) {
            return Err(QpError::Horizon(horizon));
        }
        if !(1..=MAX_SIZE).contains(&NX) || !(1..=MAX_SIZE).contains(&NU) {
            return Err(QpError::Size);
        }
        let (nu, nx) = (lanes(horizon * NU), horizon * Self::RX);
        let trajectory = Trajectory::new(horizon, NX, NU);
        let multipliers = [Multipliers::new(nu), Multipliers::new(nx)];
        Ok(Self {
            horizon,
            settings,
            riccati: Riccati::new(horizon),
            input_bounds: Bounds::new(nu),
            state_bounds: Bounds::new(nx),
            affine: zeros(nx),
            linear: trajectory.clone(),
            iterate: trajectory.clone(),
            step: trajectory.clone(),
            gradient: trajectory.clone(),
            rhs: trajectory.clone(),
            weight: trajectory.clone(),
            multipliers: multipliers.clone(),
            best: trajectory,
            best_multipliers: multipliers,
            solved: false,
        })
    }

    /// Number of stages `N`.
    pub fn horizon(&self) -> usize {
        self.horizon
    }

    /// Solves from a cold start: nothing of an earlier solve has any influence.
    pub fn solve(&mut self, problem: &QpProblem<NX, NU>) -> QpReport {
        self.solve_from(problem, Start::Cold)
    }

    /// Solves from the solution of the last solve (cold, if there is none), which may have been moved by [`Self::shift`].
    pub fn solve_warm(&mut self, problem: &QpProblem<NX, NU>) -> QpReport {
        let start = if self.solved {
            Start::Warm
        } else {
            Start::Cold
        };
        self.solve_from(problem, start)
    }

    /// Moves the last solution on by one stage, its last stage repeated, as the start of the next [`Self::solve_warm`] in a receding horizon.
    pub fn shift(&mut self) {
        let padded = Self::RX * WIDTH;
        let u = flat_mut(&mut self.iterate.u);
        u.copy_within(NU..self.horizon * NU, 0);
        self.multipliers[0].shift(NU, self.horizon * NU);
        self.multipliers[1].shift(padded, self.horizon * padded);
    }

    /// `u_k` of the solution; zeros for `k ≥ N`.
    pub fn input(&self, k: usize) -> [f64; NU] {
        if k < self.horizon {
            self.iterate.input(k)
        } else {
            [0.0; NU]
        }
    }

    /// `x_k` of the solution, `1 ≤ k ≤ N`, rolled out from the inputs through the dynamics; zeros for other `k`.
    pub fn state(&self, k: usize) -> [f64; NX] {
        if (1..=self.horizon).contains(&k) {
            self.iterate.state(k - 1)
        } else {
            [0.0; NX]
        }
    }

    /// Multipliers `[lower, upper]` of the bounds of `u_k`, all ≥ 0.
    pub fn input_multipliers(&self, k: usize) -> [[f64; 2]; NU] {
        core::array::from_fn(|i| {
            if k < self.horizon {
                self.multipliers[0].get(k * NU + i)
            } else {
                [0.0; 2]
            }
        })
    }

    /// Multipliers `[lower, upper]` of the bounds of `x_k`, `1 ≤ k ≤ N`, all ≥ 0.
    pub fn state_multipliers(&self, k: usize) -> [[f64; 2]; NX] {
        let padded = Self::RX * WIDTH;
        let inside = (1..=self.horizon).contains(&k);
        core::array::from_fn(|i| {
            if inside {
                self.multipliers[1].get((k - 1) * padded + i)
            } else {
                [0.0; 2]
            }
        })
    }

    fn solve_from(&mut self, problem: &QpProblem<NX, NU>, start: Start) -> QpReport {
        let valid = problem.stages.len() == self.horizon && problem.is_valid();
        if !valid {
            return self.invalid(problem);
        }
        let soft = self.load(problem);
        let outcome = if soft {
            self.run::<true>(start)
        } else {
            self.run::<false>(start)
        };
        let outcome = outcome.and_then(|outcome| {
            if outcome.feasible {
                Ok(outcome)
            } else {
                self.relax(outcome)
            }
        });
        match outcome {
            Ok(outcome) => self.finish(problem, outcome),
            Err(NotPositive) => self.invalid(problem),
        }
    }

    /// Takes over the data. Returns whether there are soft bounds.
    #[inline(always)]
    fn load(&mut self, problem: &QpProblem<NX, NU>) -> bool {
        let p = problem;
        self.riccati.set_weights(
            &p.state_weight,
            &p.input_weight,
            &p.terminal_weight,
            &p.input_rate_weight,
        );
        let penalty = p.state_penalty.map(|p| p.map(|p| (p.linear, p.quadratic)));
        self.state_bounds.harden();
        for (k, stage) in p.stages.iter().enumerate() {
            self.load_stage(k, stage, &penalty);
        }
        let first = &p.stages[0];
        let mut c = first.affine;
        let mut r = first.input_gradient;
        for i in 0..NX {
            for j in 0..NX {
                c[i] += first.state_matrix[i][j] * p.initial_state[j];
            }
        }
        for i in 0..NU {
            for j in 0..NU {
                r[i] -= 0.5
                    * (p.input_rate_weight[i][j] + p.input_rate_weight[j][i])
                    * p.previous_input[j];
            }
        }
        flat_mut(&mut self.affine[..Self::RX])[..NX].copy_from_slice(&c);
        self.linear.set_input(0, &r);
        penalty.iter().any(Option::is_some)
    }

    #[inline(always)]
    fn load_stage(
        &mut self,
        k: usize,
        stage: &QpStage<NX, NU>,
        penalty: &[Option<(f64, f64)>; NX],
    ) {
        let padded = Self::RX * WIDTH;
        self.riccati
            .set_stage(k, &stage.state_matrix, &stage.input_matrix);
        self.linear.set_input(k, &stage.input_gradient);
        self.linear.set_state(k, &stage.state_gradient);
        flat_mut(&mut self.affine[k * Self::RX..][..Self::RX])[..NX].copy_from_slice(&stage.affine);
        for i in 0..NU {
            self.input_bounds
                .set(k * NU + i, stage.input_lower[i], stage.input_upper[i], None);
        }
        for i in 0..NX {
            self.state_bounds.set(
                k * padded + i,
                stage.state_lower[i],
                stage.state_upper[i],
                penalty[i],
            );
        }
    }

    /// Inputs into their bounds, states from the dynamics, residuals from both.
    fn finish(&mut self, problem: &QpProblem<NX, NU>, outcome: Outcome) -> QpReport {
        for (k, stage) in problem.stages.iter().enumerate() {
            let u: [f64; NU] = self.iterate.input(k);
            let clipped =
                core::array::from_fn(|i| u[i].max(stage.input_lower[i]).min(stage.input_upper[i]));
            self.iterate.set_input::<NU>(k, &clipped);
        }
        self.riccati.roll_out(&mut self.iterate, &self.affine);
        let (quadratic, linear) =
            self.riccati
                .gradient(&self.iterate, &self.linear, &mut self.gradient);
        self.multipliers[0].subtract_from(&mut self.gradient.u);
        self.multipliers[1].subtract_from(&mut self.gradient.x);
        let residuals = KktResiduals {
            stationarity: self.riccati.reduced_gradient(&self.gradient),
            primal: self.state_bounds.violation(&self.iterate.x, true),
            gap: outcome.gap,
        };
        self.solved = outcome.status == QpStatus::Solved || outcome.status == QpStatus::Relaxed;
        let cost = 0.5 * quadratic + linear + self.state_bounds.penalty(&self.iterate.x);
        QpReport {
            status: outcome.status,
            iterations: outcome.iterations,
            cost,
            residuals,
        }
    }

    /// The answer where there is no QP to solve: inputs nearest zero within those bounds that make sense.
    fn invalid(&mut self, problem: &QpProblem<NX, NU>) -> QpReport {
        self.solved = false;
        self.iterate.clear();
        self.multipliers[0].clear();
        self.multipliers[1].clear();
        for (k, stage) in problem.stages.iter().take(self.horizon).enumerate() {
            let u =
                core::array::from_fn(|i| nearest_zero(stage.input_lower[i], stage.input_upper[i]));
            self.iterate.set_input::<NU>(k, &u);
        }
        let nan = f64::NAN;
        QpReport {
            status: QpStatus::Invalid,
            iterations: 0,
            cost: nan,
            residuals: KktResiduals {
                stationarity: nan,
                primal: nan,
                gap: nan,
            },
        }
    }
}

/// The number nearest zero between two bounds, or zero if they are not in order.
fn nearest_zero(lower: f64, upper: f64) -> f64 {
    let nearest = if lower <= upper {
        0.0_f64.max(lower).min(upper)
    } else {
        0.0
    };
    if nearest.is_finite() { nearest } else { 0.0 }
}
