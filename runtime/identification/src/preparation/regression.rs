//! Regression of the efforts on a robot's regressor, with friction and an offset for each joint. Its residuals are used to
//! compare delays and bandwidths. Each effort has separate parameters here.

use super::super::methods::filter::{Band, Filter};
use super::super::methods::moments::contiguous_blocks;
use super::super::numeric::spectrum::svd;
use super::super::numeric::statistics::largest;
use super::super::pose::rows_of;
use super::super::robot::Robot;
use super::super::run::{Effort, PreparedRun};
use nalgebra::{DMatrix, DVector};
use std::ops::Range;
use std::rc::Rc;

/// Ridge parameter of the normal equations for columns of unit length. Parameters that the motion does not determine stay
/// zero.
const RIDGE: f64 = 1e-7;

/// Source of the columns of the regression.
pub(super) struct Columns<'a> {
    robot: &'a dyn Robot,
    /// Pseudoinverse `B⁺` of the input matrix if efforts are inputs, one row for each input; `None` if efforts are joint
    /// forces.
    inverse: Option<DMatrix<f64>>,
    /// Smooth signs (`tanh`) of the velocities, by run, joint and width.
    signs: Rc<Vec<Vec<Vec<Vec<f64>>>>>,
    /// Filter of the signs, which is the filter of the efforts.
    filter: Option<Filter>,
    /// Additional low-pass filter of the motion.
    band: Option<Filter>,
    /// Number of inertial parameters.
    parameters: usize,
    /// Whether a row belongs to a joint with a quaternion. These rows have neither friction nor an offset here.
    exact: Vec<bool>,
    /// Whether the robot compensates gravity. The weight in the model of its controller is unknown, so inertial forces and
    /// weight have separate parameters.
    is_compensated: bool,
}

impl<'a> Columns<'a> {
    /// Creates the columns for the efforts of `runs`.
    ///
    /// - `filter`: filter of the efforts, if it smoothed the steps of Coulomb friction. The signs of the velocities then
    ///   pass this filter, too.
    /// - `is_compensated`: whether the robot compensates gravity
    /// - `roundings`: widths of the smooth sign of a joint's velocity, as shares of the joint's largest speed. Each width
    ///   gives one column.
    pub(crate) fn new(
        robot: &'a dyn Robot,
        runs: &[&PreparedRun],
        filter: Option<Filter>,
        is_compensated: bool,
        roundings: &[f64],
    ) -> Self {
        let joints = robot.joint_names().len();
        let inputs = runs.first().is_some_and(|r| r.effort != Effort::Joint);
        let inverse = || {
            let inputs = robot.input_names().len();
            svd(DMatrix::from_row_slice(joints, inputs, &robot.input_matrix())).pseudo_inverse(1e-9).ok()
        };
        let fastest: Vec<f64> =
            (0..joints).map(|j| largest(runs.iter().flat_map(|r| &r.velocities[j])).max(1e-12)).collect();
        let sign = |(v, fastest): (&Vec<f64>, &f64)| {
            let rounded = |share: &f64| v.iter().map(|v| (v / (share * fastest)).tanh()).collect();
            roundings.iter().map(rounded).collect()
        };
        let signs = runs.iter().map(|r| r.velocities.iter().zip(&fastest).map(sign).collect()).collect();
        let exact = rows_of(&robot.quaternion_joints(), joints);
        Self {
            robot,
            inverse: if inputs { inverse() } else { None },
            signs: Rc::new(signs),
            parameters: robot.parameter_names().len(),
            exact,
            is_compensated,
            filter,
            band: None,
        }
    }

    /// Returns the same columns with an additional low-pass filter of the efforts.
    pub(crate) fn behind(&self, band: Band) -> Self {
        let filter = self.filter.clone().map(|filter| filter.behind(Some(band)));
        let band = self.filter.as_ref().map(|filter| filter.alone(band));
        Self {
            signs: Rc::clone(&self.signs),
            exact: self.exact.clone(),
            inverse: self.inverse.clone(),
            filter,
            band,
            ..*self
        }
    }

    /// Returns whether a joint on which an effort acts rests at a sample.
    fn rests(&self, run: &PreparedRun, effort: usize, sample: usize) -> bool {
        match &self.inverse {
            Some(inverse) => {
                let mut joints =
                    inverse.row(effort).into_iter().enumerate().filter(|(_, share)| **share != 0.0);
                joints.any(|(joint, _)| run.rests(joint, sample))
            }
            None => run.rests(effort, sample),
        }
    }

    /// Returns the columns at sample `i` of run `r`, one row for each effort.
    fn at(&self, runs: &[&PreparedRun], (r, i): Sample) -> DMatrix<f64> {
        let run = runs[r];
        let through = |filter: &Option<Filter>, column: &[f64]| match filter {
            Some(filter) => filter.apply_at(column, std::iter::once(i))[0],
            None => column[i],
        };
        let state = |all: &[Vec<f64>]| -> Vec<f64> { all.iter().map(|c| through(&self.band, c)).collect() };
        let (y, v, a) = (state(run.coordinates()), state(&run.velocities), state(&run.accelerations));
        let joints = v.len();
        let inertial = self.inertial(&y, &v, &a);
        let terms = 2 + self.signs[r].first().map_or(0, Vec::len);
        let mut all = inertial.clone().resize_horizontally(inertial.ncols() + terms * joints, 0.0);
        for j in (0..joints).filter(|j| !self.exact[*j]) {
            let friction = inertial.ncols() + terms * j;
            all[(j, friction)] = v[j];
            all[(j, friction + 1)] = 1.0;
            for (k, sign) in self.signs[r][j].iter().enumerate() {
                all[(j, friction + 2 + k)] = through(&self.filter, sign);
            }
        }
        match &self.inverse {
            Some(inverse) => inverse * all,
            None => all,
        }
    }

    /// Returns the columns of the inertial parameters, one row for each joint.
    fn inertial(&self, y: &[f64], v: &[f64], a: &[f64]) -> DMatrix<f64> {
        let (joints, parameters) = (v.len(), self.parameters);
        let regressor = |v: &[f64], a: &[f64]| {
            let mut columns = vec![0.0; joints * parameters];
            self.robot.inertial_regressor(y, v, a, &mut columns);
            DMatrix::from_row_slice(joints, parameters, &columns)
        };
        let all = regressor(v, a);
        if !self.is_compensated {
            return all;
        }
        let weight = regressor(&vec![0.0; joints], &vec![0.0; joints]);
        let mut apart = (all - &weight).resize_horizontally(2 * parameters, 0.0);
        apart.columns_mut(parameters, parameters).copy_from(&weight);
        apart
    }
}

/// A sample: index of the run, and index of the sample in the run.
pub(super) type Sample = (usize, usize);

/// Returns about `count` samples at which a joint moves, spread evenly over all runs. They are at least
/// `margin` samples away from the ends of a run.
pub(super) fn spread(runs: &[&PreparedRun], count: usize, margin: usize) -> Vec<Sample> {
    let inner = |r: &PreparedRun| margin..r.times.len().saturating_sub(margin).max(margin);
    let moving = |(k, r): (usize, &&PreparedRun)| {
        inner(r).filter(|i| r.is_moving(*i)).map(move |i| (k, i)).collect::<Vec<Sample>>()
    };
    let all: Vec<Sample> = runs.iter().enumerate().flat_map(moving).collect();
    let stride = all.len().div_ceil(count.max(1)).max(1);
    all.into_iter().step_by(stride).collect()
}

/// Regression of one effort on the chosen samples.
pub(super) struct Problem {
    /// Rows of the regression, multiplied by the inverse Cholesky factor of the normal equations. There is one row for each
    /// column of the regression and one column for each sample. The rows are orthonormal, apart from the effect of the
    /// ridge. An entry is zero if a joint on which the effort acts rests at the sample.
    basis: DMatrix<f64>,
    /// Scaled columns of the regression as rows of unit length, one entry for each sample.
    rows: DMatrix<f64>,
    /// Factor of each sample: 0 if a joint on which the effort acts rests, otherwise 1.
    moving: DVector<f64>,
}

/// Equations of one effort for the chosen samples.
pub(super) struct Equations {
    /// Columns of the regression as rows, one entry for each sample. The entry is zero if a joint on which the effort acts
    /// rests.
    pub rows: DMatrix<f64>,
    /// Factor of each sample: 0 if a joint on which the effort acts rests, otherwise 1.
    pub moving: DVector<f64>,
}

impl Equations {
    /// Creates the equations of each effort.
    pub(crate) fn of_efforts(columns: &Columns, runs: &[&PreparedRun], samples: &[Sample]) -> Vec<Self> {
        let blocks: Vec<DMatrix<f64>> = samples.iter().map(|sample| columns.at(runs, *sample)).collect();
        let Some(first) = blocks.first() else { return Vec::new() };
        let of_effort = |m: usize| {
            let moves = |(r, i): &Sample| f64::from(u8::from(!columns.rests(runs[*r], m, *i)));
            let moving = DVector::from_iterator(samples.len(), samples.iter().map(moves));
            let rows = DMatrix::from_fn(first.ncols(), blocks.len(), |k, i| blocks[i][(m, k)] * moving[i]);
            Self { rows, moving }
        };
        (0..first.nrows()).map(of_effort).collect()
    }
}

/// Returns the regression of each effort; `None` if its normal equations have no Cholesky factor.
pub(super) fn problems(columns: &Columns, runs: &[&PreparedRun], samples: &[Sample]) -> Vec<Option<Problem>> {
    Equations::of_efforts(columns, runs, samples).into_iter().map(Problem::new).collect()
}

pub(super) fn ridged(mut gram: DMatrix<f64>) -> DMatrix<f64> {
    for k in 0..gram.nrows() {
        gram[(k, k)] += RIDGE;
    }
    gram
}

impl Problem {
    fn new(Equations { rows: columns, moving }: Equations) -> Option<Self> {
        let norms: Vec<f64> = columns.row_iter().map(|c| c.norm()).collect();
        let largest = norms.iter().copied().fold(0.0, f64::max);
        let used: Vec<usize> = (0..norms.len()).filter(|k| norms[*k] > 1e-9 * largest).collect();
        let rows =
            DMatrix::from_fn(used.len(), columns.ncols(), |k, i| columns[(used[k], i)] / norms[used[k]]);
        // nalgebra multiplies by a transposed copy in blocks, which is several times faster than dot products.
        let gram = ridged(&rows * rows.transpose());
        Some(Self { basis: gram.cholesky()?.l().solve_lower_triangular(&rows)?, rows, moving })
    }

    /// Returns the residual sum of squares of each target on each of `folds` contiguous folds, for a fit to the samples
    /// outside the fold; `None` if too few samples remain outside a fold.
    pub(crate) fn held_out(&self, targets: &DMatrix<f64>, folds: usize) -> Option<Vec<Vec<f64>>> {
        let part = |fold: &Range<usize>| self.rows.columns(fold.start, fold.len());
        let of_targets = |fold: &Range<usize>| targets.rows(fold.start, fold.len());
        let (gram, products) = (&self.rows * self.rows.transpose(), &self.rows * targets);
        let errors = |fold: Range<usize>| {
            let (x, t) = (part(&fold), of_targets(&fold));
            let others = ridged(&gram - x * x.transpose()).cholesky()?;
            let left = t - x.tr_mul(&others.solve(&(&products - x * t)));
            let moving = self.moving.rows(fold.start, fold.len());
            Some(left.column_iter().map(|left| left.component_mul(&moving).norm_squared()).collect())
        };
        contiguous_blocks(self.moving.len(), folds).map(errors).collect()
    }

    /// Returns the part of `target` that the columns do not explain; zero at samples of rest.
    pub(crate) fn residual(&self, target: &DVector<f64>) -> DVector<f64> {
        let explained = self.basis.tr_mul(&(&self.basis * target));
        (target - explained).component_mul(&self.moving)
    }

    /// Returns the residual sum of squares of each column of `targets`.
    pub(crate) fn misfits(&self, targets: &DMatrix<f64>) -> Vec<f64> {
        let explained = &self.basis * targets;
        let squares = targets.column_iter().zip(explained.column_iter());
        squares
            .map(|(all, part)| all.component_mul(&self.moving).norm_squared() - part.norm_squared())
            .collect()
    }
}
