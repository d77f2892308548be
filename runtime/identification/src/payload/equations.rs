//! Equations of the logs without and with the load, reduced to sums of products for each joint and each block of time.

use super::levels;
use super::settings::PayloadSettings;
use crate::error::{IdentificationError, Result, require_length, require_samples};
use crate::estimation::{BlockSums, FRICTION, Piece, distance, inverse, sums_of_blocks, with_ridge};
use crate::inertial::PER_BODY;
use crate::pose::rows_of;
use crate::robot::Robot;
use crate::run::{Effort, PreparedRun};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

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
    rows: f64,
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
        let runs = [without, with].concat();
        check(robot, &runs)?;
        let samples = runs.iter().map(|run| run.times.len()).sum::<usize>();
        let enough = levels::BLOCKS.get() * PER_BODY;
        require_samples("the estimate of a payload from both logs", enough, samples)?;
        let pieces = pieces(&runs, without.len(), samples.div_ceil(levels::BLOCKS.get()));
        let loaded_from =
            pieces.iter().find(|piece| piece.run >= without.len()).map_or(0, |piece| piece.fold);
        let (joints, parameters) = (robot.joint_names().len(), robot.parameters().len());
        let nuisance = parameters + FRICTION * joints;
        let exact = rows_of(&robot.quaternion_joints(), joints);
        let map = |joint: usize, is_loaded: bool| {
            let mut map = DMatrix::zeros(parameters + FRICTION + 2, nuisance + PER_BODY + 1);
            (0..parameters).for_each(|i| map[(i, i)] = 1.0);
            let own = (0..FRICTION).filter(|_| !exact[joint]);
            own.for_each(|term| map[(parameters + term, parameters + FRICTION * joint + term)] = 1.0);
            let load = (0..PER_BODY).filter(|_| is_loaded);
            load.for_each(|k| map[(PER_BODY * body + k, nuisance + k)] = 1.0);
            map[(parameters + FRICTION, nuisance + PER_BODY)] = -1.0;
            map[(parameters + FRICTION + 1, nuisance + PER_BODY)] = 1.0;
            map
        };
        let maps = [false, true].map(|is_loaded| (0..joints).map(|j| map(j, is_loaded)).collect::<Vec<_>>());
        let sums = sums_of_blocks(robot, &runs, &pieces, levels::STICKING.get())?;
        let of_block = |(block, sums): (usize, Vec<BlockSums>)| {
            let sums = sums.iter().zip(&maps[usize::from(block >= loaded_from)]);
            sums.map(|(sums, map)| Sums { gram: map.tr_mul(&(&sums.products * map)), rows: sums.samples })
                .collect()
        };
        Ok(Self {
            nuisance,
            joints,
            blocks: sums.into_iter().enumerate().map(of_block).collect(),
            loaded_from,
            prior: prior(robot, nuisance, settings.weight)?,
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
        let mut total = Sums { gram: DMatrix::zeros(size, size), rows: 0.0 };
        self.blocks.iter().for_each(|block| total.add(&block[joint]));
        total
    }

    /// Weights 1/σ² of the joints; zero for a joint at rest. σ is the standard deviation of the residuals of the weighted fit,
    /// which is found by iteration.
    pub(super) fn weights(&self) -> Result<Vec<f64>> {
        let all: Vec<Sums> = (0..self.joints).map(|j| self.joint(j)).collect();
        let rows: f64 = all.iter().map(|sums| sums.rows).sum();
        require_samples("the estimate of a payload from moving joints", 1, rows as usize)?;
        let last = self.nuisance + PER_BODY;
        let weight = |square: f64, sums: &Sums| {
            let floor = QUIETEST * QUIETEST * sums.gram[(last, last)];
            match square.max(floor) {
                _ if sums.rows == 0.0 => 0.0,
                square if square > 0.0 => sums.rows / square,
                _ => 1.0,
            }
        };
        let mut weights: Vec<f64> = all.iter().map(|s| weight(s.gram[(last, last)], s)).collect();
        for _ in 0..REWEIGHTINGS {
            let reduced = self.reduced(&weights)?;
            let definite = with_ridge(reduced.hessian.clone());
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
        let own = with_ridge(total.view((0, 0), (n, n)) + &self.prior);
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

/// Fails if runs do not match the robot, or if their efforts are currents without described motor constants.
fn check(robot: &dyn Robot, runs: &[PreparedRun]) -> Result<()> {
    let effort = runs[0].effort;
    if effort == Effort::Current {
        let given = robot.described_currents().into_iter().filter(|is_given| *is_given).count();
        let what = "motor constants (`motor_constant` of the drives), which logs of currents need";
        require_length(what, robot.input_names().len(), given)?;
    }
    // A robot with a floating base may have joints without a sensor, whose efforts are NaN throughout.
    let may_lack = !robot.quaternion_joints().is_empty();
    runs.iter().try_for_each(|run| run.check(robot, effort, may_lack))
}

/// Cuts the runs into blocks of about `length` samples. Short runs share a block. A block begins with the run `loaded`.
fn pieces(runs: &[PreparedRun], loaded: usize, length: usize) -> Vec<Piece> {
    let (mut pieces, mut blocks, mut filled) = (Vec::new(), 0, length);
    for (run, samples) in runs.iter().enumerate() {
        filled = if run == loaded { length } else { filled };
        for start in (0..samples.times.len()).step_by(length) {
            let rows = start..samples.times.len().min(start + length);
            if filled >= length {
                (blocks, filled) = (blocks + 1, 0);
            }
            filled += rows.len();
            pieces.push(Piece { run, fold: blocks - 1, rows });
        }
    }
    pieces
}

/// Prior that holds the error of the description near zero: the metric of bodies, and relative changes of rotor inertias.
/// Friction is free.
fn prior(robot: &dyn Robot, nuisance: usize, weight: f64) -> Result<DMatrix<f64>> {
    let described = robot.parameters();
    let bodies = PER_BODY * robot.bodies();
    require_length("inertial parameters of the bodies", bodies, described.len().min(bodies))?;
    let (metric, held) = distance(&described, robot.bodies());
    // The objective is half of the sum of squares, so the distance has the factor two.
    let mut own = metric * (2.0 * weight);
    // Bodies without mass and rotors without inertia stay the same.
    (0..held.len()).filter(|i| held[*i]).for_each(|i| own[(i, i)] = weight / HELD.powi(2));
    Ok(own.resize(nuisance, nuisance, 0.0))
}

fn singular() -> IdentificationError {
    let reason = "the equations of the load are singular. Record a longer motion in which more joints move";
    IdentificationError::NoSolution { reason: reason.into() }
}
