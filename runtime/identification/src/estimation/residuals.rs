//! Measured, modelled and residual forces along the runs, robust deviations, and weights of outliers.

use super::super::numeric::kernel::BLOCK;
use super::super::numeric::statistics::median;
use super::super::run::PreparedRun;
use super::layout::{ARMATURE, LOAD, Layout};
use super::levels;
use super::normal::{Values, residual_vector};
use super::rows::Rows;
use nalgebra::DVector;

/// Ratio of the standard deviation of normal errors to the median of their magnitudes.
const FROM_MEDIAN: f64 = 1.4826;

/// Forces of every joint along every run, `[run][joint][sample]` [N·m or N].
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Forces {
    pub(super) measured: Vec<Vec<Vec<f64>>>,
    pub(super) residual: Vec<Vec<Vec<f64>>>,
    /// Forces of the rigid body with the estimated inertial parameters.
    pub(super) rigid: Vec<Vec<Vec<f64>>>,
    /// Forces of the rigid body with the described inertial parameters.
    pub(super) described: Vec<Vec<Vec<f64>>>,
    /// Load-dependent friction; empty if the layout does not have this term.
    pub(super) load: Vec<Vec<Vec<f64>>>,
}

impl Forces {
    /// Indices of the runs and samples that are used for a joint: the samples at which it does not rest.
    pub(super) fn moving<'a>(
        &self,
        layout: &'a Layout,
        runs: &'a [PreparedRun],
        joint: usize,
    ) -> impl Iterator<Item = (usize, usize)> + 'a {
        let of_run = move |(number, run): (usize, &'a PreparedRun)| {
            run.stretches(joint, layout.moves[joint])
                .into_iter()
                .flatten()
                .map(move |sample| (number, sample))
        };
        runs.iter().enumerate().flat_map(of_run)
    }
}

/// Offsets of each joint and run, `[joint][run]`.
pub(super) type RunOffsets = Vec<Vec<f64>>;

/// Residual of one joint over a block of samples, after the offset is subtracted.
pub(super) fn residual(factors: &DVector<f64>, offset: f64, columns: &[&[f64]]) -> Vec<f64> {
    let mut residual = vec![-offset; columns.first().map_or(0, |c| c.len())];
    for (factor, column) in factors.iter().zip(columns).filter(|(factor, _)| **factor != 0.0) {
        residual.iter_mut().zip(*column).for_each(|(r, x)| *r += factor * x);
    }
    residual
}

pub(super) fn forces(
    rows: &mut Rows,
    layout: &Layout,
    runs: &[PreparedRun],
    values: &Values,
    offsets: &RunOffsets,
) -> Forces {
    let empty = || vec![vec![Vec::new(); layout.joints]; runs.len()];
    let mut found =
        Forces { measured: empty(), residual: empty(), rigid: empty(), described: empty(), load: empty() };
    let factors: Vec<_> = (0..layout.joints).map(|j| residual_vector(layout, values, j)).collect();
    for (run, samples) in runs.iter().enumerate() {
        for start in (0..samples.times.len()).step_by(BLOCK) {
            rows.evaluate((run, samples), start..samples.times.len().min(start + BLOCK));
            for joint in 0..layout.joints {
                let (columns, factors) = (rows.joint(joint), &factors[joint]);
                let count = factors.len();
                let part = |factor: &dyn Fn(usize, Option<usize>) -> f64| {
                    let factor = |k: usize, _| factor(k, layout.local[joint].get(k).copied());
                    residual(&DVector::from_fn(count, factor), 0.0, &columns)
                };
                found.residual[run][joint].extend(residual(factors, offsets[joint][run], &columns));
                // The measured force at the time of the motion is `K (z + δ ż)` with the gain K, the measured effort z and the
                // delay δ.
                found.measured[run][joint].extend(part(&|k, global| match global {
                    Some(global) if layout.is_delay(global) => factors[k],
                    None if k + 1 == count => factors[k],
                    _ => 0.0,
                }));
                found.described[run][joint].extend(columns[count - 2]);
                // Rigid-body force with the estimated parameters, including reflected inertia and all non-inertial forces of
                // the description.
                let armature = layout.term(joint, ARMATURE);
                found.rigid[run][joint].extend(part(&|k, global| match global {
                    Some(global) if global < layout.parameters || global == armature => -factors[k],
                    None if k + 2 == count => 1.0,
                    _ => 0.0,
                }));
                if layout.terms > LOAD {
                    let load = layout.first_term(joint) + LOAD;
                    found.load[run][joint].extend(columns[load].iter().map(|x| -factors[load] * x));
                }
            }
        }
    }
    found
}

/// Huber's weights of a joint's samples: 1, or bound / |residual| if the magnitude of the residual exceeds the bound. The bound
/// is a multiple of `deviation`, the standard deviation of the residuals.
pub(crate) fn huber(residual: &[f64], deviation: f64) -> Vec<f64> {
    let bound = levels::HUBER.get() * deviation;
    residual.iter().map(|r| if r.abs() > bound { bound / r.abs() } else { 1.0 }).collect()
}

/// [`robust_deviation`] of each joint over the samples in which it moves.
pub(super) fn robust_deviations(layout: &Layout, runs: &[PreparedRun], forces: &Forces) -> Vec<f64> {
    let sizes =
        |j: usize| forces.moving(layout, runs, j).map(move |(run, i)| forces.residual[run][j][i].abs());
    (0..layout.joints).map(|j| robust_deviation(sizes(j))).collect()
}

/// Standard deviation of residuals, estimated from the median of their magnitudes, which is insensitive to outliers;
/// infinite if there are no residuals.
pub(crate) fn robust_deviation(sizes: impl Iterator<Item = f64>) -> f64 {
    median(sizes).map_or(f64::INFINITY, |median| (FROM_MEDIAN * median).max(f64::MIN_POSITIVE))
}
