//! The friction law of one joint from sums of products, if the samples are not available. There is one set of sums for each
//! share, which is an independent group of samples of many logs.

use super::super::error::Result;
use super::super::methods::least_squares::Reduced;
use super::super::methods::library::Library;
use super::super::methods::moments::Moments;
use super::errors::Errors;
use super::findings::Findings;
use super::held_out::held_out;
use super::judgement::LawFit;
use super::report::FrictionReport;
use super::selection::FrictionMethod;
use super::task::{FrictionData, FrictionIdentification};
use super::terms::{Candidates, probabilities};

/// Friction data of one joint without its samples.
#[derive(Debug, Clone)]
pub(crate) struct SharedFriction<'a> {
    /// Name, units, limits, source and settings. The samples are empty.
    pub(crate) about: FrictionData<'a>,
    /// For each share, the sums of products of the columns of terms and torque, without the offsets of the runs. The terms
    /// are those of a library in `v`.
    pub(crate) shares: Vec<Moments>,
    /// Sum of squares that the reduced weights w of outliers remove: Σ (1 − w) r² with the residual r. This sum is added to
    /// the residual and to the variation of the torque, because the torque of an outlier is mostly its residual.
    pub(crate) lost: f64,
    /// Lowest and highest velocity ẏ [rad/s or m/s].
    pub(crate) velocity_range: [f64; 2],
}

impl FrictionIdentification {
    /// Identifies the law of one joint as [`Self::identify`] does. The shares are the folds of the cross-validation and the
    /// blocks of the standard errors. Drift, residuals and offsets are left out of the result, because they need samples.
    ///
    /// # Errors
    /// The errors are those of [`Self::identify`].
    pub(crate) fn identify_shares(&self, data: &SharedFriction) -> Result<FrictionReport> {
        let reduced = Reduced::from_moments(Moments::sum(&data.shares)?)?;
        let library = Library::new(reduced.moments().names(), &["v"])?;
        let mut findings = Findings::new(&data.about);
        findings.note_library(&library, " in addition to the offset of each run", reduced.condition());
        let shares = || Ok(data.shares.clone());
        let candidates = Candidates {
            library: &library,
            reduced: &reduced,
            folds: &shares,
            velocity_range: data.velocity_range,
        };
        if matches!(self.method, FrictionMethod::Ladder(_)) {
            findings.note(
                "the Stribeck law was not tried, because a file of moments does not contain the single samples",
            );
        }
        let fitted = candidates.fitted(self, &mut findings)?;
        let (coefficients, active) = (&fitted.solution.coefficients, &fitted.solution.active);
        let errors = Errors::of_shares(&reduced, &data.shares, coefficients, active, &fitted.binding);
        let probable = probabilities(&reduced, &errors)?;
        let total: f64 = data.shares.iter().map(|share| share.energy(0)).sum();
        let unseen = held_out(shares(), total, fitted.way(), &mut findings);
        let moments = reduced.moments();
        let judged = LawFit {
            law: fitted.law(&library, &errors, probable.as_ref()),
            unseen,
            residuals: Vec::new(),
            samples: moments.samples(),
            squares: [moments.residual(0, coefficients), moments.energy(0)],
            lost: data.lost,
            velocity_range: data.velocity_range,
            covariance: errors.covariance,
            freedom: errors.freedom,
            stribeck: None,
        };
        let report = findings.report(self, judged)?;
        Ok(fitted.complete(report, &candidates, probable))
    }
}
