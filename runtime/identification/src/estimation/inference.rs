//! The covariance of a fit to samples, and what it needs.

use super::super::error::Result;
use super::super::run::PreparedRun;
use super::choice::Chosen;
use super::fit::{Solved, fit};
use super::intervals::{Covariance, Fitted, correlation_time, covariance, offset_errors, scores};
use super::margin::change_at_margin;
use super::residuals::{Forces, RunOffsets};
use super::task::Task;
use nalgebra::DVector;

/// A fit with its covariance.
pub(super) struct Inferred {
    pub(super) solved: Solved,
    pub(super) offsets: RunOffsets,
    pub(super) offset_errors: RunOffsets,
    pub(super) forces: Forces,
    /// Samples after which residuals forget, the most of all joints.
    pub(super) time: f64,
    /// Change of each unknown without the samples near rests and reversals.
    pub(super) margin: DVector<f64>,
    pub(super) covariance: Covariance,
}

impl Task<'_> {
    /// - `outlier`: deviations beyond which samples lose weight; infinite without
    pub(super) fn inferred(&self, last: &Chosen, outlier: &[f64]) -> Result<Inferred> {
        let Chosen { centred, model, weighting, values, log_gains } = last;
        let solved = fit(centred, &centred.all, model, self.prior, weighting, values)?;
        let (values, joints) = (&solved.values, 0..self.layout.joints);
        let offsets: RunOffsets = joints.clone().map(|j| centred.offsets(values, j)).collect();
        let forces = self.forces(values, &offsets);
        let times = self.correlation_times(&forces);
        let measured = times.iter().zip(&self.layout.measured).filter(|(_, measured)| **measured);
        let time = measured.map(|(time, _)| *time).fold(1.0, f64::max);
        let fitted =
            Fitted { centred, solved: &solved, weighting, values, offsets: &offsets, outlier, log_gains };
        let margin = change_at_margin(self, last, &fitted);
        let scores = scores(&mut self.rows(), self.layout, self.runs, &fitted, time);
        let covariance = covariance(&fitted, self.prior, &scores)?;
        let offset_errors = joints.map(|j| offset_errors(&fitted, self.prior, &covariance, j)).collect();
        Ok(Inferred { offset_errors, forces, time, margin, covariance, offsets, solved })
    }

    /// Samples after which the residual of each joint forgets.
    pub(super) fn correlation_times(&self, forces: &Forces) -> Vec<f64> {
        let time = |j: usize| {
            let of_run = |(run, forces): (&PreparedRun, &Vec<Vec<f64>>)| {
                let stretches = self.layout.stretches(run, j).into_iter();
                stretches.map(|rows| forces[j][rows].to_vec()).collect::<Vec<_>>()
            };
            let series: Vec<Vec<f64>> = self.runs.iter().zip(&forces.residual).flat_map(of_run).collect();
            correlation_time(&series.iter().map(Vec::as_slice).collect::<Vec<_>>())
        };
        (0..self.layout.joints).map(time).collect()
    }
}
