//! Refinement on all samples, and what the data say about the result.

use super::super::kernel::{BLOCK, add_products, stribeck_block};
use super::{NAMES, StribeckFit, StribeckRegression, stribeck_torque};
use nalgebra::{SMatrix, SVector};

pub(super) struct Data<'a> {
    pub(super) v: &'a [f64],
    pub(super) torque: &'a [f64],
}

/// Cost Σ w r², JᵀW J and JᵀW r at one point.
#[derive(Clone, Copy)]
pub(super) struct Normal {
    a: [f64; 5],
    cost: f64,
    h: SMatrix<f64, 5, 5>,
    g: SVector<f64, 5>,
    iterations: usize,
    converged: bool,
}

impl Data<'_> {
    /// One pass over the samples.
    fn normal(&self, a: [f64; 5], weights: Option<&[f64]>) -> Normal {
        let mut sums = [0.0; 36];
        let mut columns = [[0.0; BLOCK]; 6];
        for start in (0..self.v.len()).step_by(BLOCK) {
            let rows = start..self.v.len().min(start + BLOCK);
            stribeck_block(&self.v[rows.clone()], &self.torque[rows.clone()], &a, &mut columns);
            if let Some(weights) = weights {
                for column in &mut columns {
                    for (c, w) in column.iter_mut().zip(&weights[rows.clone()]) {
                        *c *= w.sqrt();
                    }
                }
            }
            let n = rows.len();
            let [c1, c2, c3, c4, c5, r] = &columns;
            add_products(&[&c1[..n], &c2[..n], &c3[..n], &c4[..n], &c5[..n], &r[..n]], &mut sums);
        }
        Normal {
            a,
            cost: sums[35],
            h: SMatrix::from_fn(|i, j| sums[i.max(j) * 6 + i.min(j)]),
            g: SVector::from_fn(|i, _| sums[30 + i]),
            iterations: 1,
            converged: false,
        }
    }

    /// Levenberg–Marquardt on the 5 × 5 normal equations, damping in units of the diagonal.
    pub(super) fn refine(
        &self,
        start: [f64; 5],
        weights: Option<&[f64]>,
        settings: &StribeckRegression,
    ) -> Normal {
        let mut best = self.normal(start, weights);
        // What rounding in the residuals leaves of the cost where the law fits exactly.
        let floor = 1e-28 * self.torque.iter().map(|t| t * t).sum::<f64>();
        // The start comes from the same data, binned: nearly undamped steps succeed at once.
        let mut damping = 1e-8;
        let mut passes = 1;
        while passes < settings.max_iterations {
            let Some(step) = damped_step(&best, damping) else {
                damping = damping.max(1e-8) * 100.0;
                passes += 1;
                continue;
            };
            let a: [f64; 5] = std::array::from_fn(|i| best.a[i] + step[i]);
            // Predicted decrease below the rounding of the cost: nothing is left to gain.
            let expected = step.dot(&best.g);
            if expected <= settings.tolerance * best.cost + floor {
                return Normal { iterations: passes, converged: true, ..best };
            }
            if damping > 1e12 {
                break;
            }
            let trial = if a[2] > 0.0 && a[4] > 0.0 { Some(self.normal(a, weights)) } else { None };
            passes += 1;
            match trial {
                Some(trial) if trial.cost <= best.cost => {
                    damping = (damping / 10.0).max(1e-12);
                    best = trial;
                }
                _ => damping *= 10.0,
            }
        }
        Normal { iterations: passes, ..best }
    }

    fn residual(&self, i: usize, a: &[f64; 5]) -> f64 {
        self.torque[i] - stribeck_torque(self.v[i], a)
    }

    /// Iteratively reweighted least squares with the scale from the median absolute residual.
    pub(super) fn reweighted(
        &self,
        mut state: Normal,
        given: Option<&[f64]>,
        k: f64,
        settings: &StribeckRegression,
    ) -> Normal {
        let m = self.v.len();
        for _ in 0..50 {
            let residuals: Vec<f64> = (0..m).map(|i| self.residual(i, &state.a).abs()).collect();
            let mut sorted = residuals.clone();
            let scale = 1.4826 * *sorted.select_nth_unstable_by(m / 2, f64::total_cmp).1;
            if scale == 0.0 {
                return state;
            }
            let weight = |i: usize| given.map_or(1.0, |w| w[i]) * (k * scale / residuals[i].max(k * scale));
            let weights: Vec<f64> = (0..m).map(weight).collect();
            let before = state;
            state = self.refine(before.a, Some(&weights), settings);
            state.iterations += before.iterations;
            let moved = (0..5).map(|i| (state.a[i] - before.a[i]).abs() / (before.a[i].abs() + 1e-12));
            if moved.fold(0.0, f64::max) < 1e-7 {
                break;
            }
        }
        state
    }
}

fn damped_step(normal: &Normal, damping: f64) -> Option<SVector<f64, 5>> {
    // A parameter without influence has a zero diagonal; a one keeps its step at zero.
    let d = normal.h.diagonal().map(|h| if h > 0.0 { h.sqrt() } else { 1.0 });
    let mut scaled = SMatrix::<f64, 5, 5>::from_fn(|i, j| normal.h[(i, j)] / (d[i] * d[j]));
    for i in 0..5 {
        scaled[(i, i)] = scaled[(i, i)].max(1e-12) + damping;
    }
    let z = scaled.cholesky()?.solve(&normal.g.component_div(&d));
    Some(z.component_div(&d))
}

pub(super) fn summarize(data: &Data, state: Normal) -> StribeckFit {
    let freedom = data.v.len() - 5;
    let variance = state.cost / freedom as f64;
    let d = state.h.diagonal().map(|h| if h > 0.0 { h.sqrt() } else { 1.0 });
    let scaled = SMatrix::<f64, 5, 5>::from_fn(|i, j| state.h[(i, j)] / (d[i] * d[j]));
    let eigen = scaled.symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    let mut inverse = SMatrix::<f64, 5, 5>::zeros();
    let mut lost = [false; 5];
    for k in 0..5 {
        let direction = eigen.eigenvectors.column(k);
        if eigen.eigenvalues[k] > 1e-10 * largest {
            inverse += direction * direction.transpose() / eigen.eigenvalues[k];
        } else {
            (0..5).filter(|&i| direction[i].abs() > 0.1).for_each(|i| lost[i] = true);
        }
    }
    let covariance =
        SMatrix::from_fn(
            |i, j| {
                if lost[i] || lost[j] { 0.0 } else { variance * inverse[(i, j)] / (d[i] * d[j]) }
            },
        );
    let standard_errors = std::array::from_fn(|i| (!lost[i]).then(|| covariance[(i, i)].max(0.0).sqrt()));
    let least = eigen.eigenvalues.min().max(0.0);
    let mut fit = StribeckFit {
        parameters: state.a,
        covariance,
        standard_errors,
        variance,
        freedom,
        condition: if least > 0.0 { (largest / least).sqrt() } else { f64::INFINITY },
        iterations: state.iterations,
        converged: state.converged,
        warnings: Vec::new(),
    };
    fit.warnings = warnings(&fit, data);
    fit
}

fn warnings(fit: &StribeckFit, data: &Data) -> Vec<String> {
    let mut warnings = Vec::new();
    let a = &fit.parameters;
    if !fit.converged {
        warnings.push(format!("no convergence in {} passes: some parameters run away", fit.iterations));
    }
    for i in 0..5 {
        match fit.standard_errors[i] {
            None => warnings.push(format!("{} is not identifiable: the data do not depend on it", NAMES[i])),
            Some(s) if s > 0.5 * a[i].abs() => {
                warnings.push(format!("{} = {:.4} has a standard error of {s:.4}", NAMES[i], a[i]));
            }
            Some(_) => {}
        }
        for j in 0..i {
            let c = fit.covariance[(i, j)] / (fit.covariance[(i, i)] * fit.covariance[(j, j)]).sqrt();
            if c.abs() > 0.995 {
                warnings.push(format!(
                    "{} and {} are correlated with {c:.4}: only a combination is known",
                    NAMES[j], NAMES[i]
                ));
            }
        }
    }
    let slow = data.v.iter().filter(|v| v.abs() < 1.0 / a[2]).count();
    if slow < 10 {
        warnings.push(format!(
            "only {slow} samples are slower than 1/a3 = {:.4}: the step at zero is a guess",
            1.0 / a[2]
        ));
    }
    warnings
}
