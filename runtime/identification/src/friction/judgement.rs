//! Report on a friction law: its R², its drift over the log, and findings about the described limits.

use super::super::error::Result;
use super::super::methods::stribeck::StribeckWords;
use super::super::numeric::statistics::{extremes, largest};
use super::super::result::{FrictionLaw, FrictionResult};
use super::drift::drift;
use super::errors::Errors;
use super::findings::Findings;
use super::held_out::{HeldOutErrors, variation};
use super::report::FrictionReport;
use super::task::{FrictionData, FrictionIdentification};
use nalgebra::DMatrix;

/// A law, its fit to the data, and its errors.
pub(super) struct LawFit {
    pub(super) law: FrictionLaw,
    pub(super) unseen: Option<HeldOutErrors>,
    /// Residual of each sample: torque minus law. Empty without samples.
    pub(super) residuals: Vec<f64>,
    pub(super) samples: usize,
    /// Σ r² of the residuals r, and Σ (τ − τ̄)² of the torques τ with their mean τ̄.
    pub(super) squares: [f64; 2],
    /// Sum of squares that outliers add to both sums ([`super::shares::SharedFriction`]).
    pub(super) lost: f64,
    /// Lowest and highest velocity.
    pub(super) velocity_range: [f64; 2],
    /// Covariance of the law's coefficients.
    pub(super) covariance: DMatrix<f64>,
    /// Degrees of freedom of the standard errors.
    pub(super) freedom: f64,
    pub(super) stribeck: Option<StribeckWords>,
}

impl LawFit {
    pub(super) fn of_samples(
        data: &FrictionData,
        law: FrictionLaw,
        unseen: Option<HeldOutErrors>,
        residuals: Vec<f64>,
        errors: Errors,
    ) -> Self {
        let (samples, whole) = (residuals.len(), 0..residuals.len());
        Self {
            law,
            unseen,
            samples,
            squares: [residuals.iter().map(|r| r * r).sum(), variation(data, &[whole])],
            residuals,
            lost: 0.0,
            velocity_range: extremes(data.velocities.iter().copied()),
            covariance: errors.covariance,
            freedom: errors.freedom,
            stribeck: None,
        }
    }
}

impl Findings<'_> {
    /// The report on a law, without the fields that only some methods have.
    pub(super) fn report(
        mut self,
        settings: &FrictionIdentification,
        judged: LawFit,
    ) -> Result<FrictionReport> {
        let data = self.data;
        let [rss, total] = judged.squares.map(|squares| squares + judged.lost);
        let held_out = judged.unseen.as_ref().and_then(|unseen| unseen.r_squared(judged.lost));
        self.judge(held_out, settings.least_r_squared);
        self.judge_unseen_speeds(&judged.law, largest(&judged.velocity_range))?;
        let [residual, rms] = [rss, total].map(|squares| (squares / judged.samples.max(1) as f64).sqrt());
        if !judged.residuals.is_empty() {
            self.all.extend(drift(data, &judged.law, &judged.residuals, rms)?);
        }
        let [settings, findings] = self.parts();
        let result = FrictionResult {
            joint: data.joint.into(),
            unit: data.unit.into(),
            velocity_unit: data.velocity_unit.into(),
            law: judged.law,
            stribeck: judged.stribeck,
            samples: judged.samples,
            freedom: judged.freedom,
            velocity_range: judged.velocity_range,
            resolved_from: data.filtered.map(|_| data.resolved_from()),
            residual,
            r_squared: if total > 0.0 { 1.0 - rss / total } else { 1.0 },
            held_out,
            data: data.data.into(),
            settings,
            findings,
            ..FrictionResult::default()
        };
        let unseen_error = judged.unseen.as_ref().map(HeldOutErrors::error);
        Ok(FrictionReport {
            result,
            unseen_error,
            residuals: judged.residuals,
            covariance: judged.covariance,
            ..FrictionReport::default()
        })
    }
}
