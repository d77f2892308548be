//! Equations of the logs without and with the load, as sums of products for each joint and each block of time.

use super::levels;
use super::settings::PayloadSettings;
use crate::error::{Result, require_length, require_samples};
use crate::estimation::{BlockSums, FRICTION, Piece, distance, inverse, sums_of_blocks, with_ridge};
use crate::inertial::PER_BODY;
use crate::pose::rows_of;
use crate::robot::Robot;
use crate::run::{Effort, PreparedRun};
use nalgebra::{DMatrix, DVector};

/// Smallest assumed standard deviation of a residual, as a share of the effort. It is needed for simulated logs without noise.
const QUIETEST: f64 = 1e-9;

/// Number of reweightings of the joints by their residuals. Three are usually enough.
const REWEIGHTINGS: usize = 5;

/// Sums of products of the columns `[load | δ | friction | target]`, with the error δ of the description.
pub(super) struct Equations {
    /// Sums of each joint, for each block of time. The blocks with the load, from `loaded_from` on, are the last ones.
    blocks: Vec<Vec<BlockSums>>,
    loaded_from: usize,
    /// Sums of each joint over all blocks.
    all: Vec<BlockSums>,
    /// Prior that holds the error of the description near zero: the metric of bodies, and relative changes of rotor inertias.
    /// Load and friction are free.
    prior: DMatrix<f64>,
    weight: f64,
    /// Weights 1/σ² of the joints; zero for a joint at rest. σ is the standard deviation of the residuals of the weighted fit,
    /// which is found by iteration.
    pub(super) weights: Vec<f64>,
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
        let (joints, described) = (robot.joint_names().len(), robot.parameters());
        let (parameters, bodies) = (described.len(), PER_BODY * robot.bodies());
        require_length("inertial parameters of the bodies", bodies, parameters.min(bodies))?;
        let (metric, held) = distance(&described, robot.bodies());
        let (friction, target) = (PER_BODY + parameters, PER_BODY + parameters + FRICTION * joints);
        let exact = rows_of(&robot.quaternion_joints(), joints);
        let map = |joint: usize, is_loaded: bool| {
            let mut map = DMatrix::zeros(parameters + FRICTION + 2, target + 1);
            let load = (0..PER_BODY).filter(|_| is_loaded);
            load.for_each(|k| map[(PER_BODY * body + k, k)] = 1.0);
            // Bodies without mass and rotors without inertia stay the same.
            let free = (0..parameters).filter(|i| !held[*i]);
            free.for_each(|i| map[(i, PER_BODY + i)] = 1.0);
            let own = (0..FRICTION).filter(|_| !exact[joint]);
            own.for_each(|term| map[(parameters + term, friction + FRICTION * joint + term)] = 1.0);
            map[(parameters + FRICTION, target)] = -1.0;
            map[(parameters + FRICTION + 1, target)] = 1.0;
            map
        };
        let maps = [false, true].map(|is_loaded| (0..joints).map(|j| map(j, is_loaded)).collect::<Vec<_>>());
        let of_block = |(block, mut sums): (usize, Vec<BlockSums>)| {
            let maps = &maps[usize::from(block >= loaded_from)];
            let mapped = |(sums, map): (&mut BlockSums, &DMatrix<f64>)| {
                sums.products = map.tr_mul(&(&sums.products * map));
            };
            sums.iter_mut().zip(maps).for_each(mapped);
            sums
        };
        let blocks = sums_of_blocks(robot, &runs, &pieces, levels::STICKING.get())?;
        let blocks: Vec<Vec<BlockSums>> = blocks.into_iter().enumerate().map(of_block).collect();
        let all = |joint: usize| BlockSums {
            products: blocks.iter().map(|block| &block[joint].products).sum(),
            samples: blocks.iter().map(|block| block[joint].samples).sum(),
        };
        // The objective is half of the sum of squares, so the distance has the factor two.
        let metric = metric * (2.0 * settings.weight);
        let mut prior = DMatrix::zeros(target + 1, target + 1);
        prior.view_mut((PER_BODY, PER_BODY), (parameters, parameters)).copy_from(&metric);
        let all = (0..joints).map(all).collect();
        Self { blocks, loaded_from, all, prior, weight: settings.weight, weights: Vec::new() }.weighted()
    }

    fn weighted(mut self) -> Result<Self> {
        let samples: f64 = self.all.iter().map(|sums| sums.samples).sum();
        require_samples("the estimate of a payload from moving joints", 1, samples as usize)?;
        let last = self.prior.nrows() - 1;
        let weight = |sums: &BlockSums, values: &DVector<f64>| {
            let floor = QUIETEST * QUIETEST * sums.products[(last, last)];
            match values.dot(&(&sums.products * values)).max(floor) {
                _ if sums.samples == 0.0 => 0.0,
                square if square > 0.0 => sums.samples / square,
                _ => 1.0,
            }
        };
        let mut values = DVector::zeros(last).push(-1.0);
        for _ in 0..REWEIGHTINGS {
            self.weights = self.all.iter().map(|sums| weight(sums, &values)).collect();
            let (hessian, linear) = self.normal();
            values = (inverse(&hessian)? * linear).push(-1.0);
        }
        self.weights = self.all.iter().map(|sums| weight(sums, &values)).collect();
        Ok(self)
    }

    /// Number of blocks of time.
    pub(super) fn blocks(&self) -> usize {
        self.blocks.len()
    }

    /// Hessian and right side of the weighted equations of load, error of the description and friction.
    pub(super) fn normal(&self) -> (DMatrix<f64>, DVector<f64>) {
        let weighted = self.all.iter().zip(&self.weights).map(|(sums, weight)| &sums.products * *weight);
        let total = weighted.fold(self.prior.clone(), |total, joint| total + joint);
        let n = total.nrows() - 1;
        (
            with_ridge(total.view((0, 0), (n, n)).into_owned()),
            total.view((0, n), (n, 1)).column(0).into_owned(),
        )
    }

    /// Covariance of the load's parameters, for errors that are correlated within blocks of time. It is the
    /// sandwich covariance with the scores of the blocks, plus the effect of errors of the description and of
    /// the reference ball. These errors have the distance one.
    ///
    /// - `hessian`: Hessian with the metric `held` of the reference ball
    /// - `values`: all unknowns, and −1 for the target
    pub(super) fn covariance(
        &self,
        hessian: &DMatrix<f64>,
        held: &DMatrix<f64>,
        values: &DVector<f64>,
    ) -> Result<DMatrix<f64>> {
        let n = hessian.nrows();
        let mut meat = DMatrix::zeros(n, n);
        for block in &self.blocks {
            let products =
                block.iter().zip(&self.weights).map(|(sums, weight)| &sums.products * values * *weight);
            let score = products.sum::<DVector<f64>>().remove_row(n);
            meat.ger(1.0, &score, &score, 1.0);
        }
        let blocks = self.blocks.len() as f64;
        meat *= blocks / (blocks - 1.0);
        meat += (self.prior.view((0, 0), (n, n)) + held) * self.weight;
        let bread = inverse(hessian)?.rows(0, PER_BODY).into_owned();
        Ok(&bread * meat * bread.transpose())
    }

    /// For each joint, the share of the residual sum of squares of the log with the load that the load removes, if friction is
    /// unchanged; `None` for a joint at rest.
    pub(super) fn explained(&self, values: &DVector<f64>) -> Vec<Option<f64>> {
        let mut without = values.clone();
        without.rows_mut(0, PER_BODY).fill(0.0);
        let square = |x: &DVector<f64>, joint: usize| -> f64 {
            self.blocks[self.loaded_from..].iter().map(|block| x.dot(&(&block[joint].products * x))).sum()
        };
        let share = |j: usize| match square(&without, j) {
            before if before > 0.0 => Some(1.0 - square(values, j) / before),
            _ => None,
        };
        (0..self.all.len()).map(share).collect()
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
