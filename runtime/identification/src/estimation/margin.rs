//! The change of the estimate without the samples near rests and reversals.

use super::super::methods::margin::{change, near};
use super::super::run::PreparedRun;
use super::choice::Chosen;
use super::fit::force_weights;
use super::intervals::Fitted;
use super::normal::{Centred, Normal, assemble};
use super::task::Task;
use nalgebra::DVector;

/// Change of each unknown. Weights and offsets' priors stay; none where the runs passed no filter.
pub(super) fn change_at_margin(task: &Task, last: &Chosen, of: &Fitted) -> DVector<f64> {
    let mut changes = DVector::zeros(task.layout.len());
    let Some(filter) = &task.settings.filter else { return changes };
    let away = |run: &PreparedRun| {
        let joints = run.velocities.iter().enumerate();
        let near = joints.map(|(joint, v)| near(v, |sample| run.rests(joint, sample), filter.half_length()));
        PreparedRun { resting: near.collect(), ..run.clone() }
    };
    let runs: Vec<PreparedRun> = task.runs.iter().map(away).collect();
    let sums = Task { runs: &runs, ..task.clone() }.sums(Some((of.values, of.offsets, of.outlier)));
    let left = Centred::new(task.layout, &sums, last.model.offsets, last.centred.zeros.clone());
    let (active, weights) = (&of.solved.active, force_weights(of.weighting, &of.values.gains));
    let normal = |centred: &Centred| assemble(task.layout, &centred.all, active, &weights, &of.values.gains);
    let (all, left) = (normal(of.centred), normal(&left));
    let at = DVector::from_iterator(active.len(), active.iter().map(|&global| of.values.unknowns[global]));
    // Bodies that must be able to exist leave a score: it is no change.
    let gradient = |normal: &Normal| &normal.linear - &normal.hessian * &at;
    let found = change(
        &of.solved.regularized,
        &(&left.hessian + &of.solved.metric),
        &(gradient(&left) - gradient(&all)),
    );
    active.iter().zip(found.iter()).for_each(|(&global, change)| changes[global] = *change);
    changes
}
