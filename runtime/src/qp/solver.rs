//! Public interface of the solver. It checks the sizes, selects the vector instructions and returns the solution.

use super::core::{Core, Start};
use super::lanes::Portable;
#[cfg(all(target_arch = "x86_64", feature = "std"))]
use super::lanes::lanes;
use super::problem::QpProblem;
use super::status::{QpError, QpReport, QpSettings};
#[cfg(all(target_arch = "x86_64", feature = "std"))]
use super::x86::{Avx2, Avx512, has_avx2, has_avx512};

/// Largest horizon in stages.
pub const MAX_HORIZON: usize = 100;
/// Largest number of states, of inputs, and of rows per stage.
pub const MAX_SIZE: usize = 32;

/// Interior-point solver for optimal-control QPs of one size.
///
/// All memory is allocated at construction. A solve does not allocate and never panics. A solve with a cold start takes
/// at most three times [`QpSettings::max_iterations`] iterations. A warm start takes at most 16 more iterations. The
/// result of a cold start only depends on the problem, and equals the result of a new solver bit for bit. The result of a
/// warm start also depends on earlier solves.
///
/// On x86-64 processors, the construction of a solver selects the vector instructions. They are AVX-512 if this needs fewer
/// vectors for the states than AVX2, otherwise AVX2 with fused multiply-add, if the processor has them. Results with
/// different instructions differ by rounding.
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
pub struct QpSolver<const NX: usize, const NU: usize, const NR: usize = 0>(Engine<NX, NU, NR>);

/// The method, compiled for the vector instructions of this processor.
#[derive(Debug, Clone)]
enum Engine<const NX: usize, const NU: usize, const NR: usize> {
    Portable(Core<Portable, NX, NU, NR>),
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    Avx2(Core<Avx2, NX, NU, NR>),
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    Avx512(Core<Avx512, NX, NU, NR>),
}

/// Calls a function of the solver core that was compiled for the selected vector instructions.
macro_rules! core {
    ($solver:expr, $core:ident => $call:expr) => {
        match $solver {
            Engine::Portable($core) => $call,
            #[cfg(all(target_arch = "x86_64", feature = "std"))]
            Engine::Avx2($core) => $call,
            #[cfg(all(target_arch = "x86_64", feature = "std"))]
            Engine::Avx512($core) => $call,
        }
    };
}

impl<const NX: usize, const NU: usize, const NR: usize> QpSolver<NX, NU, NR> {
    /// A solver for horizons of `horizon` stages.
    ///
    /// # Errors
    /// - [`QpError::Horizon`] if the horizon is not in 1..=[`MAX_HORIZON`].
    /// - [`QpError::Size`] if `NX` or `NU` is not in 1..=[`MAX_SIZE`], or `NR` exceeds [`MAX_SIZE`].
    pub fn new(horizon: usize, settings: QpSettings) -> Result<Self, QpError> {
        if !(1..=MAX_HORIZON).contains(&horizon) {
            return Err(QpError::Horizon(horizon));
        }
        if !(1..=MAX_SIZE).contains(&NX) || !(1..=MAX_SIZE).contains(&NU) || NR > MAX_SIZE {
            return Err(QpError::Size);
        }
        #[cfg(all(target_arch = "x86_64", feature = "std"))]
        {
            // A state of at most four numbers needs one register of either kind.
            if lanes::<Avx512>(NX) < lanes::<Avx2>(NX) && has_avx512() {
                return Ok(Self(Engine::Avx512(Core::new(horizon, settings))));
            }
            if has_avx2() {
                return Ok(Self(Engine::Avx2(Core::new(horizon, settings))));
            }
        }
        Ok(Self(Engine::Portable(Core::new(horizon, settings))))
    }

    /// Number N of stages.
    pub fn horizon(&self) -> usize {
        core!(&self.0, core => core.horizon)
    }

    /// Solves the problem with a cold start. Earlier solves have no influence on the result.
    pub fn solve(&mut self, problem: &QpProblem<NX, NU, NR>) -> QpReport {
        core!(&mut self.0, core => match core.accepts(problem) {
            true => core.solve(problem, Start::Cold),
            false => core.invalid(problem),
        })
    }

    /// Solves the problem with a warm start from the last solution. Call [`Self::shift`] before if the horizon recedes. The
    /// solver makes these attempts:
    ///
    /// 1. Newton's method from the active set of the last solution. It takes few iterations if this set changes little.
    ///    After failures this attempt is skipped for up to 31 problems.
    /// 2. The interior-point method from a point near the last solution.
    /// 3. A cold start, also if the last problem was not solved.
    ///
    /// The result depends on all solves since the construction of the solver.
    pub fn solve_warm(&mut self, problem: &QpProblem<NX, NU, NR>) -> QpReport {
        core!(&mut self.0, core => match core.accepts(problem) {
            true => core.solve_warm(problem),
            false => core.invalid(problem),
        })
    }

    /// Repeats the computations of a cold and a warm solve only to warm up the processor caches. The last solution is kept.
    pub(crate) fn rehearse(&mut self, problem: &QpProblem<NX, NU, NR>) {
        core!(&mut self.0, core => core.set_aside());
        core::hint::black_box(self.solve(problem));
        core::hint::black_box(self.solve_warm(problem));
        core!(&mut self.0, core => core.take_back());
    }

    /// Shifts the last solution by one stage and repeats its last stage. The next [`Self::solve_warm`] of a receding horizon
    /// starts at the shifted solution.
    pub fn shift(&mut self) {
        core!(&mut self.0, core => core.shift());
    }

    /// Input `u_k` of the solution; zeros beyond the last stage.
    pub fn input(&self, k: usize) -> [f64; NU] {
        core!(&self.0, core => core.input(k))
    }

    /// State `x_k` of the solution after k of the N stages, `1 ≤ k ≤ N`, computed from the inputs by the
    /// dynamics; zeros for other `k`.
    pub fn state(&self, k: usize) -> [f64; NX] {
        core!(&self.0, core => core.state(k))
    }

    /// Multipliers `[lower, upper]` of the bounds of the input `u_k`, all ≥ 0; zeros beyond the last stage.
    pub fn input_multipliers(&self, k: usize) -> [[f64; 2]; NU] {
        core!(&self.0, core => core.input_multipliers(k))
    }

    /// Multipliers `[lower, upper]` of the bounds of the state `x_k` after k of the N stages, `1 ≤ k ≤ N`,
    /// all ≥ 0; zeros for other `k`.
    pub fn state_multipliers(&self, k: usize) -> [[f64; 2]; NX] {
        core!(&self.0, core => core.state_multipliers(k))
    }

    /// Multipliers `[lower, upper]` of the rows of node `k`, `0 ≤ k ≤ N` for N stages, all ≥ 0; zeros for
    /// other `k`.
    pub fn row_multipliers(&self, k: usize) -> [[f64; 2]; NR] {
        core!(&self.0, core => core.row_multipliers(k))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "test code")]

    use super::super::problem::{Penalty, QpProblem};
    use super::super::status::QpStatus;
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    const HORIZON: usize = 12;

    /// Coupled masses away from rest, with hard input bounds, soft bounds of the speeds, and a weight of the input's change.
    fn problem<const NX: usize, const NU: usize>(seed: u64) -> QpProblem<NX, NU> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut any = |size: f64| size * random.random_range(-1.0..1.0);
        let mut problem = QpProblem::<NX, NU>::new(HORIZON);
        let coupling: [[f64; NU]; NU] = core::array::from_fn(|_| core::array::from_fn(|_| any(0.1)));
        for i in 0..NX {
            problem.initial_state[i] = any(2.0);
            problem.state_weight[i][i] = 1.0;
            problem.terminal_weight[i][i] = 10.0;
        }
        for i in 0..NU {
            (problem.input_weight[i][i], problem.input_rate_weight[i][i]) = (0.01, 0.001 * (seed % 2) as f64);
            problem.state_penalty[NX - 1 - i] = Some(Penalty { linear: 50.0, quadratic: 10.0 });
        }
        for stage in &mut problem.stages {
            for i in 0..NX {
                stage.state_matrix[i][i] = 1.0;
                if i + NU < NX {
                    stage.state_matrix[i][i + NU] = 0.1;
                }
            }
            for i in 0..NU {
                let last = NX - NU + i;
                stage.input_matrix[last] = coupling[i];
                stage.input_matrix[last][i] += 0.2;
                (stage.input_lower[i], stage.input_upper[i]) = (-1.0, 0.8);
                (stage.state_lower[last], stage.state_upper[last]) = (-0.4, 0.4);
            }
        }
        problem
    }

    /// Costs of a cold solve, and of a warm solve of the shifted problem. All problems have active bounds.
    fn costs<const NX: usize, const NU: usize>(engine: Engine<NX, NU, 0>, seed: u64) -> [f64; 2] {
        let (mut solver, mut problem) = (QpSolver(engine), problem::<NX, NU>(seed));
        let cold = solver.solve(&problem);
        let at_bound = |k: usize| solver.input(k).iter().any(|input| *input < -0.99 || *input > 0.79);
        assert!((0..HORIZON).any(at_bound), "no bound is active");
        problem.initial_state = solver.state(1);
        solver.shift();
        let warm = solver.solve_warm(&problem);
        [cold, warm].map(|report| {
            assert_eq!(report.status, QpStatus::Solved, "{NX} states, seed {seed}");
            report.cost
        })
    }

    fn agree<const NX: usize, const NU: usize>() {
        let settings = QpSettings { tolerance: 1e-9, ..QpSettings::default() };
        for seed in 0..4 {
            let expected = costs::<NX, NU>(Engine::Portable(Core::new(HORIZON, settings)), seed);
            let assert_near = |found: [f64; 2]| {
                for (found, expected) in found.iter().zip(&expected) {
                    assert!(
                        (found - expected).abs() < 1e-8 * expected.abs(),
                        "{NX}, {seed}: {found}, {expected}"
                    );
                }
            };
            #[cfg(all(target_arch = "x86_64", feature = "std"))]
            {
                if has_avx2() {
                    assert_near(costs::<NX, NU>(Engine::Avx2(Core::new(HORIZON, settings)), seed));
                }
                if has_avx512() {
                    assert_near(costs::<NX, NU>(Engine::Avx512(Core::new(HORIZON, settings)), seed));
                }
            }
        }
    }

    /// Sizes with and without padding. The solver would choose only one kind of vectors on this processor.
    #[test]
    fn all_kinds_of_vectors_find_the_same_optimum() {
        agree::<2, 1>();
        agree::<9, 4>();
        agree::<14, 7>();
    }
}
