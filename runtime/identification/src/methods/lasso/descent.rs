//! Solution for one λ by coordinate descent, with a direct solution on the support.

use super::super::least_squares::solve_scaled;
use super::super::moments::Moments;
use super::{Lasso, active_terms};
use crate::error::{IdentificationError, Result, require_setting};
use crate::numeric::spectrum::symmetric_eigen;
use gelenk_findings::digits::plain;
use nalgebra::{DMatrix, DVector};

pub(super) struct Problem {
    pub(super) gram: DMatrix<f64>,
    pub(super) b: DVector<f64>,
    energy: f64,
    pub(super) samples: f64,
    pub(super) weights: Vec<f64>,
}

/// Coefficients w, and correlations c = b − G w of the terms with the residual. G is the Gram matrix of the
/// terms, and b are their products with the target.
pub(super) struct State {
    pub(super) w: DVector<f64>,
    c: DVector<f64>,
}

impl State {
    pub(super) fn new(problem: &Problem) -> Self {
        Self { w: DVector::zeros(problem.b.len()), c: problem.b.clone() }
    }
}

impl Problem {
    pub(super) fn new(settings: &Lasso, moments: &Moments, target: usize) -> Result<Self> {
        moments.require_target(target)?;
        require_setting("tolerance", settings.tolerance, settings.tolerance > 0.0, "it must be positive")?;
        moments.require_no_zero_column()?;
        let (p, samples) = (moments.terms(), moments.samples() as f64);
        let energy = moments.energy(target);
        if energy == 0.0 {
            return Err(IdentificationError::ZeroColumn {
                term: format!("target {target}"),
                samples: moments.samples(),
            });
        }
        let gram = moments.gram();
        let weight = |i: usize| if settings.standardize { (gram[(i, i)] / samples).sqrt() } else { 1.0 };
        Ok(Self {
            weights: (0..p).map(weight).collect(),
            b: moments.projection(target),
            gram,
            energy,
            samples,
        })
    }

    pub(super) fn solve(&self, lambda: f64, state: &mut State, settings: &Lasso) -> Result<f64> {
        let bound = settings.tolerance * self.energy / (2.0 * self.samples);
        let mut gap = f64::INFINITY;
        for sweep in 1..=settings.max_sweeps {
            self.sweep(lambda, state);
            // For most λ, the direct solution ends the iteration after the first sweeps. Later direct solutions are needed
            // only in hard cases.
            if sweep <= 3 || sweep % 10 == 0 {
                self.solve_on_support(lambda, state);
                gap = self.gap(lambda, state);
                if gap <= bound {
                    return Ok(gap);
                }
            }
        }
        Err(IdentificationError::NotConverged {
            what: format!("the LASSO at λ = {}", plain(lambda, 6)),
            iterations: settings.max_sweeps,
            detail: format!(
                "the duality gap is {} instead of at most {}. The terms may be collinear",
                plain(gap, 3),
                plain(bound, 3)
            ),
        })
    }

    /// Performs one sweep of coordinate descent with soft thresholding.
    fn sweep(&self, lambda: f64, state: &mut State) {
        for j in 0..state.w.len() {
            let diagonal = self.gram[(j, j)];
            let q = state.c[j] + diagonal * state.w[j];
            let threshold = self.samples * lambda * self.weights[j];
            let shrunk = if q > threshold {
                q - threshold
            } else if q < -threshold {
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

    /// Solves the optimality conditions for the current signs (feature-sign search; Lee et al. 2006).
    ///
    /// If a coefficient would change its sign, the step ends at the zero of this coefficient, which then leaves the
    /// support.
    fn solve_on_support(&self, lambda: f64, state: &mut State) {
        for _ in 0..state.w.len() {
            let active = active_terms(&state.w);
            let right = DVector::from_fn(self.b.len(), |j, _| {
                self.b[j] - self.samples * lambda * self.weights[j] * state.w[j].signum()
            });
            let collinear = self.along_null_direction(&active, &state.w);
            let solution = collinear.or_else(|| solve_scaled(&self.gram, &right, &active, 0.0));
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

    /// Returns a distant point in a direction that does not change the fitted values and makes the penalty smaller. On the way
    /// to this point a coefficient reaches zero. `None` if the active terms are not collinear.
    fn along_null_direction(&self, active: &[usize], w: &DVector<f64>) -> Option<DVector<f64>> {
        let n = active.len();
        let norm = |i: usize| self.gram[(active[i], active[i])].sqrt();
        let scaled = DMatrix::from_fn(n, n, |i, j| self.gram[(active[i], active[j])] / (norm(i) * norm(j)));
        // The smallest pivot of the Cholesky factorization is an upper bound of the smallest eigenvalue and much cheaper to
        // compute.
        let factor = scaled.clone().cholesky();
        if n == 0 || factor.is_some_and(|factor| factor.l_dirty().diagonal().amin() > 1e-5) {
            return None;
        }
        let eigen = symmetric_eigen(scaled);
        let least = eigen.eigenvalues.imin();
        let direction = DVector::from_fn(n, |i, _| eigen.eigenvectors[(i, least)] / norm(i));
        let slope: f64 = (0..n).map(|i| self.weights[active[i]] * w[active[i]].signum() * direction[i]).sum();
        let direction = direction * if slope > 0.0 { -1.0 } else { 1.0 };
        let falls = (0..n).map(|i| -w[active[i]] / direction[i]).filter(|length| *length > 0.0);
        let length = 2.0 * falls.fold(f64::INFINITY, f64::min);
        let is_null = eigen.eigenvalues[least] <= 1e-12 && length.is_finite();
        is_null.then(|| DVector::from_fn(n, |i, _| w[active[i]] + length * direction[i]))
    }

    /// Returns the share of the step to `solution` that keeps all signs, and the coefficient that limits the step.
    fn largest_step(
        &self,
        active: &[usize],
        solution: &DVector<f64>,
        w: &DVector<f64>,
    ) -> (f64, Option<usize>) {
        let mut step = (1.0, None);
        for (&j, x) in active.iter().zip(solution.iter()) {
            if x * w[j] <= 0.0 {
                let share = w[j] / (w[j] - x);
                if share < step.0 || step.1.is_none() {
                    step = (share.min(step.0), Some(j));
                }
            }
        }
        step
    }

    /// Returns the primal minus the dual objective. The dual point is `s (y − Θ w)/N` with the largest
    /// feasible s, the target y, the terms Θ, the coefficients w and N samples.
    fn gap(&self, lambda: f64, state: &State) -> f64 {
        let fitted = self.b.dot(&state.w);
        let residual_target = self.energy - fitted;
        let residual = (residual_target - state.c.dot(&state.w)).max(0.0);
        let mut scale = 1.0_f64;
        for j in 0..state.w.len() {
            let (c, limit) = (state.c[j].abs(), self.samples * lambda * self.weights[j]);
            if c > limit {
                scale = scale.min(limit / c);
            }
        }
        let penalty: f64 = state.w.iter().zip(&self.weights).map(|(w, o)| o * w.abs()).sum();
        let primal = residual / (2.0 * self.samples) + lambda * penalty;
        let dual = (2.0 * scale * residual_target - scale * scale * residual) / (2.0 * self.samples);
        (primal - dual).max(0.0)
    }
}
