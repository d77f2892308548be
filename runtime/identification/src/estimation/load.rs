//! A load that a body carries in some of the runs: ten more unknowns.

use super::super::error::{Result, require_length, require_samples};
use super::super::inertial::consistent::MARGIN;
use super::super::inertial::{PER_BODY, margin};
use super::super::robot::Robot;
use super::super::run::PreparedRun;
use super::choice::Chosen;
use super::estimate::layout_of;
use super::joint_prior::JointPrior;
use super::layout::Layout;
use super::normal::Factor;
use super::prior::{Load, Prior};
use super::residuals::Forces;
use super::rows::At;
use super::settings::EstimationSettings;
use super::task::Task;
use nalgebra::{DMatrix, DVector};

/// A load, and how well it explains the efforts.
pub(crate) struct LoadFit {
    pub(crate) values: [f64; PER_BODY],
    pub(crate) covariance: DMatrix<f64>,
    /// Standard deviations before there were data.
    pub(crate) before: DVector<f64>,
    /// Degrees of freedom of the covariance.
    pub(crate) freedom: usize,
    /// Change of the values without the samples near rests and reversals.
    pub(crate) margin: DVector<f64>,
    /// Whether the efforts ask for a body that cannot exist.
    pub(crate) on_boundary: bool,
    /// Share of each joint's residual in the runs with the load that the load removes; `None` if its efforts are not used.
    pub(crate) explained: Vec<Option<f64>>,
    /// Root mean square of each joint's residual over all runs; `None` if its efforts are not used.
    pub(crate) residuals: Vec<Option<f64>>,
}

/// Fits a load together with all other unknowns. Runs without it choose the terms, the weight of the description and the weights of
/// the joints. Joints that do not move are left out, because dry friction holds a part of the load there.
///
/// - `[without, with]`: runs without and with the load
/// - `body`: the one that carries it
/// - `first`: what is known of the load before there are data; `second`: what a first fit adds to it
///
/// # Errors
/// As [`super::estimate`], no runs of one kind, and currents without described motor constants.
pub(crate) fn estimate_load(
    robot: &dyn Robot,
    [without, with]: [&[PreparedRun]; 2],
    (body, settings): (usize, &EstimationSettings),
    first: Load,
    second: &dyn Fn(&LoadFit) -> Result<Option<Load>>,
) -> Result<LoadFit> {
    for (what, runs) in [("runs without the load", without), ("runs with the load", with)] {
        require_samples(what, 1, runs.len())?;
    }
    settings.check()?;
    let all = [without, with].concat();
    let layout = layout_of(robot, &all, settings, (settings.steepness.as_deref(), false))?;
    let layout = moving(layout)?;
    let prior = Prior::new(&robot.parameters(), robot.bodies(), JointPrior::all(robot, &layout, &all));
    let task = Task::new(robot, without, settings, (&layout, &prior));
    let (sums, count) = (task.sums(None), layout.parameters);
    let chosen = task.choose(&sums)?;
    let carried = |at: &At, added: &mut [f64]| {
        let rows = added.chunks_exact_mut(count + PER_BODY).zip(at.regressor.chunks_exact(count));
        for (added, own) in rows.filter(|_| at.run >= without.len()) {
            added[count..].copy_from_slice(&own[PER_BODY * body..PER_BODY * (body + 1)]);
        }
    };
    let task = Task::new(robot, &all, settings, (&layout, &prior));
    task.with_more((PER_BODY, &carried), |task, sums| {
        let fitted = |load: Load| {
            let inverse = Factor::new(&load.precision)?.solve(&DMatrix::identity(PER_BODY, PER_BODY));
            let prior = task.prior.clone().with_load(load);
            let task = Task { prior: &prior, ..task.clone() };
            // Its own prior holds the load.
            let mut fitted = chosen.with_more(task.layout, sums, 0.0);
            fitted.reweight(&prior)?;
            LoadFit::new(&task, &fitted, inverse.diagonal().map(f64::sqrt), without.len())
        };
        let found = fitted(first)?;
        match second(&found)? {
            Some(load) => fitted(load),
            None => Ok(found),
        }
    })
}

/// The layout of joints that move and whose gains are known.
fn moving(layout: Layout) -> Result<Layout> {
    let known = layout.known_gains.iter().filter(|known| **known).count();
    let what = "motor constants (`motor_constant` of the drives), which logs of currents need";
    require_length(what, layout.joints, known)?;
    let rests = |joint: &usize| !layout.moves[*joint] && !layout.exact[*joint];
    let still: Vec<usize> = (0..layout.joints).filter(rests).collect();
    let layout = layout.without(&still);
    let moving = layout.measured.iter().filter(|measured| **measured).count();
    require_samples("a payload, joints that move", 1, moving)?;
    Ok(layout)
}

impl LoadFit {
    /// - `first`: number of the first run with the load
    fn new(task: &Task, fitted: &Chosen, before: DVector<f64>, first: usize) -> Result<Self> {
        let (layout, start) = (task.layout, task.layout.own_parameters);
        let found = task.inferred(fitted, &vec![f64::INFINITY; layout.joints])?;
        let mut without = found.solved.values.clone();
        without.unknowns.rows_mut(start, PER_BODY).fill(0.0);
        let without = task.forces(&without, &found.offsets);
        let squares = |forces: &Forces, joint: usize, first: usize| {
            let samples = forces.moving(layout, task.runs, joint).filter(|(run, _)| *run >= first);
            samples.map(|(run, i)| forces.residual[run][joint][i].powi(2)).sum::<f64>()
        };
        let explained = |joint: usize| {
            let before = squares(&without, joint, first);
            let is_known = layout.measured[joint] && before > 0.0;
            is_known.then(|| 1.0 - squares(&found.forces, joint, first) / before)
        };
        let residual = |joint: usize| {
            let count = found.forces.moving(layout, task.runs, joint).count();
            let is_known = layout.measured[joint] && count > 0;
            is_known.then(|| (squares(&found.forces, joint, 0) / count as f64).sqrt())
        };
        let values = std::array::from_fn(|k| found.solved.values.unknowns[start + k]);
        let covariance = |i: usize, k: usize| found.covariance.of(&found.solved, start + i, start + k);
        Ok(Self {
            values,
            covariance: DMatrix::from_fn(PER_BODY, PER_BODY, covariance),
            before,
            freedom: found.covariance.freedom.max(1),
            margin: found.margin.rows(start, PER_BODY).into_owned(),
            on_boundary: margin(&values) < 2.0 * MARGIN,
            explained: (0..layout.joints).map(explained).collect(),
            residuals: (0..layout.joints).map(residual).collect(),
        })
    }
}
