//! LASSO on a path of λ, by coordinate descent on the Gram matrix (Friedman, Hastie, Tibshirani 2010).
//!
//! Convention of every λ in this crate (glmnet's and scikit-learn's):
//! `min 1/(2N) ‖y − Θ ξ‖² + λ Σ ωᵢ |ξᵢ|`. The form `‖y − Θ ξ‖² + λ' ‖ξ‖₁` has `λ' = 2 N λ`:
//! [`paper_lambda`].

use super::error::{IdentificationError, Result, require_length, require_setting};
use super::least_squares::solve_scaled;
use super::moments::Moments;
use nalgebra::{DMatrix, DVector};

/// λ' of `‖y − Θ ξ‖² + λ' ‖ξ‖₁` for the λ of `1/(2N) ‖y − Θ ξ‖² + λ ‖ξ‖₁`.
pub fn paper_lambda(lambda: f64, samples: usize) -> f64 {
    2.0 * samples as f64 * lambda
}

/// Settings of the LASSO.
#[derive(Debug, Clone, PartialEq)]
pub struct Lasso {
    /// Penalize each term in units of its root mean square (`ωᵢ = rms θᵢ`) instead of `ωᵢ = 1`.
    pub standardize: bool,
    /// Terms without penalty (`ωᵢ = 0`).
    pub unpenalized: Vec<usize>,
    /// Terms whose coefficient must not be negative.
    pub nonnegative: Vec<usize>,
    /// Duality gap at which a solve ends, relative to `‖y‖²/(2N)`.
    pub tolerance: f64,
    /// Limit of the sweeps over all terms, for each λ.
    pub max_sweeps: usize,
}

impl Default for Lasso {
    fn default() -> Self {
        Self {
            standardize: false,
            unpenalized: Vec::new(),
            nonnegative: Vec::new(),
            tolerance: 1e-10,
            max_sweeps: 100_000,
        }
    }
}

/// Solutions along a path of λ.
#[derive(Debug, Clone, PartialEq)]
pub struct LassoPath {
    /// λ, descending.
    pub lambdas: Vec<f64>,
    /// Coefficients `[p × number of λ]`.
    pub coefficients: DMatrix<f64>,
    /// Duality gap of each solution: an upper bound of its distance to the optimal objective.
    pub gaps: Vec<f64>,
    /// Sweeps needed.
    pub sweeps: Vec<usize>,
}

impl Lasso {
    /// Smallest λ at which every penalized coefficient is zero.
    ///
    /// # Errors
    /// A zero target or term, or settings out of range.
    pub fn largest_lambda(&self, moments: &Moments, target: usize) -> Result<f64> {
        let problem = Problem::new(self, moments, target)?;
        let start = problem.unpenalized_fit();
        let c = &problem.b - &problem.gram * start;
        let bound = |j: usize| {
            let c = if problem.nonnegative[j] { c[j].max(0.0) } else { c[j].abs() };
            if problem.weights[j] > 0.0 { c / (problem.samples * problem.weights[j]) } else { 0.0 }
        };
        // A few units in the last place more, so that rounding leaves no coefficient at this λ.
        Ok((0..c.len()).map(bound).fold(0.0, f64::max) * (1.0 + 4.0 * f64::EPSILON))
    }

    /// `count` values from [`Self::largest_lambda`] down to `ratio` times it, evenly spaced in the logarithm.
    ///
    /// # Errors
    /// `ratio` outside (0, 1), no values, or as [`Self::largest_lambda`].
    pub fn lambda_grid(
        &self,
        moments: &Moments,
        target: usize,
        count: usize,
        ratio: f64,
    ) -> Result<Vec<f64>> {
        require_setting("ratio of λ", ratio, ratio > 0.0 && ratio < 1.0, "it must lie between 0 and 1")?;
        require_setting("number of λ", count as f64, count >= 2, "at least two are needed")?;
        let largest = self.largest_lambda(moments, target)?;
        let step = |i: usize| largest * ratio.powf(i as f64 / (count - 1) as f64);
        Ok((0..count).map(step).collect())
    }

    /// Solves for each λ, each solve starting from the one before.
    ///
    /// # Errors
    /// λ negative or NaN, a zero target or term, or a gap that stays above the tolerance.
    pub fn path(&self, moments: &Moments, target: usize, lambdas: &[f64]) -> Result<LassoPath> {
        let problem = Problem::new(self, moments, target)?;
        let mut path = LassoPath {
            lambdas: lambdas.to_vec(),
            coefficients: DMatrix::zeros(moments.terms(), lambdas.len()),
            gaps: Vec::with_capacity(lambdas.len()),
            sweeps: Vec::with_capacity(lambdas.len()),
        };
        let mut state = State::new(&problem);
        for (column, &lambda) in lambdas.iter().enumerate() {
            require_setting("λ", lambda, lambda >= 0.0, "it must be finite and not negative")?;
            let (gap, sweeps) = problem.solve(lambda, &mut state, self)?;
            path.coefficients.set_column(column, &state.w);
            path.gaps.push(gap);
            path.sweeps.push(sweeps);
        }
        Ok(path)
    }

    /// Chosen terms at one λ; an error if there are none.
    ///
    /// # Errors
    /// [`IdentificationError::EverythingRemoved`] with the largest λ that keeps a term; else as
    /// [`Self::path`].
    pub fn fit(&self, moments: &Moments, target: usize, lambda: f64) -> Result<(DVector<f64>, Vec<usize>)> {
        let path = self.path(moments, target, &[lambda])?;
        let coefficients = path.coefficients.column(0).into_owned();
        let active = active_terms(&coefficients);
        if active.is_empty() {
            return Err(IdentificationError::EverythingRemoved {
                what: "lambda".into(),
                value: lambda,
                largest: self.largest_lambda(moments, target)?,
            });
        }
        Ok((coefficients, active))
    }
}

/// Indices of the coefficients that are not zero.
pub fn active_terms(coefficients: &DVector<f64>) -> Vec<usize> {
    (0..coefficients.len()).filter(|&i| coefficients[i] != 0.0).collect()
}

struct Problem {
    gram: DMatrix<f64>,
    b: DVector<f64>,
    energy: f64,
    samples: f64,
    weights: Vec<f64>,
    nonnegative: Vec<bool>,
}

/// Coefficients w and the residual correlations c = b − G w.
struct State {
    w: DVector<f64>,
    c: DVector<f64>,
}

impl State {
    fn new(problem: &Problem) -> Self {
        Self { w: DVector::zeros(problem.b.len()), c: problem.b.clone() }
    }
}

impl Problem {
    fn new(settings: &Lasso, moments: &Moments, target: usize) -> Result<Self> {
        if target >= moments.targets() {
            require_length("targets", target + 1, moments.targets())?;
        }
        require_setting("tolerance", settings.tolerance, settings.tolerance > 0.0, "it must be positive")?;
        moments.require_no_zero_column()?;
        let (p, samples) = (moments.terms(), moments.samples() as f64);
        for &i in settings.unpenalized.iter().chain(&settings.nonnegative) {
            if i >= p {
                require_length("terms", i + 1, p)?;
            }
        }
        let energy = moments.energy(target);
        if energy == 0.0 {
            return Err(IdentificationError::ZeroColumn {
                term: format!("target {target}"),
                samples: moments.samples(),
            });
        }
        let gram = moments.gram();
        let weight = |i: usize| match (settings.unpenalized.contains(&i), settings.standardize) {
            (true, _) => 0.0,
            (false, true) => (gram[(i, i)] / samples).sqrt(),
            (false, false) => 1.0,
        };
        Ok(Self {
            weights: (0..p).map(weight).collect(),
            nonnegative: (0..p).map(|i| settings.nonnegative.contains(&i)).collect(),
            b: moments.projection(target),
            gram,
            energy,
            samples,
        })
    }

    fn unpenalized_fit(&self) -> DVector<f64> {
        let free: Vec<usize> = (0..self.b.len()).filter(|&i| self.weights[i] == 0.0).collect();
        let mut w = DVector::zeros(self.b.len());
        if let Some(small) = solve_scaled(&self.gram, &self.b, &free, 0.0) {
            for (&i, x) in free.iter().zip(small.iter()) {
                w[i] = *x;
            }
        }
        w
    }

    fn solve(&self, lambda: f64, state: &mut State, settings: &Lasso) -> Result<(f64, usize)> {
        let bound = settings.tolerance * self.energy / (2.0 * self.samples);
        let mut gap = f64::INFINITY;
        for sweep in 1..=settings.max_sweeps {
            self.sweep(lambda, state);
            // The direct solve below ends most λ after the first sweeps; later ones only help hard cases.
            if sweep <= 3 || sweep % 10 == 0 {
                self.solve_on_support(lambda, state);
                gap = self.gap(lambda, state);
                if gap <= bound {
                    return Ok((gap, sweep));
                }
            }
        }
        Err(IdentificationError::NotConverged {
            what: format!("the LASSO at λ = {lambda:e}"),
            iterations: settings.max_sweeps,
            detail: format!("duality gap {gap:e}, wanted {bound:e}; the terms may be collinear"),
        })
    }

    /// One round of coordinate descent with soft thresholding.
    fn sweep(&self, lambda: f64, state: &mut State) {
        for j in 0..state.w.len() {
            let diagonal = self.gram[(j, j)];
            let q = state.c[j] + diagonal * state.w[j];
            let threshold = self.samples * lambda * self.weights[j];
            let shrunk = if q > threshold {
                q - threshold
            } else if q < -threshold && !self.nonnegative[j] {
                q + threshold
            } else {
                0.0
            };
            let change = shrunk / diagonal - state.w[j];
            if change != 0.0 {
                state.c.axpy(-change, &self.gram.column(j), 1.0);
                state.w[j] += change;
                if shrunk == 0.0 {
                    state.w[j] = 0.0;
                }
            }
        }
    }

    /// Solves the optimality conditions for the present signs (feature-sign search; Lee et al. 2006).
    ///
    /// Where a coefficient would change its sign, the step ends there and that coefficient leaves the
    /// support.
    fn solve_on_support(&self, lambda: f64, state: &mut State) {
        for _ in 0..state.w.len() {
            let active = active_terms(&state.w);
            let right = DVector::from_fn(self.b.len(), |j, _| {
                self.b[j] - self.samples * lambda * self.weights[j] * state.w[j].signum()
            });
            let solution = match self.null_direction(&active) {
                None => solve_scaled(&self.gram, &right, &active, 0.0),
                Some(direction) => self.along_null_direction(&active, &direction, &state.w),
            };
            let Some(solution) = solution else { break };
            let (fraction, leaving) = self.largest_step(&active, &solution, &state.w);
            for (&j, x) in active.iter().zip(solution.iter()) {
                state.w[j] += fraction * (x - state.w[j]);
            }
            let Some(leaving) = leaving else { break };
            state.w[leaving] = 0.0;
        }
        state.c = &self.b - &self.gram * &state.w;
    }

    /// A direction that changes no fitted value, where the active terms are collinear.
    fn null_direction(&self, active: &[usize]) -> Option<DVector<f64>> {
        let n = active.len();
        let norm = |i: usize| self.gram[(active[i], active[i])].sqrt();
        let scaled = DMatrix::from_fn(n, n, |i, j| self.gram[(active[i], active[j])] / (norm(i) * norm(j)));
        // Cholesky's least pivot bounds the least eigenvalue from above and is much cheaper.
        let regular = scaled.clone().cholesky().is_some_and(|f| f.l_dirty().diagonal().amin() > 1e-5);
        if regular || n == 0 {
            return None;
        }
        let eigen = scaled.symmetric_eigen();
        let least = eigen.eigenvalues.imin();
        if eigen.eigenvalues[least] > 1e-12 {
            return None;
        }
        Some(DVector::from_fn(n, |i, _| eigen.eigenvectors[(i, least)] / norm(i)))
    }

    /// A far point along a null direction, downhill in the penalty, so that some coefficient reaches zero.
    fn along_null_direction(
        &self,
        active: &[usize],
        direction: &DVector<f64>,
        w: &DVector<f64>,
    ) -> Option<DVector<f64>> {
        let slope: f64 =
            (0..active.len()).map(|i| self.weights[active[i]] * w[active[i]].signum() * direction[i]).sum();
        let sign = if slope > 0.0 { -1.0 } else { 1.0 };
        let ratio = |i: usize| {
            if sign * direction[i] * w[active[i]] < 0.0 {
                (w[active[i]] / direction[i]).abs()
            } else {
                f64::INFINITY
            }
        };
        let length = (0..active.len()).map(ratio).fold(f64::INFINITY, f64::min);
        let far = |i: usize| w[active[i]] + sign * 2.0 * length * direction[i];
        length.is_finite().then(|| DVector::from_fn(active.len(), |i, _| far(i)))
    }

    /// Share of the step to `solution` that keeps all signs, and the coefficient that ends it.
    fn largest_step(
        &self,
        active: &[usize],
        solution: &DVector<f64>,
        w: &DVector<f64>,
    ) -> (f64, Option<usize>) {
        let mut step = (1.0, None);
        for (&j, x) in active.iter().zip(solution.iter()) {
            let may_change_sign = self.weights[j] == 0.0 && !self.nonnegative[j];
            if !may_change_sign && x * w[j] <= 0.0 {
                let share = w[j] / (w[j] - x);
                if share < step.0 || step.1.is_none() {
                    step = (share.min(step.0), Some(j));
                }
            }
        }
        step
    }

    /// Primal minus dual objective, with the dual point `s (y − Θ w)/N`, s as large as feasibility allows.
    fn gap(&self, lambda: f64, state: &State) -> f64 {
        let fitted = self.b.dot(&state.w);
        let residual_target = self.energy - fitted;
        let residual = (residual_target - state.c.dot(&state.w)).max(0.0);
        let mut scale = 1.0_f64;
        for j in 0..state.w.len() {
            let c = if self.nonnegative[j] { state.c[j].max(0.0) } else { state.c[j].abs() };
            let limit = self.samples * lambda * self.weights[j];
            if self.weights[j] > 0.0 && c > limit {
                scale = scale.min(limit / c);
            }
        }
        let penalty: f64 = state.w.iter().zip(&self.weights).map(|(w, o)| o * w.abs()).sum();
        let primal = residual / (2.0 * self.samples) + lambda * penalty;
        let dual = (2.0 * scale * residual_target - scale * scale * residual) / (2.0 * self.samples);
        (primal - dual).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::moments::Samples;
    use super::super::random::SplitMix64;
    use super::*;
    use clarabel::algebra::CscMatrix;
    use clarabel::solver::{
        DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SupportedConeT,
    };

    fn random_moments(seed: u64, m: usize, p: usize, correlated: bool) -> Moments {
        let mut random = SplitMix64::new(seed);
        let mut theta = DMatrix::from_fn(m, p, |_, _| random.normal());
        if correlated {
            for j in 1..p {
                let previous = theta.column(j - 1).into_owned();
                theta.column_mut(j).axpy(0.9, &previous, 0.4);
            }
        }
        let truth = DVector::from_fn(p, |j, _| if j % 3 == 0 { 1.5 - j as f64 / 4.0 } else { 0.0 });
        let noise = DVector::from_fn(m, |_, _| 0.3 * random.normal());
        let y = &theta * truth + noise;
        let names: Vec<String> = (0..p).map(|j| format!("t{j}")).collect();
        Moments::new(&Samples::from_matrix(&names, &theta, vec![y.as_slice()]).unwrap()).unwrap()
    }

    /// The same problem as a quadratic program in (w⁺, w⁻) ≥ 0, by an interior-point solver.
    fn by_interior_points(
        moments: &Moments,
        lambda: f64,
        weights: &[f64],
        nonnegative: &[usize],
    ) -> DVector<f64> {
        let (p, n) = (moments.terms(), moments.samples() as f64);
        let (g, b) = (moments.gram() / n, moments.projection(0) / n);
        let sign = |i: usize| if i < p { 1.0 } else { -1.0 };
        let hessian: Vec<Vec<f64>> = (0..2 * p)
            .map(|i| {
                (0..2 * p).map(|j| if i <= j { sign(i) * sign(j) * g[(i % p, j % p)] } else { 0.0 }).collect()
            })
            .collect();
        let q: Vec<f64> = (0..2 * p).map(|i| lambda * weights[i % p] - sign(i) * b[i % p]).collect();
        let mut rows: Vec<Vec<f64>> =
            (0..2 * p).map(|i| (0..2 * p).map(|j| if i == j { -1.0 } else { 0.0 }).collect()).collect();
        for &j in nonnegative {
            rows.push((0..2 * p).map(|k| if k == p + j { 1.0 } else { 0.0 }).collect());
        }
        let zeros = vec![0.0; rows.len()];
        let cones: [SupportedConeT<f64>; 1] = [NonnegativeConeT(rows.len())];
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .tol_gap_abs(1e-13)
            .tol_gap_rel(1e-13)
            .tol_feas(1e-13)
            .build()
            .unwrap();
        let mut solver = DefaultSolver::new(
            &CscMatrix::from(&hessian),
            &q,
            &CscMatrix::from(&rows),
            &zeros,
            &cones,
            settings,
        )
        .unwrap();
        solver.solve();
        DVector::from_fn(p, |j, _| solver.solution.x[j] - solver.solution.x[p + j])
    }

    #[test]
    fn orthogonal_columns_are_soft_thresholded() {
        // Closed form for ΘᵀΘ = N I: ξ = S(Θᵀy/N, λ).
        let names: Vec<String> = ["a", "b", "c"].map(String::from).to_vec();
        let m = 8;
        let theta = DMatrix::from_fn(m, 3, |i, j| if i >> j & 1 == 0 { 1.0 } else { -1.0 });
        let y = &theta * DVector::from_column_slice(&[2.0, -0.7, 0.3]);
        let moments =
            Moments::new(&Samples::from_matrix(&names, &theta, vec![y.as_slice()]).unwrap()).unwrap();
        let lasso = Lasso::default();
        let path = lasso.path(&moments, 0, &[0.5]).unwrap();
        let expected = DVector::from_column_slice(&[1.5, -0.2, 0.0]);
        assert!((path.coefficients.column(0) - expected).amax() < 1e-14);
        assert!((lasso.largest_lambda(&moments, 0).unwrap() - 2.0).abs() < 1e-14);
        assert_eq!(paper_lambda(0.5, m), 8.0);
    }

    #[test]
    fn agrees_with_clarabel_on_random_problems() {
        for seed in 0..12 {
            let moments = random_moments(seed, 60, 9, seed % 2 == 0);
            let lasso = Lasso {
                standardize: seed % 3 == 0,
                nonnegative: if seed % 4 == 1 { vec![6, 8] } else { vec![] },
                tolerance: 1e-13,
                ..Default::default()
            };
            let weights: Vec<f64> = (0..9)
                .map(|j| if lasso.standardize { (moments.gram()[(j, j)] / 60.0).sqrt() } else { 1.0 })
                .collect();
            let grid = lasso.lambda_grid(&moments, 0, 8, 1e-3).unwrap();
            let path = lasso.path(&moments, 0, &grid).unwrap();
            for (k, &lambda) in grid.iter().enumerate() {
                let reference = by_interior_points(&moments, lambda, &weights, &lasso.nonnegative);
                let difference = (path.coefficients.column(k) - reference).amax();
                assert!(difference < 2e-6, "seed {seed}, λ {lambda:e}: {difference:e}");
            }
            assert!(path.coefficients.column(0).amax() < 1e-12);
        }
    }

    #[test]
    fn more_terms_than_samples_still_have_a_solution() {
        let moments = random_moments(5, 12, 20, false);
        let lasso = Lasso { tolerance: 1e-9, ..Default::default() };
        let grid = lasso.lambda_grid(&moments, 0, 5, 0.05).unwrap();
        let path = lasso.path(&moments, 0, &grid).unwrap();
        assert!(path.gaps.iter().all(|g| *g <= 1e-9 * moments.energy(0)));
    }

    #[test]
    fn equal_columns_share_a_coefficient() {
        let one = vec![1.0; 40];
        let y: Vec<f64> = (0..40).map(|i| 2.0 + f64::from(i % 3)).collect();
        let x: Vec<f64> = (0..40).map(f64::from).collect();
        let names: Vec<String> = ["1", "x", "sign"].map(String::from).to_vec();
        let samples = Samples::from_columns(&names, vec![&one, &x, &one], vec![&y]).unwrap();
        let lasso = Lasso { tolerance: 1e-12, ..Default::default() };
        let twice = Moments::new(&samples).unwrap();
        let samples = Samples::from_columns(&names[..2], vec![&one, &x], vec![&y]).unwrap();
        let once = Moments::new(&samples).unwrap();
        let grid = lasso.lambda_grid(&once, 0, 20, 1e-4).unwrap();
        let (a, b) = (lasso.path(&twice, 0, &grid).unwrap(), lasso.path(&once, 0, &grid).unwrap());
        for k in 0..20 {
            let sum = a.coefficients[(0, k)] + a.coefficients[(2, k)];
            assert!((sum - b.coefficients[(0, k)]).abs() < 1e-6, "{k}: {sum} {}", b.coefficients[(0, k)]);
        }
    }

    #[test]
    fn unpenalized_terms_enter_first() {
        let moments = random_moments(2, 80, 6, false);
        let lasso = Lasso { unpenalized: vec![1], ..Default::default() };
        let largest = lasso.largest_lambda(&moments, 0).unwrap();
        let (coefficients, active) = lasso.fit(&moments, 0, 1.0001 * largest).unwrap();
        assert_eq!(active, [1]);
        let alone = moments.projection(0)[1] / moments.gram()[(1, 1)];
        assert!((coefficients[1] - alone).abs() < 1e-12);
    }

    #[test]
    fn a_lambda_that_removes_everything_is_an_error_with_the_bound() {
        let moments = random_moments(1, 50, 4, false);
        let error = Lasso::default().fit(&moments, 0, 1e6).unwrap_err().to_string();
        assert!(
            error.starts_with("lambda = 1e6 removes every term: the largest value that keeps one is"),
            "{error}"
        );
    }
}
