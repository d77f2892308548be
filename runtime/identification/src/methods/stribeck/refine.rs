//! Refinement of the parameters of a Stribeck law on all samples, by the Levenberg–Marquardt method.

use super::super::filtered::Filtered;
use super::law::{StribeckRegression, stribeck_block};
use crate::numeric::kernel::{BLOCK, add_products};
use nalgebra::{SMatrix, SVector};
use std::ops::Range;

/// Number of columns: five derivatives and the residual.
const WIDTH: usize = 6;

/// First damping of the Levenberg–Marquardt method if the start is near the result.
pub(super) const NEAR: f64 = 1e-8;

/// The samples of a regression.
#[derive(Clone, Copy)]
pub(crate) struct Observed<'a> {
    /// Velocities ẏ of m samples, in rad/s or m/s.
    pub(crate) v: &'a [f64],
    /// Torques of the samples, in N·m or N.
    pub(crate) torque: &'a [f64],
    /// Weights of the samples; `None` if all weights are 1.
    pub(crate) weights: Option<&'a [f64]>,
    /// Contiguous ranges of samples. Together they cover all samples.
    pub(crate) runs: &'a [Range<usize>],
    /// Filter of the torques, which the law must also pass; `None` if the torques were not filtered.
    pub(crate) filtered: Option<&'a Filtered<'a>>,
}

impl Observed<'_> {
    /// Returns the derivatives ∂τ/∂a of the torque τ with respect to the parameters a, and the residual of
    /// the law, at some samples.
    ///
    /// - `rows`: at most [`BLOCK`] samples
    /// - `passed`: filtered columns of all samples; `None` if there is no filter
    fn block(
        &self,
        rows: Range<usize>,
        a: &[f64; 5],
        passed: Option<&Columns>,
        columns: &mut [[f64; BLOCK]; WIDTH],
    ) {
        match passed {
            Some(passed) => {
                for (column, all) in columns.iter_mut().zip(passed) {
                    column[..rows.len()].copy_from_slice(&all[rows.clone()]);
                }
            }
            None => stribeck_block(&self.v[rows.clone()], &self.torque[rows], a, columns),
        }
    }

    /// Returns the filtered columns of all samples; `None` if there is no filter.
    fn passed(&self, a: &[f64; 5]) -> Option<Columns> {
        let filtered = self.filtered?;
        let mut columns = Columns::default();
        for run in &filtered.runs {
            let whole = evaluated(run.velocities, &vec![0.0; run.velocities.len()], a);
            for (column, values) in columns.iter_mut().zip(&whole[..WIDTH - 1]) {
                column.extend(filtered.pass(run, values));
            }
        }
        // The law is linear in a1, a2 and a4.
        let law = |i: usize| a[0] * columns[0][i] + a[1] * columns[1][i] + a[3] * columns[3][i];
        columns[WIDTH - 1] = self.torque.iter().enumerate().map(|(i, torque)| torque - law(i)).collect();
        Some(columns)
    }

    /// Returns the sum of squares Σ τ² of the torques.
    pub(super) fn energy(&self) -> f64 {
        self.torque.iter().map(|t| t * t).sum()
    }

    /// Returns the columns of all samples, filtered if there is a filter.
    pub(crate) fn columns(&self, a: &[f64; 5]) -> Columns {
        self.passed(a).unwrap_or_else(|| evaluated(self.v, self.torque, a))
    }
}

/// Derivatives ∂τ/∂a of the torque τ with respect to the parameters a, and residual of the law, at all
/// samples.
type Columns = [Vec<f64>; WIDTH];

fn evaluated(v: &[f64], torque: &[f64], a: &[f64; 5]) -> Columns {
    let mut all = Columns::default();
    let mut columns = [[0.0; BLOCK]; WIDTH];
    for (v, torque) in v.chunks(BLOCK).zip(torque.chunks(BLOCK)) {
        stribeck_block(v, torque, a, &mut columns);
        all.iter_mut().zip(&columns).for_each(|(all, column)| all.extend_from_slice(&column[..v.len()]));
    }
    all
}

/// Cost Σ w r², JᵀW J and JᵀW r at one point. Here J are the derivatives of the law, w the weights and r the residuals.
#[derive(Clone, Copy)]
pub(super) struct Normal {
    pub(super) a: [f64; 5],
    pub(super) cost: f64,
    pub(super) h: SMatrix<f64, 5, 5>,
    pub(super) g: SVector<f64, 5>,
    pub(super) iterations: usize,
    pub(super) converged: bool,
}

impl Observed<'_> {
    /// Computes the normal equations in one pass over the samples.
    pub(super) fn normal(&self, a: [f64; 5]) -> Normal {
        let (mut cost, mut h, mut g) = (0.0, SMatrix::zeros(), SVector::zeros());
        let passed = self.passed(&a);
        for run in self.runs {
            let sums = self.products(run, &a, passed.as_ref());
            let product = |i: usize, j: usize| sums[i.max(j) * WIDTH + i.min(j)];
            h += SMatrix::<f64, 5, 5>::from_fn(product);
            g += SVector::<f64, 5>::from_fn(|i, _| product(5, i));
            cost += product(5, 5);
        }
        Normal { a, cost, h, g, iterations: 1, converged: false }
    }

    /// Returns the products of the columns over one run.
    fn products(&self, run: &Range<usize>, a: &[f64; 5], passed: Option<&Columns>) -> [f64; WIDTH * WIDTH] {
        let mut sums = [0.0; WIDTH * WIDTH];
        let mut columns = [[0.0; BLOCK]; WIDTH];
        let mut roots = [1.0; BLOCK];
        for start in run.clone().step_by(BLOCK) {
            let rows = start..run.end.min(start + BLOCK);
            let n = rows.len();
            self.block(rows.clone(), a, passed, &mut columns);
            if let Some(weights) = self.weights {
                roots.iter_mut().zip(&weights[rows]).for_each(|(root, w)| *root = w.sqrt());
                for column in &mut columns {
                    column.iter_mut().zip(&roots).for_each(|(c, root)| *c *= root);
                }
            }
            let [c1, c2, c3, c4, c5, r] = &columns;
            add_products(&[&c1[..n], &c2[..n], &c3[..n], &c4[..n], &c5[..n], &r[..n]], &mut sums);
        }
        sums
    }

    /// Refines the parameters by the Levenberg–Marquardt method on the 5 × 5 normal equations. The damping is relative to
    /// the diagonal.
    ///
    /// - `first_damping`: [`NEAR`] if the start comes from the same data, so that nearly undamped steps succeed immediately
    pub(super) fn refine(
        &self,
        start: [f64; 5],
        settings: &StribeckRegression,
        first_damping: f64,
    ) -> Normal {
        let mut best = self.normal(start);
        // Cost that rounding errors of the residuals leave if the law fits exactly.
        let floor = 1e-28 * self.energy();
        let mut damping = first_damping;
        let mut passes = 1;
        while passes < settings.max_iterations {
            let Some(step) = damped_step(&best, damping) else {
                damping = damping.max(1e-8) * 100.0;
                passes += 1;
                continue;
            };
            let a: [f64; 5] = std::array::from_fn(|i| best.a[i] + step[i]);
            // A predicted decrease below the rounding of the cost ends the refinement.
            let expected = step.dot(&best.g);
            if expected <= settings.tolerance * best.cost + floor {
                return Normal { iterations: passes, converged: true, ..best };
            }
            if damping > 1e12 {
                break;
            }
            let trial = (a[2] > 0.0 && a[4] > 0.0).then(|| self.normal(a));
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
}

fn damped_step(normal: &Normal, damping: f64) -> Option<SVector<f64, 5>> {
    // A parameter without influence has a zero on the diagonal. A one instead of this zero keeps its step at zero.
    let d = normal.h.diagonal().map(|h| if h > 0.0 { h.sqrt() } else { 1.0 });
    let mut scaled = SMatrix::<f64, 5, 5>::from_fn(|i, j| normal.h[(i, j)] / (d[i] * d[j]));
    for i in 0..5 {
        scaled[(i, i)] = scaled[(i, i)].max(1e-12) + damping;
    }
    let z = scaled.cholesky()?.solve(&normal.g.component_div(&d));
    Some(z.component_div(&d))
}
