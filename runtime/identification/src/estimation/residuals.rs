//! A pass along the runs with given values: residuals, predictions, outliers, and the blocks' scores.

use super::super::kernel::BLOCK;
use super::super::run::PreparedRun;
use super::layout::{ARMATURE, LOAD, Layout};
use super::normal::{Values, residual_vector};
use super::rows::Rows;
use nalgebra::DVector;

/// Multiples of the deviation beyond which a sample loses weight (Huber 1964): 99.9 % efficient for normal
/// errors. Friction at reversals has heavy tails that are no outliers; smaller multiples forget it.
const HUBER: f64 = 2.5;

/// Forces of every joint along every run, `[run][joint][sample]`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Forces {
    pub(super) measured: Vec<Vec<Vec<f64>>>,
    pub(super) residual: Vec<Vec<Vec<f64>>>,
    /// What the rigid body needs, and what it would need as described.
    pub(super) rigid: Vec<Vec<Vec<f64>>>,
    pub(super) described: Vec<Vec<Vec<f64>>>,
    /// Friction under load; zeros where there is none.
    pub(super) load: Vec<Vec<Vec<f64>>>,
}

/// Offsets of each joint and run, `[joint][run]`.
pub(super) type RunOffsets = Vec<Vec<f64>>;

/// Residual of one joint over a block, offset removed.
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
            rows.evaluate(samples, start..samples.times.len().min(start + BLOCK));
            for joint in 0..layout.joints {
                let columns = rows.joint(joint);
                found.residual[run][joint].extend(residual(&factors[joint], offsets[joint][run], &columns));
                let gain = values.gains[joint];
                let measured = columns.last().map_or(&[][..], |z| z);
                found.measured[run][joint].extend(measured.iter().map(|z| gain * z));
                found.described[run][joint].extend(columns[columns.len() - 2]);
                found.rigid[run][joint].extend(rigid(layout, joint, &factors[joint], &columns));
                found.load[run][joint].extend(under_load(layout, joint, &factors[joint], &columns));
            }
        }
    }
    found
}

/// `W π` with all of the description's other forces: the rigid force and its change.
fn rigid(layout: &Layout, joint: usize, factors: &DVector<f64>, columns: &[&[f64]]) -> Vec<f64> {
    let mut only = factors.map(|_| 0.0);
    for (k, &global) in layout.local[joint].iter().enumerate() {
        let inertial = global < layout.parameters || global == layout.term(joint, ARMATURE);
        only[k] = if inertial { -factors[k] } else { 0.0 };
    }
    only[layout.local[joint].len()] = 1.0;
    residual(&only, 0.0, columns)
}

/// Friction under load, where the layout has it.
fn under_load(layout: &Layout, joint: usize, factors: &DVector<f64>, columns: &[&[f64]]) -> Vec<f64> {
    let place = layout.first_term(joint) + LOAD;
    let has = layout.terms > LOAD;
    let columns = columns[place..].iter().take(usize::from(has));
    columns.flat_map(|column| column.iter().map(|x| -factors[place] * x)).collect()
}

/// Weights of a joint's samples: 1, or the bound over the residual beyond it.
pub(crate) fn huber(residual: &[f64], deviation: f64) -> Vec<f64> {
    let bound = HUBER * deviation;
    residual.iter().map(|r| if r.abs() > bound { bound / r.abs() } else { 1.0 }).collect()
}

/// Deviation of each joint's residuals from their median, by the median: outliers do not move it.
pub(super) fn robust_deviations(forces: &Forces) -> Vec<f64> {
    let joints = forces.residual.first().map_or(0, Vec::len);
    let deviation = |j: usize| {
        let mut sizes: Vec<f64> =
            forces.residual.iter().flat_map(|run| run[j].iter().map(|r| r.abs())).collect();
        let middle = sizes.len() / 2;
        let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
        (1.4826 * *median).max(f64::MIN_POSITIVE)
    };
    (0..joints).map(deviation).collect()
}
