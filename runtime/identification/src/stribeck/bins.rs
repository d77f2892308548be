//! Starts on binned data.

use super::super::error::{IdentificationError, Result};
use super::super::kernel::{BLOCK, stribeck_block};
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{Dyn, Matrix3, OMatrix, OVector, Owned, U5, Vector3, Vector5};

const BINS: usize = 400;

/// Means over bins of velocity, finer towards zero, where the law bends.
pub(super) struct Bins {
    v: Vec<f64>,
    torque: Vec<f64>,
    root_weight: Vec<f64>,
    fastest: f64,
}

impl Bins {
    pub(super) fn new(v: &[f64], torque: &[f64], weights: Option<&[f64]>) -> Self {
        let fastest = v.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        let mut sums = vec![[0.0; 3]; BINS];
        let (half, scale) = (0.5 * BINS as f64, 0.499_999 * BINS as f64 / fastest.sqrt());
        for i in 0..v.len() {
            let w = weights.map_or(1.0, |w| w[i]);
            let position = half + v[i].abs().sqrt().copysign(v[i]) * scale;
            let sum = &mut sums[(position as usize).min(BINS - 1)];
            *sum = [sum[0] + w, sum[1] + w * v[i], sum[2] + w * torque[i]];
        }
        sums.retain(|s| s[0] > 0.0);
        Self {
            v: sums.iter().map(|s| s[1] / s[0]).collect(),
            torque: sums.iter().map(|s| s[2] / s[0]).collect(),
            root_weight: sums.iter().map(|s| s[0].sqrt()).collect(),
            fastest,
        }
    }

    /// Best of a grid over (a3, a5), the best `count` of them refined.
    pub(super) fn best_start(&self, count: usize) -> Result<[f64; 5]> {
        let mut grid = Vec::new();
        for i in 0..8 {
            for j in 0..6 {
                // In units of the fastest velocity: steps 2 to 400 times, decays 1 to 100 times steeper than
                // it.
                let a3 = 2.0 * 200f64.powf(f64::from(i) / 7.0) / self.fastest;
                let a5 = 100f64.powf(f64::from(j) / 5.0) / self.fastest;
                grid.extend(self.linear_part(a3, a5));
            }
        }
        grid.sort_by(|a, b| a.1.total_cmp(&b.1));
        let refined = grid.iter().take(count).map(|(a, cost)| self.refine(*a, *cost));
        refined.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(a, _)| a).ok_or_else(|| {
            IdentificationError::NotConverged {
                what: "the search for starts".into(),
                iterations: 48,
                detail: format!("no finite cost on {} bins up to {} rad/s", self.v.len(), self.fastest),
            }
        })
    }

    /// Least squares of (a1, a2, a4) for given (a3, a5), slightly damped so that few bins are enough.
    fn linear_part(&self, a3: f64, a5: f64) -> Option<([f64; 5], f64)> {
        let (mut h, mut g, mut energy) = (Matrix3::zeros(), Vector3::zeros(), 0.0);
        for ((v, torque), w) in self.v.iter().zip(&self.torque).zip(&self.root_weight) {
            let row = Vector3::new(*v, (a3 * v).tanh(), (-a5 * v.abs()).exp() * (3.0 * a3 * v).tanh()) * *w;
            h += row * row.transpose();
            g += row * (w * torque);
            energy += (w * torque).powi(2);
        }
        for i in 0..3 {
            h[(i, i)] *= 1.0 + 1e-9;
        }
        let x = h.cholesky()?.solve(&g);
        let cost = energy - g.dot(&x);
        cost.is_finite().then_some(([x[0], x[1], a3, x[2], a5], cost))
    }

    fn refine(&self, start: [f64; 5], cost: f64) -> ([f64; 5], f64) {
        let [a1, a2, a3, a4, a5] = start;
        let problem = BinnedProblem { bins: self, p: Vector5::new(a1, a2, a3.ln(), a4, a5.ln()) };
        let (problem, report) = LevenbergMarquardt::new().with_patience(20).minimize(problem);
        let a = problem.parameters();
        let better = report.objective_function.is_finite() && 2.0 * report.objective_function <= cost;
        if better && a.iter().all(|a| a.is_finite()) {
            (a, 2.0 * report.objective_function)
        } else {
            (start, cost)
        }
    }
}

/// Binned residuals over (a1, a2, ln a3, a4, ln a5): the logarithms keep both rates positive.
struct BinnedProblem<'a> {
    bins: &'a Bins,
    p: Vector5<f64>,
}

impl BinnedProblem<'_> {
    fn parameters(&self) -> [f64; 5] {
        [self.p[0], self.p[1], self.p[2].exp(), self.p[3], self.p[4].exp()]
    }

    fn columns(&self) -> Vec<[f64; 6]> {
        let a = self.parameters();
        let mut columns = [[0.0; BLOCK]; 6];
        let mut rows = Vec::with_capacity(self.bins.v.len());
        for (v, torque) in self.bins.v.chunks(BLOCK).zip(self.bins.torque.chunks(BLOCK)) {
            stribeck_block(v, torque, &a, &mut columns);
            rows.extend((0..v.len()).map(|i| columns.map(|c| c[i])));
        }
        rows
    }
}

impl LeastSquaresProblem<f64, Dyn, U5> for BinnedProblem<'_> {
    type ParameterStorage = Owned<f64, U5>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, U5>;

    fn set_params(&mut self, p: &Vector5<f64>) {
        self.p = *p;
    }

    fn params(&self) -> Vector5<f64> {
        self.p
    }

    fn residuals(&self) -> Option<OVector<f64, Dyn>> {
        let rows = self.columns();
        Some(OVector::<f64, Dyn>::from_fn_generic(Dyn(rows.len()), nalgebra::U1, |i, _| {
            -rows[i][5] * self.bins.root_weight[i]
        }))
    }

    fn jacobian(&self) -> Option<OMatrix<f64, Dyn, U5>> {
        let (rows, a) = (self.columns(), self.parameters());
        Some(OMatrix::<f64, Dyn, U5>::from_fn_generic(Dyn(rows.len()), U5, |i, j| {
            let chain = if j == 2 || j == 4 { a[j] } else { 1.0 };
            rows[i][j] * chain * self.bins.root_weight[i]
        }))
    }
}
