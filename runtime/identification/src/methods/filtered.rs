//! Columns of the friction regression after the filter of the torques.
//!
//! Friction jumps when a joint reverses, and the filter has rounded this jump in the torques. Least squares stays consistent
//! if the terms pass the same filter (Gautier 1997, parallel filtering).

use super::super::error::Result;
use super::filter::Filter;
use super::margin::near;
use nalgebra::DMatrix;

/// The filter of the torques, and the complete runs from which the samples were taken.
#[derive(Debug, Clone)]
pub(crate) struct Filtered<'a> {
    /// Filter of the torques.
    pub(crate) filter: &'a Filter,
    /// Runs in the order of the samples.
    pub(crate) runs: Vec<FilteredRun<'a>>,
}

/// A run from which samples were taken.
#[derive(Debug, Clone)]
pub(crate) struct FilteredRun<'a> {
    /// ẏ at all times of the run, with equal steps.
    pub(crate) velocities: &'a [f64],
    /// Indices of the samples among these times, ascending.
    pub(crate) kept: Vec<usize>,
}

impl Filtered<'_> {
    /// For each sample, whether a rest or a reversal is within the reach of the filter. Rests are not samples.
    pub(crate) fn near(&self) -> Vec<bool> {
        let of_run = |run: &FilteredRun| {
            let mut rests = vec![true; run.velocities.len()];
            run.kept.iter().for_each(|i| rests[*i] = false);
            let near = near(run.velocities, |i| rests[i], self.filter.half_length());
            run.kept.iter().map(|i| near[*i]).collect::<Vec<_>>()
        };
        self.runs.iter().flat_map(of_run).collect()
    }

    /// Columns of a matrix over the velocities of each run, filtered, at the samples.
    pub(crate) fn columns(&self, of: impl Fn(&[f64]) -> Result<DMatrix<f64>>) -> Result<Vec<Vec<f64>>> {
        let mut all: Vec<Vec<f64>> = Vec::new();
        for run in &self.runs {
            let matrix = of(run.velocities)?;
            all.resize(matrix.ncols(), Vec::new());
            for (column, values) in all.iter_mut().zip(matrix.column_iter()) {
                column.extend(self.pass(run, &values.iter().copied().collect::<Vec<_>>()));
            }
        }
        Ok(all)
    }

    /// A column over the times of a run, filtered, at its samples.
    pub(crate) fn pass(&self, run: &FilteredRun, column: &[f64]) -> Vec<f64> {
        // Derivatives of a law with respect to parameters on which it does not depend are zero.
        if column.iter().all(|value| *value == 0.0) {
            return vec![0.0; run.kept.len()];
        }
        self.filter.apply_at(column, run.kept.iter().copied())
    }
}
