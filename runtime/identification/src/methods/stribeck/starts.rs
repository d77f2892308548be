//! Search for the global minimum. Its starts are on a grid over a3 (slope at zero velocity) and a5 (inverse
//! of the Stribeck speed), and are refined on a part of the samples.

use super::super::filtered::{Filtered, FilteredRun};
use super::law::{StribeckRegression, slower, stribeck_torque};
use super::refine::{NEAR, Normal, Observed};
use crate::error::{IdentificationError, Result};
use nalgebra::{SMatrix, SVector};
use std::ops::Range;

/// Number of values of the parameter a3 in the grid. a3 is the steepness of the Stribeck law at rest.
const STEEPNESSES: usize = 8;
/// Number of values of the parameter a5 in the grid. a5 is the inverse of the Stribeck speed.
const DECAYS: usize = 6;

/// Largest number of samples in the search.
const SAMPLES: usize = 4000;

/// Smallest difference of the costs of two distinguishable laws, as a share of the cost.
const LEAST_DIFFERENCE: f64 = 0.01;

/// Largest difference of the costs of two refinements that count as the same minimum, as a share of the cost.
const SAME: f64 = 1e-6;

/// First damping for starts on a coarse grid.
const FAR: f64 = 1e-3;

/// Samples of a regression, reduced to every n-th sample.
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

/// Returns the best law for all samples.
///
/// The grid points with the smallest costs are refined on a part of the samples. If this part does not distinguish several
/// results, these are refined on all samples.
///
/// # Errors
/// [`IdentificationError::NotConverged`] if no grid point has a finite cost.
pub(super) fn search(samples: &Observed, settings: &StribeckRegression) -> Result<Normal> {
    let thinned = Thinned::new(samples);
    let part = thinned.observed();
    let fastest = thinned.v.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
    let coarse = StribeckRegression { max_iterations: 60, tolerance: 1e-7, ..settings.clone() };
    let refine = |start: Normal| -> Normal {
        let found = part.refine(start.a, &coarse, FAR);
        let is_better = found.cost <= start.cost && found.a.iter().all(|a| a.is_finite());
        if is_better { found } else { start }
    };
    let points = hollows(&grid(&part, fastest), settings.starts.max(1));
    let refined = alike(points.into_iter().map(refine).collect());
    let on_all = |start: Normal| samples.refine(start.a, settings, NEAR);
    let found = alike(refined.into_iter().map(on_all).collect());
    let drives = |law: &Normal| !dissipates(&law.a, fastest);
    let best = found.into_iter().min_by(|a, b| drives(a).cmp(&drives(b)).then(a.cost.total_cmp(&b.cost)));
    best.ok_or_else(|| IdentificationError::NotConverged {
        what: "the search for starts".into(),
        iterations: STEEPNESSES * DECAYS,
        detail: format!(
            "the cost is not finite for any start value, with speeds up to {fastest} rad/s. Check the units"
        ),
    })
}

/// Returns the laws whose costs the samples do not distinguish from the smallest cost. Each minimum occurs once.
fn alike(mut laws: Vec<Normal>) -> Vec<Normal> {
    laws.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    laws.dedup_by(|b, a| b.cost <= a.cost * (1.0 + SAME));
    let bound = laws.first().map_or(0.0, |best| best.cost * (1.0 + LEAST_DIFFERENCE));
    laws.retain(|law| law.cost <= bound);
    laws
}

/// Returns whether the law is not negative at all speeds from a ten-thousandth of the fastest speed up to the fastest
/// speed.
fn dissipates(a: &[f64; 5], fastest: f64) -> bool {
    slower(fastest).all(|v| stribeck_torque(v, a) >= 0.0)
}

fn grid(samples: &Observed, fastest: f64) -> Vec<Vec<Option<Normal>>> {
    let share = |i: usize, count: usize| i as f64 / (count - 1) as f64;
    // In units of 1 / (fastest velocity): a3 from 2 to 400, a5 from 1 to 100.
    let row = |i: usize| {
        let a3 = 2.0 * 200f64.powf(share(i, STEEPNESSES)) / fastest;
        let point = |j: usize| linear_part(samples, a3, 100f64.powf(share(j, DECAYS)) / fastest);
        (0..DECAYS).map(point).collect()
    };
    (0..STEEPNESSES).map(row).collect()
}

/// Solves least squares for the linear parameters (a1, a2, a4) of the Stribeck law, at given
/// nonlinear parameters (a3, a5); `None` if the cost is not finite. A slight damping makes few samples
/// sufficient.
fn linear_part(samples: &Observed, a3: f64, a5: f64) -> Option<Normal> {
    const LINEAR: [usize; 3] = [0, 1, 3];
    // If a1, a2 and a4 are zero, the residual is the torque.
    let zero = samples.normal([0.0, 0.0, a3, 0.0, a5]);
    let damping = |i: usize, j: usize| if i == j { 1.0 + 1e-9 } else { 1.0 };
    let h = SMatrix::<f64, 3, 3>::from_fn(|i, j| zero.h[(LINEAR[i], LINEAR[j])] * damping(i, j));
    let g = SVector::<f64, 3>::from_fn(|i, _| zero.g[LINEAR[i]]);
    let x = h.cholesky()?.solve(&g);
    let cost = zero.cost - g.dot(&x);
    cost.is_finite().then_some(Normal { a: [x[0], x[1], a3, x[2], a5], cost, ..zero })
}

/// Returns `count` grid points. The local minima of the cost are first, then the other points follow. Each group is in the
/// order of the costs.
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
    points.into_iter().take(count).map(|(_, start)| *start).collect()
}
