//! Columns of the friction regression that pass the filter of the torques.
//!
//! Friction jumps when a joint reverses, and the filter has smoothed this jump in the torques. Least squares stays
//! consistent if the terms pass the same filter (parallel filtering, Gautier 1997).

use super::super::error::Result;
use super::filter::Filter;
use super::margin::near;
use nalgebra::DMatrix;

/// Filter of the torques, and the complete runs from which the samples were taken.
#[derive(Debug, Clone)]
pub(crate) struct Filtered<'a> {
    /// Filter of the torques.
    pub(crate) filter: &'a Filter,
    /// Runs in the order of the samples.
    pub(crate) runs: Vec<FilteredRun<'a>>,
}

/// A run of which some samples are used in the fit.
#[derive(Debug, Clone)]
pub(crate) struct FilteredRun<'a> {
    /// Velocities ẏ at all times of the run, with equal time steps.
    pub(crate) velocities: &'a [f64],
    /// Indices of the samples among these times, in ascending order.
    pub(crate) kept: Vec<usize>,
}

impl Filtered<'_> {
    /// Returns for each sample whether a rest or a reversal is within the reach of the filter. Times at rest are not
    /// samples.
    pub(crate) fn near(&self) -> Vec<bool> {
        let of_run = |run: &FilteredRun| {
            let mut rests = vec![true; run.velocities.len()];
            run.kept.iter().for_each(|i| rests[*i] = false);
            let near = near(run.velocities, |i| rests[i], self.filter.half_length());
            run.kept.iter().map(|i| near[*i]).collect::<Vec<_>>()
        };
        self.runs.iter().flat_map(of_run).collect()
    }

    /// Returns the filtered columns of a matrix at the samples. The matrix is computed from the velocities of each run.
    ///
    /// - `of`: function that returns the matrix for given velocities
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

    /// Filters a column over the times of a run, and returns its values at the samples.
    pub(crate) fn pass(&self, run: &FilteredRun, column: &[f64]) -> Vec<f64> {
        // Derivatives with respect to parameters without influence are zero.
        if column.iter().all(|value| *value == 0.0) {
            return vec![0.0; run.kept.len()];
        }
        self.filter.apply_at(column, run.kept.iter().copied())
    }
}
