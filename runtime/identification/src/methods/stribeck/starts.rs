//! Search for the best minimum: starts on a grid over (a3, a5), refined on a part of the samples.

use super::super::filtered::{Filtered, FilteredRun};
use super::law::{StribeckRegression, slower, stribeck_torque};
use super::refine::{Data, NEAR, Normal, Observed};
use crate::error::{IdentificationError, Result};
use nalgebra::{SMatrix, SVector};
use std::ops::Range;

/// Size of the grid over (a3, a5).
const STEEPNESSES: usize = 8;
const DECAYS: usize = 6;

/// Largest number of samples in the search.
const SAMPLES: usize = 4000;

/// Share of the cost by which laws must differ to be distinguishable.
const LEAST_DIFFERENCE: f64 = 0.01;

/// Share of the cost within which two refinements count as the same minimum.
const SAME: f64 = 1e-6;

/// First damping for starts on a coarse grid.
const FAR: f64 = 1e-3;

/// Every n-th sample.
struct Thinned<'a> {
    v: Vec<f64>,
    torque: Vec<f64>,
    runs: Vec<Range<usize>>,
    filtered: Option<Filtered<'a>>,
}

impl<'a> Thinned<'a> {
    fn new(samples: &Observed<'a>) -> Self {
        let stride = samples.v.len().div_ceil(SAMPLES);
        let part = |all: &[f64]| all.iter().step_by(stride).copied().collect();
        let runs = samples.runs.iter().map(|run| run.start.div_ceil(stride)..run.end.div_ceil(stride));
        Self {
            v: part(samples.v),
            torque: part(samples.torque),
            runs: runs.collect(),
            filtered: samples.filtered.map(|filtered| every(filtered, stride)),
        }
    }

    fn observed(&self) -> Observed<'_> {
        Observed {
            v: &self.v,
            torque: &self.torque,
            weights: None,
            runs: &self.runs,
            filtered: self.filtered.as_ref(),
        }
    }
}

fn every<'a>(filtered: &Filtered<'a>, stride: usize) -> Filtered<'a> {
    let mut before = 0;
    let thin = |run: &FilteredRun<'a>| {
        let kept = run.kept.iter().enumerate().filter(|(k, _)| (before + k) % stride == 0);
        let kept = kept.map(|(_, i)| *i).collect();
        before += run.kept.len();
        FilteredRun { velocities: run.velocities, kept }
    };
    Filtered { filter: filtered.filter, runs: filtered.runs.iter().map(thin).collect() }
}

/// The best law on all samples.
///
/// The grid points with the least costs are refined on a part of the samples. Results that this part does not distinguish
/// are refined on all samples.
///
/// # Errors
/// [`IdentificationError::NotConverged`] if no grid point has a finite cost.
pub(super) fn search(data: &Data, settings: &StribeckRegression) -> Result<Normal> {
    let thinned = Thinned::new(&data.samples);
    let part = Data { samples: thinned.observed(), offset: data.offset };
    let fastest = thinned.v.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
    let coarse = StribeckRegression { max_iterations: 60, tolerance: 1e-7, ..settings.clone() };
    let refine = |start: Normal| -> Normal {
        let found = part.refine(start.a, start.offsets.clone(), &coarse, FAR);
        let is_better = found.cost <= start.cost && found.a.iter().all(|a| a.is_finite());
        if is_better { found } else { start }
    };
    let points = hollows(&grid(&part, fastest), settings.starts.max(1));
    let refined = alike(points.into_iter().map(refine).collect());
    let on_all = |start: Normal| data.refine(start.a, start.offsets, settings, NEAR);
    let found = alike(refined.into_iter().map(on_all).collect());
    let drives = |law: &Normal| !dissipates(&law.a, fastest);
    let best = found.into_iter().min_by(|a, b| drives(a).cmp(&drives(b)).then(a.cost.total_cmp(&b.cost)));
    best.ok_or_else(|| IdentificationError::NotConverged {
        what: "the search for starts".into(),
        iterations: STEEPNESSES * DECAYS,
        detail: format!("no finite cost at speeds up to {fastest} rad/s"),
    })
}

/// The laws whose costs the samples do not distinguish from the least cost. Each minimum occurs once.
fn alike(mut laws: Vec<Normal>) -> Vec<Normal> {
    laws.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    laws.dedup_by(|b, a| b.cost <= a.cost * (1.0 + SAME));
    let bound = laws.first().map_or(0.0, |best| best.cost * (1.0 + LEAST_DIFFERENCE));
    laws.retain(|law| law.cost <= bound);
    laws
}

/// Whether the law is positive at speeds from a ten-thousandth of the fastest speed to the fastest speed.
fn dissipates(a: &[f64; 5], fastest: f64) -> bool {
    slower(fastest).all(|v| stribeck_torque(v, a) >= 0.0)
}

fn grid(data: &Data, fastest: f64) -> Vec<Vec<Option<Normal>>> {
    let share = |i: usize, count: usize| i as f64 / (count - 1) as f64;
    // In units of 1 / (fastest velocity): a3 from 2 to 400, a5 from 1 to 100.
    let row = |i: usize| {
        let a3 = 2.0 * 200f64.powf(share(i, STEEPNESSES)) / fastest;
        let point = |j: usize| linear_part(data, a3, 100f64.powf(share(j, DECAYS)) / fastest);
        (0..DECAYS).map(point).collect()
    };
    (0..STEEPNESSES).map(row).collect()
}

/// Least squares of (a1, a2, a4) and the offsets for given (a3, a5), slightly damped so that few samples are enough; `None`
/// if the cost is not finite.
fn linear_part(data: &Data, a3: f64, a5: f64) -> Option<Normal> {
    const LINEAR: [usize; 3] = [0, 1, 3];
    // The residual of this law is the torque.
    let zero = data.normal([0.0, 0.0, a3, 0.0, a5], &vec![0.0; data.samples.runs.len()]);
    let damping = |i: usize, j: usize| if i == j { 1.0 + 1e-9 } else { 1.0 };
    let h = SMatrix::<f64, 3, 3>::from_fn(|i, j| zero.h[(LINEAR[i], LINEAR[j])] * damping(i, j));
    let g = SVector::<f64, 3>::from_fn(|i, _| zero.g[LINEAR[i]]);
    let x = h.cholesky()?.solve(&g);
    let cost = zero.cost - g.dot(&x);
    let offset = |(offset, level): (&f64, &SVector<f64, 5>)| {
        offset - LINEAR.iter().zip(x.iter()).map(|(i, x)| level[*i] * x).sum::<f64>()
    };
    let offsets = zero.offsets.iter().zip(&zero.levels).map(offset).collect();
    cost.is_finite().then_some(Normal { a: [x[0], x[1], a3, x[2], a5], offsets, cost, ..zero })
}

/// `count` grid points: first the local minima of the cost, then the other points, each in the order of their costs.
fn hollows(grid: &[Vec<Option<Normal>>], count: usize) -> Vec<Normal> {
    let at = |i: usize, j: usize| grid.get(i).and_then(|row| row.get(j)).and_then(Option::as_ref);
    let cost = |i: usize, j: usize| at(i, j).map_or(f64::INFINITY, |start| start.cost);
    let mut points: Vec<(bool, &Normal)> = Vec::new();
    for (i, row) in grid.iter().enumerate() {
        for (j, start) in row.iter().enumerate() {
            let Some(start) = start else { continue };
            let neighbours = [(i.wrapping_sub(1), j), (i + 1, j), (i, j.wrapping_sub(1)), (i, j + 1)];
            points.push((neighbours.iter().any(|&(i, j)| cost(i, j) < start.cost), start));
        }
    }
    points.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.cost.total_cmp(&b.1.cost)));
    points.into_iter().take(count).map(|(_, start)| start.clone()).collect()
}
