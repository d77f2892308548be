//! Regression of the five-parameter Stribeck law `τ = a1 v + a2 tanh(a3 v) + a4 exp(−a5 |v|) tanh(3 a3 v)` with the
//! velocity v.
//!
//! Starts of the iteration are found on at most 4000 samples. For given (a3, a5), the other parameters follow from
//! linear least squares. The best starts are refined on all samples by the Levenberg–Marquardt method, with one pass over the
//! samples per iteration. If the torques were filtered, the law and its derivatives pass the same filter.

mod errors;
mod law;
mod refine;
mod starts;
#[cfg(test)]
mod tests;
mod words;

pub(crate) use law::{NAMES, slower, stribeck_gradient};
pub use law::{StribeckFit, StribeckRegression, stribeck_torque};
pub(crate) use words::StribeckWords;

use super::super::error::{Result, require_changing, require_finite, require_length, require_samples};
use errors::summarize;
use refine::NEAR;
pub(crate) use refine::Observed;
use starts::search;

impl StribeckRegression {
    /// Fits the law to a single run.
    ///
    /// - `velocities`: velocities of m samples in rad/s or m/s
    /// - `torques`: torques of the samples in N·m or N
    ///
    /// # Errors
    /// - [`TooFewSamples`](crate::IdentificationError::TooFewSamples), [`Empty`](crate::IdentificationError::Empty):
    ///   fewer than six samples
    /// - [`Shape`](crate::IdentificationError::Shape), [`NotFinite`](crate::IdentificationError::NotFinite): lengths that
    ///   differ, or values that are not finite
    /// - [`Constant`](crate::IdentificationError::Constant): a velocity that never changes
    /// - [`NotConverged`](crate::IdentificationError::NotConverged): no start with a finite cost
    pub fn fit(&self, velocities: &[f64], torques: &[f64]) -> Result<StribeckFit> {
        let whole = 0..velocities.len();
        self.fit_runs(&Observed {
            v: velocities,
            torque: torques,
            weights: None,
            runs: &[whole],
            filtered: None,
        })
    }

    /// Fits one law to several runs. Parameters that diverge give a warning.
    ///
    /// # Errors
    /// The errors are those of [`Self::fit`].
    pub(crate) fn fit_runs(&self, samples: &Observed) -> Result<StribeckFit> {
        Self::check(samples.v, samples.torque)?;
        Ok(summarize(samples, &search(samples, self)?))
    }

    /// Fits the law to samples with other weights, from a known law as the start. Returns the parameters a1 … a5.
    pub(crate) fn refit(&self, known: &StribeckFit, samples: &Observed) -> [f64; 5] {
        samples.refine(known.parameters, self, NEAR).a
    }

    fn check(v: &[f64], torque: &[f64]) -> Result<()> {
        require_samples("the Stribeck law with five parameters", 6, v.len())?;
        require_length("torques", v.len(), torque.len())?;
        require_finite("the velocity", v)?;
        require_finite("the torque", torque)?;
        require_changing("the velocity", v)
    }
}
