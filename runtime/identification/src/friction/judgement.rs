//! Report on a friction law: its R², its drift over the log, and findings about the described limits.

use super::super::error::Result;
use super::super::methods::stribeck::StribeckWords;
use super::super::numeric::statistics::extremes;
use super::super::result::{FrictionLaw, FrictionResult};
use super::drift::drift;
use super::findings::Findings;
use super::held_out::{HeldOutErrors, variation};
use super::report::FrictionReport;
use super::task::FrictionIdentification;
use nalgebra::DMatrix;

/// A law and its residual.
pub(super) struct LawFit {
    pub(super) law: FrictionLaw,
    pub(super) unseen: Option<HeldOutErrors>,
    /// Residual of each sample: torque minus law.
    pub(super) residuals: Vec<f64>,
    /// Covariance of the law's coefficients.
    pub(super) covariance: DMatrix<f64>,
    /// Degrees of freedom of the standard errors.
    pub(super) freedom: f64,
    pub(super) stribeck: Option<StribeckWords>,
}

impl Findings<'_> {
    /// The report on a law, without the fields that only some methods have.
    pub(super) fn report(
        mut self,
        settings: &FrictionIdentification,
        judged: LawFit,
    ) -> Result<FrictionReport> {
        let data = self.data;
        let whole = 0..judged.residuals.len();
        let rss: f64 = judged.residuals.iter().map(|r| r * r).sum();
        let total = variation(data, &[whole]);
        let held_out = judged.unseen.as_ref().and_then(|unseen| unseen.r_squared(0.0));
        self.judge(held_out, settings.least_r_squared);
        self.judge_unseen_speeds(&judged.law, data.fastest())?;
        let rms = (total / judged.residuals.len() as f64).sqrt();
        self.all.extend(drift(data, &judged.law, &judged.residuals, rms)?);
        let [settings, findings] = self.parts();
        let result = FrictionResult {
            joint: data.joint.into(),
            unit: data.unit.into(),
            velocity_unit: data.velocity_unit.into(),
            law: judged.law,
            stribeck: judged.stribeck,
            samples: judged.residuals.len(),
            freedom: judged.freedom,
            velocity_range: extremes(data.velocities.iter().copied()),
            resolved_from: data.filtered.map(|_| data.resolved_from()),
            residual: (rss / judged.residuals.len() as f64).sqrt(),
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
