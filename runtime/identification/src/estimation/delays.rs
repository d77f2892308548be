//! Two-stage estimate of unknown delays of the efforts: results of the first fit that the last fit uses.
//!
//! The column of a delay is the rate of an effort. Measured rates contain noise, which makes the estimated delay and its
//! error too small. So only the first fit uses measured rates. The last fit uses the rates of the forces that the first fit
//! predicts, and efforts without the delays of the first fit.

use super::super::numeric::shifted::slope;
use super::super::run::PreparedRun;
use super::layout::Layout;
use super::normal::Values;
use super::residuals::Forces;

/// Results of the first fit that the last fit needs.
pub(super) struct FirstFit {
    /// Delays of the first fit \[s\], one for each index in [`Layout::delays`].
    pub(super) delays: Vec<f64>,
    /// Predicted rates of the efforts at the joints, `[run][joint][sample]`, in units of the effort per second. They contain no
    /// measurement noise. Empty for a joint whose efforts have several delays.
    pub(super) rates: Vec<Vec<Vec<f64>>>,
    /// The runs, with efforts from which the delays of the first fit are removed.
    pub(super) runs: Vec<PreparedRun>,
}

impl FirstFit {
    /// Rates of the efforts and runs without the delays that the first fit estimated.
    ///
    /// - `values`, `forces`: results of the first fit
    pub(super) fn new(layout: &Layout, runs: &[PreparedRun], values: &Values, forces: &Forces) -> Self {
        let left = |number: usize| values.unknowns[layout.delay(number)];
        let delays: Vec<f64> = (0..layout.delay_count()).map(left).collect();
        let of_efforts: Vec<f64> = layout.delays.iter().map(|number| delays[*number]).collect();
        Self {
            rates: rates(layout, runs, values, forces),
            runs: runs.iter().map(|run| run.clone().without_delays(&of_efforts)).collect(),
            delays,
        }
    }
}

/// Rates of the forces that a fit predicts along runs, as in [`FirstFit::rates`].
pub(super) fn rates(
    layout: &Layout,
    runs: &[PreparedRun],
    values: &Values,
    forces: &Forces,
) -> Vec<Vec<Vec<f64>>> {
    let of_joint = |number: usize, joint: usize| -> Vec<f64> {
        if layout.delays_of[joint].len() != 1 {
            return Vec::new();
        }
        let pairs = forces.measured[number][joint].iter().zip(&forces.residual[number][joint]);
        let predicted: Vec<f64> = pairs.map(|(measured, residual)| measured - residual).collect();
        let unit = runs[number].step() * values.gains[joint];
        (0..predicted.len()).map(|i| slope(&predicted, i) / unit).collect()
    };
    let of_run = |number| (0..layout.joints).map(|joint| of_joint(number, joint)).collect();
    (0..runs.len()).map(of_run).collect()
}
