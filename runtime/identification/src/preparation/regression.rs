//! Efforts explained by a robot's regressor, with friction and an offset for each joint: the judge of delays and
//! bandwidths.

use super::super::robot::Robot;
use super::super::run::{Effort, PreparedRun};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Ridge on columns of unit length: parameters that the motion does not show stay at zero.
const RIDGE: f64 = 1e-7;

/// Share of a joint's largest speed within which the sign of its velocity is rounded.
const ROUNDING: f64 = 0.02;

/// Where the columns come from.
pub(super) struct Columns<'a> {
    robot: &'a dyn Robot,
    /// `B⁺`, `M × N`, where efforts are inputs; `None` where they are joint forces.
    inverse: Option<DMatrix<f64>>,
    /// Speeds below which the sign is rounded, for each joint.
    slow: Vec<f64>,
}

impl<'a> Columns<'a> {
    /// Columns for the efforts of `runs`.
    pub fn new(robot: &'a dyn Robot, runs: &[&PreparedRun]) -> Self {
        let joints = robot.joint_names().len();
        let inputs = runs.first().is_some_and(|r| r.effort != Effort::Joint);
        let inverse = || {
            let inputs = robot.input_names().len();
            DMatrix::from_row_slice(joints, inputs, &robot.input_matrix()).pseudo_inverse(1e-9).ok()
        };
        let fastest = |j: usize| {
            let speeds = runs.iter().flat_map(|r| r.velocities[j].iter());
            speeds.fold(0.0_f64, |most, v| most.max(v.abs()))
        };
        let slow = (0..joints).map(|j| (ROUNDING * fastest(j)).max(1e-12)).collect();
        Self { robot, inverse: if inputs { inverse() } else { None }, slow }
    }

    /// Columns at sample `i`, one row for each effort.
    fn at(&self, run: &PreparedRun, i: usize) -> DMatrix<f64> {
        let state = |all: &[Vec<f64>]| -> Vec<f64> { all.iter().map(|c| c[i]).collect() };
        let (y, v, a) = (state(&run.positions), state(&run.velocities), state(&run.accelerations));
        let (joints, parameters) = (y.len(), self.robot.parameters().len());
        let mut regressor = vec![0.0; joints * parameters];
        self.robot.inertial_regressor(&y, &v, &a, &mut regressor);
        let mut all = DMatrix::zeros(joints, parameters + 3 * joints);
        for j in 0..joints {
            for k in 0..parameters {
                all[(j, k)] = regressor[j * parameters + k];
            }
            let friction = parameters + 3 * j;
            all[(j, friction)] = v[j];
            all[(j, friction + 1)] = (v[j] / self.slow[j]).tanh();
            all[(j, friction + 2)] = 1.0;
        }
        match &self.inverse {
            Some(inverse) => inverse * all,
            None => all,
        }
    }
}

/// Columns of one effort over the chosen samples.
pub(super) struct Problem {
    /// Rows × columns, zero columns left out, scaled to unit length.
    pub columns: DMatrix<f64>,
    factor: Cholesky<f64, Dyn>,
}

/// A sample: number of the run and of the sample in it.
pub(super) type Sample = (usize, usize);

/// About `count` samples spread evenly over those of all runs at least `margin` samples away from the ends.
pub(super) fn spread(runs: &[&PreparedRun], count: usize, margin: usize) -> Vec<Sample> {
    let inner = |r: &PreparedRun| margin..r.times.len().saturating_sub(margin).max(margin);
    let all: Vec<Sample> = runs.iter().enumerate().flat_map(|(k, r)| inner(r).map(move |i| (k, i))).collect();
    let stride = all.len().div_ceil(count.max(1)).max(1);
    all.into_iter().step_by(stride).collect()
}

/// One problem for each effort; `None` where its columns are all zero.
pub(super) fn problems(columns: &Columns, runs: &[&PreparedRun], samples: &[Sample]) -> Vec<Option<Problem>> {
    let blocks: Vec<DMatrix<f64>> = samples.iter().map(|(r, i)| columns.at(runs[*r], *i)).collect();
    let Some(first) = blocks.first() else { return Vec::new() };
    let of_effort = |m: usize| DMatrix::from_fn(blocks.len(), first.ncols(), |i, k| blocks[i][(m, k)]);
    (0..first.nrows()).map(|m| Problem::new(&of_effort(m))).collect()
}

impl Problem {
    fn new(columns: &DMatrix<f64>) -> Option<Self> {
        let norms: Vec<f64> = columns.column_iter().map(|c| c.norm()).collect();
        let largest = norms.iter().copied().fold(0.0, f64::max);
        let used: Vec<usize> = (0..norms.len()).filter(|k| norms[*k] > 1e-9 * largest).collect();
        let scaled =
            DMatrix::from_fn(columns.nrows(), used.len(), |i, k| columns[(i, used[k])] / norms[used[k]]);
        let mut gram = scaled.tr_mul(&scaled);
        for k in 0..used.len() {
            gram[(k, k)] += RIDGE;
        }
        Some(Self { factor: gram.cholesky()?, columns: scaled })
    }

    /// What the columns cannot explain of `target`.
    pub fn residual(&self, target: &DVector<f64>) -> DVector<f64> {
        target - &self.columns * self.factor.solve(&self.columns.tr_mul(target))
    }

    /// The samples `kept` alone.
    pub fn part(&self, kept: &[usize]) -> Option<Self> {
        let columns = self.columns.select_rows(kept);
        let mut gram = columns.tr_mul(&columns);
        for k in 0..columns.ncols() {
            gram[(k, k)] += RIDGE;
        }
        Some(Self { factor: gram.cholesky()?, columns })
    }

    /// Coefficients of the scaled columns.
    pub fn fit(&self, target: &DVector<f64>) -> DVector<f64> {
        self.factor.solve(&self.columns.tr_mul(target))
    }
}
