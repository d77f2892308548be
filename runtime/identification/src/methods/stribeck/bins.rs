//! Starts on binned data.

use super::law::{StribeckRegression, stribeck_block, stribeck_torque};
use super::refine::{Data, Normal};
use crate::error::{IdentificationError, Result};
use crate::numeric::kernel::{BLOCK, add_products};
use nalgebra::{SMatrix, SVector};

const BINS: usize = 400;
/// Grid of starts over (a3, a5).
const STEEPNESSES: usize = 8;
const DECAYS: usize = 6;

/// Share of the cost by which laws must differ to be told apart.
const LEAST_DIFFERENCE: f64 = 0.01;

/// First damping for starts on a coarse grid.
const FAR: f64 = 1e-3;

/// Means over bins of velocity, finer towards zero, where the law bends.
pub(super) struct Bins {
    v: Vec<f64>,
    torque: Vec<f64>,
    weight: Vec<f64>,
    /// Σ w (τ − mean of the bin)²: what no law of the speed explains.
    within: f64,
    samples: usize,
    fastest: f64,
    offset: bool,
    /// What was taken off each run before its samples were put into bins.
    before: Vec<f64>,
}

/// A point of the grid with its cost.
#[derive(Clone, Copy)]
struct Start {
    a: [f64; 5],
    offset: f64,
    cost: f64,
}

impl Bins {
    pub(super) fn new(data: &Data, weights: Option<&[f64]>) -> Self {
        let fastest = data.v.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        let before = preliminary_offsets(data, weights, fastest);
        let mut sums = vec![[0.0; 3]; BINS];
        let mut energy = 0.0;
        let (half, scale) = (0.5 * BINS as f64, 0.499_999 * BINS as f64 / fastest.sqrt());
        for (run, offset) in data.runs.iter().zip(&before) {
            for i in run.clone() {
                let w = weights.map_or(1.0, |w| w[i]);
                let position = half + data.v[i].abs().sqrt().copysign(data.v[i]) * scale;
                let (sum, torque) = (&mut sums[(position as usize).min(BINS - 1)], data.torque[i] - offset);
                *sum = [sum[0] + w, sum[1] + w * data.v[i], sum[2] + w * torque];
                energy += w * torque * torque;
            }
        }
        sums.retain(|s| s[0] > 0.0);
        Self {
            v: sums.iter().map(|s| s[1] / s[0]).collect(),
            torque: sums.iter().map(|s| s[2] / s[0]).collect(),
            weight: sums.iter().map(|s| s[0]).collect(),
            within: (energy - sums.iter().map(|s| s[2] * s[2] / s[0]).sum::<f64>()).max(0.0),
            samples: data.v.len(),
            fastest,
            offset: data.offset,
            before,
        }
    }

    /// Offsets of the runs, where the bins have one in common.
    pub(super) fn offsets(&self, common: f64) -> Vec<f64> {
        self.before.iter().map(|before| before + common).collect()
    }

    /// The best law on the bins with its offset: of a grid over (a3, a5), `count` hollows are refined.
    ///
    /// Where the data cannot tell which law is the better one, as without slow samples, one that dissipates at all
    /// speeds is taken before one that drives the joint at some.
    pub(super) fn best_start(&self, count: usize) -> Result<([f64; 5], f64)> {
        let refined: Vec<Start> =
            hollows(&self.grid(), count).into_iter().map(|start| self.refine(start)).collect();
        let least = refined.iter().fold(f64::INFINITY, |least, start| least.min(start.cost));
        let margin = LEAST_DIFFERENCE.max(10.0 / self.samples as f64);
        let bound = least + margin * (least + self.within);
        let drives = |start: &Start| start.cost > bound || !self.dissipates(&start.a);
        let best = refined.iter().min_by(|a, b| drives(a).cmp(&drives(b)).then(a.cost.total_cmp(&b.cost)));
        best.map(|start| (start.a, start.offset)).ok_or_else(|| IdentificationError::NotConverged {
            what: "the search for starts".into(),
            iterations: STEEPNESSES * DECAYS,
            detail: format!("no finite cost on {} bins up to {} rad/s", self.v.len(), self.fastest),
        })
    }

    /// Whether the law is positive at speeds from a ten-thousandth of the fastest to all of it.
    fn dissipates(&self, a: &[f64; 5]) -> bool {
        (0..=80).all(|i| stribeck_torque(self.fastest * 10_f64.powf(-0.05 * f64::from(i)), a) >= 0.0)
    }

    fn grid(&self) -> Vec<Vec<Option<Start>>> {
        let share = |i: usize, count: usize| i as f64 / (count - 1) as f64;
        // In units of the fastest velocity: steps 2 to 400 times, decays 1 to 100 times steeper than it.
        let row = |i: usize| {
            let a3 = 2.0 * 200f64.powf(share(i, STEEPNESSES)) / self.fastest;
            let point = |j: usize| self.linear_part(a3, 100f64.powf(share(j, DECAYS)) / self.fastest);
            (0..DECAYS).map(point).collect()
        };
        (0..STEEPNESSES).map(row).collect()
    }

    /// Least squares of (a1, a2, a4) and the offset for given (a3, a5), slightly damped so that few bins are
    /// enough.
    fn linear_part(&self, a3: f64, a5: f64) -> Option<Start> {
        let sums = self.products(&[0.0, 0.0, a3, 0.0, a5]);
        // Columns: v, tanh, decay, offset, torque.
        let mut h = SMatrix::<f64, 4, 4>::from_fn(|i, j| sums[i.max(j) * 5 + i.min(j)]);
        let mut g = SVector::<f64, 4>::from_fn(|i, _| sums[20 + i]);
        if !self.offset {
            h.fill_row(3, 0.0);
            h.fill_column(3, 0.0);
            (h[(3, 3)], g[3]) = (1.0, 0.0);
        }
        for i in 0..4 {
            h[(i, i)] *= 1.0 + 1e-9;
        }
        let x = h.cholesky()?.solve(&g);
        let cost = sums[24] - g.dot(&x);
        cost.is_finite().then_some(Start { a: [x[0], x[1], a3, x[2], a5], offset: x[3], cost })
    }

    fn products(&self, a: &[f64; 5]) -> [f64; 25] {
        let mut sums = [0.0; 25];
        let mut columns = [[0.0; BLOCK]; 6];
        let mut ones = [0.0; BLOCK];
        for start in (0..self.v.len()).step_by(BLOCK) {
            let rows = start..self.v.len().min(start + BLOCK);
            let n = rows.len();
            stribeck_block(&self.v[rows.clone()], &self.torque[rows.clone()], a, &mut columns);
            // With a1 = a2 = a4 = 0 the residual is the torque.
            ones.fill(1.0);
            let [c1, c2, _, c4, _, torque] = &mut columns;
            for column in [c1, c2, c4, torque, &mut ones] {
                column.iter_mut().zip(&self.weight[rows.clone()]).for_each(|(c, w)| *c *= w.sqrt());
            }
            let [c1, c2, _, c4, _, torque] = &columns;
            add_products(&[&c1[..n], &c2[..n], &c4[..n], &ones[..n], &torque[..n]], &mut sums);
        }
        sums
    }

    fn refine(&self, start: Start) -> Start {
        let whole = 0..self.v.len();
        let data = Data { v: &self.v, torque: &self.torque, runs: &[whole], offset: self.offset };
        let settings =
            StribeckRegression { starts: 1, offset: self.offset, max_iterations: 60, tolerance: 1e-9 };
        let found: Normal = data.refine(start.a, vec![start.offset], Some(&self.weight), &settings, FAR);
        let better = found.cost.is_finite() && found.cost <= start.cost;
        if better && found.a.iter().all(|a| a.is_finite()) {
            Start { a: found.a, offset: found.offsets[0], cost: found.cost }
        } else {
            start
        }
    }
}

/// The points of the grid that no neighbour undercuts, then the others, `count` in all, best first of each.
fn hollows(grid: &[Vec<Option<Start>>], count: usize) -> Vec<Start> {
    let cost = |i: usize, j: usize| {
        let start = grid.get(i).and_then(|row| row.get(j)).copied().flatten();
        start.map_or(f64::INFINITY, |start| start.cost)
    };
    let mut points: Vec<(bool, Start)> = Vec::new();
    for (i, row) in grid.iter().enumerate() {
        for (j, start) in row.iter().enumerate() {
            let Some(start) = start else { continue };
            let neighbours = [(i.wrapping_sub(1), j), (i + 1, j), (i, j.wrapping_sub(1)), (i, j + 1)];
            let undercut = neighbours.iter().any(|&(i, j)| cost(i, j) < start.cost);
            points.push((undercut, *start));
        }
    }
    points.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.cost.total_cmp(&b.1.cost)));
    points.into_iter().take(count).map(|(_, start)| start).collect()
}

/// Offsets of several runs from least squares on a smooth law, so that their samples fit into the same bins.
fn preliminary_offsets(data: &Data, weights: Option<&[f64]>, fastest: f64) -> Vec<f64> {
    let none = vec![0.0; data.runs.len()];
    if !data.offset || data.runs.len() < 2 {
        return none;
    }
    let basis = |v: f64| SVector::<f64, 3>::new(v, (5.0 * v / fastest).tanh(), (50.0 * v / fastest).tanh());
    let weight = |i: usize| weights.map_or(1.0, |w| w[i]);
    let mut means = Vec::with_capacity(data.runs.len());
    let (mut h, mut g) = (SMatrix::<f64, 3, 3>::zeros(), SVector::<f64, 3>::zeros());
    for run in data.runs {
        let total: f64 = run.clone().map(weight).sum::<f64>().max(f64::MIN_POSITIVE);
        let level = run.clone().map(|i| basis(data.v[i]) * weight(i)).sum::<SVector<f64, 3>>() / total;
        let torque = run.clone().map(|i| data.torque[i] * weight(i)).sum::<f64>() / total;
        for i in run.clone() {
            let row = basis(data.v[i]) - level;
            h += row * row.transpose() * weight(i);
            g += row * (weight(i) * (data.torque[i] - torque));
        }
        means.push((level, torque));
    }
    for i in 0..3 {
        h[(i, i)] *= 1.0 + 1e-9;
    }
    let Some(factor) = h.cholesky() else { return none };
    let x = factor.solve(&g);
    means.iter().map(|(level, torque)| torque - level.dot(&x)).collect()
}
