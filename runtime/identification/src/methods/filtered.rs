//! Columns through the filter that the torques passed.
//!
//! Friction jumps where a joint reverses, and the filter has rounded that in the torques. Least squares stays consistent
//! where the terms pass the same filter (Gautier 1997, parallel filtering).

use super::super::error::Result;
use super::filter::Filter;
use super::margin::near;
use nalgebra::DMatrix;

/// The filter of the torques, and the whole runs that samples were taken of.
#[derive(Debug, Clone)]
pub(crate) struct Filtered<'a> {
    /// The filter.
    pub(crate) filter: &'a Filter,
    /// Runs in the order of the samples.
    pub(crate) runs: Vec<FilteredRun<'a>>,
}

/// A run that samples were taken of.
#[derive(Debug, Clone)]
pub(crate) struct FilteredRun<'a> {
    /// ẏ at all of its instants, evenly in time.
    pub(crate) velocities: &'a [f64],
    /// Which of them are samples, ascending.
    pub(crate) kept: Vec<usize>,
}

impl Filtered<'_> {
    /// Whether the filter of each sample sees a rest, which is left out of the samples, or a reversal.
    pub(crate) fn near(&self) -> Vec<bool> {
        let of_run = |run: &FilteredRun| {
            let mut rests = vec![true; run.velocities.len()];
            run.kept.iter().for_each(|i| rests[*i] = false);
            let near = near(run.velocities, |i| rests[i], self.filter.half_length());
            run.kept.iter().map(|i| near[*i]).collect::<Vec<_>>()
        };
        self.runs.iter().flat_map(of_run).collect()
    }

    /// Columns of a matrix over the velocities of each run, through the filter, at the samples.
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

    /// A column over the instants of a run, through the filter, at its samples.
    pub(crate) fn pass(&self, run: &FilteredRun, column: &[f64]) -> Vec<f64> {
        // As of derivatives of a law by parameters on which it does not depend.
        if column.iter().all(|value| *value == 0.0) {
            return vec![0.0; run.kept.len()];
        }
        self.filter.apply_at(column, run.kept.iter().copied())
    }
}
