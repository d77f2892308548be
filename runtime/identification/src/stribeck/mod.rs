//! Regression of the five-parameter Stribeck law `τ = a1 v + a2 tanh(a3 v) + a4 exp(−a5 |v|) tanh(3 a3 v)`, beside a
//! constant offset of each run.
//!
//! Starts are found on binned data, where (a1, a2, a4) and an offset follow from (a3, a5) by linear least squares
//! and Levenberg–Marquardt costs microseconds; the best one is refined on all samples with one pass per
//! iteration. Offsets are eliminated from the normal equations (Golub, Pereyra 1973): they are free, cost no
//! iteration, and the law stays odd.

mod bins;
mod errors;
mod refine;
#[cfg(test)]
mod tests;
mod words;

pub use words::{Estimate, StribeckWords};

use super::error::{
    IdentificationError, Result, require_finite, require_length, require_samples, require_setting,
};
use super::kernel::{BLOCK, stribeck_block};
use bins::Bins;
use errors::summarize;
use nalgebra::{SMatrix, SVector};
use refine::{Data, NEAR};
use std::ops::Range;

pub(super) const NAMES: [&str; 5] = ["a1", "a2", "a3", "a4", "a5"];

/// The law's value at velocity `v` [N·m or N].
pub fn stribeck_torque(v: f64, a: &[f64; 5]) -> f64 {
    a[0] * v + a[1] * (a[2] * v).tanh() + a[3] * (-a[4] * v.abs()).exp() * (3.0 * a[2] * v).tanh()
}

/// The law's derivatives by a1 … a5 at velocity `v`.
pub fn stribeck_gradient(v: f64, a: &[f64; 5]) -> [f64; 5] {
    let mut columns = [[0.0; BLOCK]; 6];
    stribeck_block(&[v], &[0.0], a, &mut columns);
    std::array::from_fn(|i| columns[i][0])
}

/// Weights against outliers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Robustness {
    /// Least squares.
    None,
    /// Huber's weights `min(1, k s/|r|)`; k = 1.345 keeps 95 % of the efficiency under normal errors.
    Huber(f64),
}

/// Settings of the regression.
#[derive(Debug, Clone, PartialEq)]
pub struct StribeckRegression {
    /// How many of the best starts are refined on the binned data.
    pub starts: usize,
    /// Whether each run has a constant torque beside the law.
    pub offset: bool,
    /// Weights against outliers.
    pub robustness: Robustness,
    /// Limit of the passes over all samples, for each set of weights.
    pub max_iterations: usize,
    /// The refinement ends when a step lowers the cost by less than this share.
    pub tolerance: f64,
}

impl Default for StribeckRegression {
    fn default() -> Self {
        Self { starts: 5, offset: true, robustness: Robustness::None, max_iterations: 100, tolerance: 1e-13 }
    }
}

/// Result of the regression.
#[derive(Debug, Clone, PartialEq)]
pub struct StribeckFit {
    /// a1 … a5 [N·m·s/rad, N·m, s/rad, N·m, s/rad].
    pub parameters: [f64; 5],
    /// The constant torque of each run; none where the regression has none.
    pub offsets: Vec<f64>,
    /// Covariance of the parameters for independent errors, or for correlated ones after
    /// [`Self::with_correlated_errors`]; rows and columns of parameters that are not identifiable are zero, see
    /// [`Self::standard_errors`].
    pub covariance: SMatrix<f64, 5, 5>,
    /// Standard errors; `None` where a parameter is not identifiable from these data.
    pub standard_errors: [Option<f64>; 5],
    /// Standard errors if all other parameters were known.
    pub resolutions: [Option<f64>; 5],
    /// Residual variance σ² [(N·m)²].
    pub variance: f64,
    /// Degrees of freedom.
    pub freedom: usize,
    /// Condition number of the sensitivities, columns scaled.
    pub condition: f64,
    /// Passes over all samples.
    pub iterations: usize,
    /// Whether the iteration reached its tolerance; if not, a warning says so.
    pub converged: bool,
    /// Doubts about the parameters, with numbers.
    pub warnings: Vec<String>,
    /// JᵀWJ at the result, offsets eliminated.
    information: SMatrix<f64, 5, 5>,
}

impl StribeckRegression {
    /// Fits the law to a single run.
    ///
    /// - `velocities`, `torques`: m samples [rad/s, N·m]; `weights`: m or none
    ///
    /// # Errors
    /// As [`Self::fit_runs`].
    pub fn fit(&self, velocities: &[f64], torques: &[f64], weights: Option<&[f64]>) -> Result<StribeckFit> {
        let whole = 0..velocities.len();
        self.fit_runs(velocities, torques, weights, &[whole])
    }

    /// Fits one law to several runs, each with an offset of its own.
    ///
    /// - `velocities`, `torques`: m samples [rad/s, N·m]; `weights`: m or none
    /// - `runs`: ranges of samples that follow each other and hold all
    ///
    /// # Errors
    /// Fewer than six samples, values that are not finite, or constant velocity. Parameters that run away end
    /// with a warning.
    pub fn fit_runs(
        &self,
        velocities: &[f64],
        torques: &[f64],
        weights: Option<&[f64]>,
        runs: &[Range<usize>],
    ) -> Result<StribeckFit> {
        self.check(velocities, torques, weights)?;
        let covered = runs.iter().try_fold(0, |end, run| (run.start == end).then_some(run.end));
        require_length("samples in the runs", velocities.len(), covered.unwrap_or(0))?;
        let data = Data { v: velocities, torque: torques, runs, offset: self.offset };
        let bins = Bins::new(&data, weights);
        let (start, offset) = bins.best_start(self.starts.max(1))?;
        let offsets = bins.offsets(offset);
        let mut state = data.refine(start, offsets, weights, self, NEAR);
        if let Robustness::Huber(k) = self.robustness {
            state = data.reweighted(state, weights, k, self);
        }
        Ok(summarize(&data, &state))
    }

    /// Parameters of a fit to samples with other weights that begins at a known law; outliers are not sought again.
    pub(crate) fn refit(
        &self,
        known: &StribeckFit,
        velocities: &[f64],
        torques: &[f64],
        weights: &[f64],
        runs: &[Range<usize>],
    ) -> [f64; 5] {
        let data = Data { v: velocities, torque: torques, runs, offset: self.offset };
        let offsets = if self.offset { known.offsets.clone() } else { vec![0.0; runs.len()] };
        data.refine(known.parameters, offsets, Some(weights), self, NEAR).a
    }

    fn check(&self, v: &[f64], torque: &[f64], weights: Option<&[f64]>) -> Result<()> {
        require_samples("the Stribeck law with five parameters", 6, v.len())?;
        require_length("torques", v.len(), torque.len())?;
        require_finite("the velocity", v)?;
        require_finite("the torque", torque)?;
        if let Some(weights) = weights {
            require_length("weights", v.len(), weights.len())?;
            require_finite("the weights", weights)?;
            let least = weights.iter().fold(f64::INFINITY, |a, b| a.min(*b));
            require_setting("least weight", least, least >= 0.0, "weights must not be negative")?;
        }
        if let Robustness::Huber(k) = self.robustness {
            require_setting("Huber's k", k, k > 0.0, "it must be positive")?;
        }
        if v.iter().all(|x| *x == v[0]) {
            return Err(IdentificationError::Constant {
                what: "the velocity".into(),
                value: v[0],
                samples: v.len(),
            });
        }
        Ok(())
    }
}

impl StribeckFit {
    /// The law at velocity `v`, without an offset.
    pub fn torque(&self, v: f64) -> f64 {
        stribeck_torque(v, &self.parameters)
    }

    /// Confidence interval of each parameter at `level` (e.g. 0.95); `None` where not identifiable.
    ///
    /// # Errors
    /// A level outside (0, 1).
    pub fn confidence_intervals(&self, level: f64) -> Result<[Option<[f64; 2]>; 5]> {
        let t = self.quantile(level)?;
        Ok(std::array::from_fn(|i| {
            self.standard_errors[i].map(|s| [self.parameters[i] - t * s, self.parameters[i] + t * s])
        }))
    }

    /// Half widths at velocity `v`: of the confidence band of the law, and of the prediction band of a new
    /// sample without its offset.
    ///
    /// # Errors
    /// A level outside (0, 1).
    pub fn half_widths(&self, v: f64, level: f64) -> Result<[f64; 2]> {
        let t = self.quantile(level)?;
        let g = SVector::<f64, 5>::from(stribeck_gradient(v, &self.parameters));
        let law = g.dot(&(self.covariance * g)).max(0.0);
        Ok([t * law.sqrt(), t * (law + self.variance).sqrt()])
    }

    /// The law as coefficients of expressions in `v`, as friction terms of a description.
    pub fn terms(&self) -> Vec<(String, f64)> {
        let [a1, a2, a3, a4, a5] = self.parameters;
        vec![
            ("v".into(), a1),
            (format!("tanh({a3:?}*v)"), a2),
            (format!("exp(-{a5:?}*abs(v))*tanh({:?}*v)", 3.0 * a3), a4),
        ]
    }

    fn quantile(&self, level: f64) -> Result<f64> {
        super::confidence::quantile(level, self.freedom.max(1) as f64)
    }
}
