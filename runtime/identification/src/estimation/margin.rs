//! The change of the estimate if the samples near rests and reversals are left out.

use super::super::methods::margin::{change, near};
use super::super::run::PreparedRun;
use super::intervals::RigidFit;
use super::normal::{Centred, Normal, assemble};
use super::task::Task;
use nalgebra::DVector;

/// Copies of the runs in which samples near stops of a joint also count as rests; `None` if the runs passed no filter.
pub(super) fn runs_away_from_stops(task: &Task) -> Option<Vec<PreparedRun>> {
    let reach = task.settings.filter.as_ref()?.half_length();
    let of_run = |run: &PreparedRun| {
        let resting = |(joint, v): (usize, &Vec<f64>)| {
            let rests = |sample: usize| run.rests(joint, sample);
            let rubs = task.layout.rubbing().any(|rubbing| rubbing == joint);
            if rubs { near(v, rests, reach) } else { (0..v.len()).map(rests).collect() }
        };
        PreparedRun { resting: run.velocities.iter().enumerate().map(resting).collect(), ..run.clone() }
    };
    Some(task.runs.iter().map(of_run).collect())
}

/// Change of each unknown if the samples near rests and reversals are left out. The weights and the priors of the offsets
/// stay the same. The change is zero if the runs passed no filter.
pub(super) fn change_at_margin(task: &Task, of: &RigidFit) -> DVector<f64> {
    let mut changes = DVector::zeros(task.layout.len());
    let Some(runs) = runs_away_from_stops(task) else { return changes };
    let sums =
        Task { runs: &runs, ..task.clone() }.weighted(Some((&of.solved.values, &of.offsets, of.outlier)));
    let left = Centred::new(task.layout, &sums, of.chosen.model.offsets, of.chosen.centred.zeros.clone());
    let (active, weights) = (&of.solved.active, of.weights());
    let normal =
        |centred: &Centred| assemble(task.layout, &centred.all, active, &weights, &of.solved.values.gains);
    let (all, left) = (normal(&of.chosen.centred), normal(&left));
    let at =
        DVector::from_iterator(active.len(), active.iter().map(|&global| of.solved.values.unknowns[global]));
    // The constraints of physically possible bodies leave a nonzero score, which is not part of the change.
    let gradient = |normal: &Normal| &normal.linear - &normal.hessian * &at;
    let found = change(
        &of.solved.regularized,
        &(&left.hessian + &of.solved.metric),
        &(gradient(&left) - gradient(&all)),
    );
    active.iter().zip(found.iter()).for_each(|(&global, change)| changes[global] = *change);
    changes
}
