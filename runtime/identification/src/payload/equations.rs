//! Equations of the logs without and with the load, reduced to sums of products for each joint and each block of time.

use super::levels;
use super::settings::PayloadSettings;
use crate::error::{IdentificationError, Result, require_length, require_samples};
use crate::estimation::{distance, inverse};
use crate::inertial::PER_BODY;
use crate::numeric::statistics::largest;
use crate::pose::rows_of;
use crate::robot::Robot;
use crate::run::{Effort, PreparedRun};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Widths of smoothed Coulomb friction, as shares of the joint's largest speed. Terms of these widths approximate any
/// friction curve with a steep start.
const WIDTHS: [f64; 3] = [0.005, 0.03, 0.15];

/// Number of friction columns of a joint: constant, viscous, and the smoothed signs.
const TERMS: usize = 2 + WIDTHS.len();

/// Smallest assumed standard deviation of a residual, as a share of the effort. It is needed for simulated logs without noise.
const QUIETEST: f64 = 1e-9;

/// Change of a held parameter that counts as the distance one [kg, kg m, kg m²].
const HELD: f64 = 1e-9;

/// Number of reweightings of the joints by their residuals. Three are usually enough.
const REWEIGHTINGS: usize = 5;

/// Sums of products of the columns `[δ | friction | load | target]`, with the error δ of the description.
pub(super) struct Equations {
    /// Number of columns of the description's error and of friction.
    nuisance: usize,
    joints: usize,
    /// Sums of each joint, for each block of time. The blocks with the load, from `loaded_from` on, are the last ones.
    blocks: Vec<Vec<Sums>>,
    loaded_from: usize,
    /// Prior that holds the error of the description near zero and keeps friction finite.
    prior: DMatrix<f64>,
    weight: f64,
}

/// Sums of products of a joint's rows.
struct Sums {
    gram: DMatrix<f64>,
    rows: usize,
}

impl Sums {
    fn add(&mut self, other: &Self) {
        self.gram += &other.gram;
        self.rows += other.rows;
    }
}

/// The equations of the load after the error of the description and friction are eliminated.
pub(super) struct Reduced {
    pub hessian: DMatrix<f64>,
    pub linear: DVector<f64>,
    factor: Cholesky<f64, Dyn>,
    /// Products of the columns of the description's error and of friction with the columns of the load.
    coupling: DMatrix<f64>,
    /// Products of the columns of the description's error and of friction with the target.
    right: DVector<f64>,
}

impl Equations {
    pub(super) fn new(
        robot: &dyn Robot,
        without: &[PreparedRun],
        with: &[PreparedRun],
        body: usize,
        settings: &PayloadSettings,
    ) -> Result<Self> {
        for (what, runs) in
            [("the list of runs without the load", without), ("the list of runs with the load", with)]
        {
            require_samples(what, 1, runs.len())?;
        }
        let columns = Columns::new(robot, without.iter().chain(with), body)?;
        let count = |runs: &[PreparedRun]| runs.iter().map(|run| run.times.len()).sum::<usize>();
        let samples = count(without) + count(with);
        require_samples(
            "the estimate of a payload from both logs",
            levels::BLOCKS.get() * PER_BODY,
            samples,
        )?;
        let length = samples.div_ceil(levels::BLOCKS.get());
        let mut blocks = Vec::new();
        columns.add_blocks(without, false, length, &mut blocks);
        let loaded_from = blocks.len();
        columns.add_blocks(with, true, length, &mut blocks);
        let mut prior = DMatrix::zeros(columns.nuisance, columns.nuisance);
        columns.hold(settings.weight, &mut prior)?;
        Ok(Self {
            nuisance: columns.nuisance,
            joints: columns.joints,
            blocks,
            loaded_from,
            prior,
            weight: settings.weight,
        })
    }

    /// Number of blocks of time.
    pub(super) fn blocks(&self) -> usize {
        self.blocks.len()
    }

    /// Sum over all blocks of one joint.
    fn joint(&self, joint: usize) -> Sums {
        let size = self.nuisance + PER_BODY + 1;
        let mut total = Sums { gram: DMatrix::zeros(size, size), rows: 0 };
        self.blocks.iter().for_each(|block| total.add(&block[joint]));
        total
    }

    /// Weights 1/σ² of the joints; zero for a joint at rest. σ is the standard deviation of the residuals of the weighted fit,
    /// which is found by iteration.
    pub(super) fn weights(&self) -> Result<Vec<f64>> {
        let all: Vec<Sums> = (0..self.joints).map(|j| self.joint(j)).collect();
        require_samples("the estimate of a payload from moving joints", 1, all.iter().map(|s| s.rows).sum())?;
        let last = self.nuisance + PER_BODY;
        let weight = |square: f64, sums: &Sums| {
            let floor = QUIETEST * QUIETEST * sums.gram[(last, last)];
            match square.max(floor) {
                _ if sums.rows == 0 => 0.0,
                square if square > 0.0 => sums.rows as f64 / square,
                _ => 1.0,
            }
        };
        let mut weights: Vec<f64> = all.iter().map(|s| weight(s.gram[(last, last)], s)).collect();
        for _ in 0..REWEIGHTINGS {
            let reduced = self.reduced(&weights)?;
            let mut definite = reduced.hessian.clone();
            stiffen(&mut definite, 0..PER_BODY);
            let load = definite.cholesky().ok_or_else(singular)?.solve(&reduced.linear);
            let x = self.homogeneous(&reduced, &load);
            weights = all.iter().map(|s| weight(x.dot(&(&s.gram * &x)), s)).collect();
        }
        Ok(weights)
    }

    /// The vector `(δ, friction, load, −1)` with the error δ of the description. A Gram matrix of the columns
    /// times this vector gives the products of the columns with the prediction minus the target.
    fn homogeneous(&self, reduced: &Reduced, load: &DVector<f64>) -> DVector<f64> {
        let nuisance = reduced.factor.solve(&(&reduced.right - &reduced.coupling * load));
        let mut x = DVector::zeros(self.nuisance + PER_BODY + 1);
        x.rows_mut(0, self.nuisance).copy_from(&nuisance);
        x.rows_mut(self.nuisance, PER_BODY).copy_from(load);
        x[self.nuisance + PER_BODY] = -1.0;
        x
    }

    /// Eliminates the unknown errors of the description and the unknown friction from the equations.
    pub(super) fn reduced(&self, weights: &[f64]) -> Result<Reduced> {
        let size = self.nuisance + PER_BODY + 1;
        let mut total = DMatrix::zeros(size, size);
        for (joint, weight) in weights.iter().enumerate() {
            total += self.joint(joint).gram * *weight;
        }
        let n = self.nuisance;
        let mut own = total.view((0, 0), (n, n)) + &self.prior;
        stiffen(&mut own, 0..n);
        let coupling = total.view((0, n), (n, PER_BODY)).into_owned();
        let right = total.view((0, n + PER_BODY), (n, 1)).column(0).into_owned();
        let factor = own.cholesky().ok_or_else(singular)?;
        let hessian = total.view((n, n), (PER_BODY, PER_BODY)) - coupling.tr_mul(&factor.solve(&coupling));
        let linear =
            total.view((n, n + PER_BODY), (PER_BODY, 1)).column(0) - coupling.tr_mul(&factor.solve(&right));
        Ok(Reduced { hessian: (&hessian + hessian.transpose()) * 0.5, linear, factor, coupling, right })
    }

    /// Covariance of the load's parameters, for errors that are correlated within blocks of time. It is the
    /// sandwich covariance with the scores of the blocks, plus the effect of errors of the description and of
    /// the reference ball. These errors have the distance one.
    pub(super) fn covariance(
        &self,
        weights: &[f64],
        reduced: &Reduced,
        held: &DMatrix<f64>,
        load: &DVector<f64>,
    ) -> Result<DMatrix<f64>> {
        let hessian = &reduced.hessian + held;
        let x = self.homogeneous(reduced, load);
        let projection = reduced.factor.solve(&reduced.coupling);
        let mut meat = DMatrix::zeros(PER_BODY, PER_BODY);
        for block in &self.blocks {
            let mut products = DVector::zeros(x.len());
            for (sums, weight) in block.iter().zip(weights) {
                products += &sums.gram * &x * *weight;
            }
            let own = products.rows(0, self.nuisance);
            let score = products.rows(self.nuisance, PER_BODY) - projection.tr_mul(&own);
            meat += &score * score.transpose();
        }
        let blocks = self.blocks.len() as f64;
        meat *= blocks / (blocks - 1.0);
        meat += (projection.tr_mul(&(&self.prior * &projection)) + held) * self.weight;
        let bread = inverse(&hessian)?;
        Ok(&bread * meat * &bread)
    }

    /// For each joint, the share of the residual sum of squares of the log with the load that the load removes, if friction is
    /// unchanged; `None` for a joint at rest.
    pub(super) fn explained(&self, reduced: &Reduced, load: &DVector<f64>) -> Vec<Option<f64>> {
        let with = self.homogeneous(reduced, load);
        let mut without = with.clone();
        without.rows_mut(self.nuisance, PER_BODY).fill(0.0);
        let square = |x: &DVector<f64>, joint: usize| -> f64 {
            self.blocks[self.loaded_from..].iter().map(|block| x.dot(&(&block[joint].gram * x))).sum()
        };
        let share = |j: usize| match square(&without, j) {
            before if before > 0.0 => Some(1.0 - square(&with, j) / before),
            _ => None,
        };
        (0..self.joints).map(share).collect()
    }
}

/// Makes a semidefinite matrix definite if columns are zero or dependent.
fn stiffen(matrix: &mut DMatrix<f64>, range: std::ops::Range<usize>) {
    let least = 1e-14 * matrix.diagonal().amax().max(f64::MIN_POSITIVE);
    for i in range {
        matrix[(i, i)] = matrix[(i, i)] * (1.0 + 1e-10) + least;
    }
}

/// Inputs from which the columns of all rows are computed.
struct Columns<'a> {
    robot: &'a dyn Robot,
    joints: usize,
    parameters: usize,
    nuisance: usize,
    body: usize,
    /// B, row by row.
    input_matrix: Vec<f64>,
    /// Largest speed of each joint. A joint at rest has no rows.
    speeds: Vec<f64>,
    /// Whether each row is that of a joint with a quaternion.
    exact: Vec<bool>,
    /// Whether the force of each row is known in all runs.
    known: Vec<bool>,
}

impl<'a> Columns<'a> {
    fn new<'b>(
        robot: &'a dyn Robot,
        runs: impl Iterator<Item = &'b PreparedRun>,
        body: usize,
    ) -> Result<Self> {
        let runs: Vec<&PreparedRun> = runs.collect();
        let (joints, parameters) = (robot.joint_names().len(), robot.parameters().len());
        let effort = runs[0].effort;
        if effort == Effort::Current {
            let given = robot.described_currents().into_iter().filter(|is_given| *is_given).count();
            let what = "motor constants (`motor_constant` of the drives), which logs of currents need";
            require_length(what, robot.input_names().len(), given)?;
        }
        let quaternions = robot.quaternion_joints();
        for run in &runs {
            run.check(robot, effort, !quaternions.is_empty())?;
        }
        let speeds = (0..joints).map(|j| largest(runs.iter().flat_map(|run| &run.velocities[j]))).collect();
        let nuisance = parameters + TERMS * joints;
        let exact = rows_of(&quaternions, joints);
        // A robot with a floating base may have joints without a sensor, whose efforts are NaN throughout.
        let is_known = |j: usize| {
            effort != Effort::Joint
                || runs.iter().all(|run| run.efforts[j].first().is_none_or(|u| !u.is_nan()))
        };
        let known = (0..joints).map(is_known).collect();
        Ok(Self {
            robot,
            joints,
            parameters,
            nuisance,
            body,
            input_matrix: robot.input_matrix(),
            speeds,
            exact,
            known,
        })
    }

    /// Adds sums of products of blocks of about `length` samples. Short runs share a block.
    fn add_blocks(&self, runs: &[PreparedRun], loaded: bool, length: usize, blocks: &mut Vec<Vec<Sums>>) {
        let mut filled = length;
        for run in runs {
            for start in (0..run.times.len()).step_by(length) {
                let range = start..run.times.len().min(start + length);
                let products = self.products(run, range.clone(), loaded);
                match blocks.last_mut() {
                    Some(last) if filled < length => {
                        last.iter_mut().zip(&products).for_each(|(a, b)| a.add(b))
                    }
                    _ => {
                        blocks.push(products);
                        filled = 0;
                    }
                }
                filled += range.len();
            }
        }
    }

    /// Sums of products of the rows of each joint.
    fn products(&self, run: &PreparedRun, range: std::ops::Range<usize>, loaded: bool) -> Vec<Sums> {
        let width = self.nuisance + PER_BODY + 1;
        let mut rows = vec![DMatrix::zeros(range.len(), width); self.joints];
        let mut counts = vec![0; self.joints];
        let mut regressor = vec![0.0; self.joints * self.parameters];
        let mut forces = vec![0.0; self.joints];
        for (row, i) in range.enumerate() {
            let [y, v, a] = run.state(i);
            regressor.fill(0.0);
            self.robot.inertial_regressor(&y, &v, &a, &mut regressor);
            self.robot.rigid_forces(&y, &v, &a, &mut forces);
            for (j, matrix) in rows.iter_mut().enumerate().filter(|(j, _)| self.tells(run, *j, i)) {
                counts[j] += 1;
                let w = &regressor[j * self.parameters..(j + 1) * self.parameters];
                self.write(&mut matrix.row_mut(row), j, w, v[j], loaded);
                matrix[(row, width - 1)] = run.force(&self.input_matrix, j, i) - forces[j];
            }
        }
        rows.iter().zip(counts).map(|(m, rows)| Sums { gram: m.tr_mul(m), rows }).collect()
    }

    /// Whether a sample of a joint contains information on the load: the force is known, and the joint moves, so that
    /// static friction or a brake does not hold it.
    fn tells(&self, run: &PreparedRun, joint: usize, sample: usize) -> bool {
        let speed = run.velocities[joint][sample].abs();
        let slides = speed > levels::STICKING.get() * self.speeds[joint] && !run.rests(joint, sample);
        self.known[joint] && (self.exact[joint] || slides)
    }

    /// Writes one row without its target.
    fn write(
        &self,
        row: &mut nalgebra::MatrixViewMut<f64, nalgebra::U1, Dyn, nalgebra::U1, Dyn>,
        joint: usize,
        w: &[f64],
        velocity: f64,
        loaded: bool,
    ) {
        for (k, x) in w.iter().enumerate() {
            row[k] = *x;
        }
        if loaded {
            for k in 0..PER_BODY {
                row[self.nuisance + k] = w[PER_BODY * self.body + k];
            }
        }
        if self.exact[joint] {
            return;
        }
        let at = self.parameters + TERMS * joint;
        let share = velocity / self.speeds[joint];
        row[at] = 1.0;
        row[at + 1] = share;
        for (k, width) in WIDTHS.iter().enumerate() {
            row[at + 2 + k] = (share / width).tanh();
        }
    }

    /// Writes the prior that holds the error of the description near zero: the metric of bodies, and relative
    /// changes of rotor inertias.
    fn hold(&self, weight: f64, prior: &mut DMatrix<f64>) -> Result<()> {
        let described = self.robot.parameters();
        let bodies = PER_BODY * self.robot.bodies();
        require_length("inertial parameters of the bodies", bodies, described.len().min(bodies))?;
        let (metric, held) = distance(&described, self.robot.bodies());
        // The objective is half of the sum of squares, so the distance has the factor two.
        let mut own = metric * (2.0 * weight);
        // Bodies without mass and rotors without inertia stay the same.
        (0..held.len()).filter(|i| held[*i]).for_each(|i| own[(i, i)] = weight / HELD.powi(2));
        prior.view_mut((0, 0), own.shape()).copy_from(&own);
        Ok(())
    }
}

fn singular() -> IdentificationError {
    let reason = "the equations of the load are singular. Record a longer motion in which more joints move";
    IdentificationError::NoSolution { reason: reason.into() }
}
