//! The friction law of one joint, from samples of its velocity and friction torque, with the numbers that show its quality.
//!
//! [`FrictionIdentification::identify`] works in these steps:
//! - Terms that the velocities do not distinguish are left out (`design`).
//! - Terms are chosen by a [`FrictionMethod`] and fitted by least squares (`selection`, `terms`). The coefficients are those
//!   of this fit, never the shrunk values of the LASSO.
//! - Standard errors of the coefficients take correlated residuals into account (`methods::confidence`).
//! - The law is tested on held-out data (`judgement`).

mod columns;
mod common;
mod design;
mod drift;
mod errors;
mod findings;
mod held_out;
pub(crate) mod joint_samples;
mod judgement;
pub(crate) mod levels;
mod named;
mod passivity;
mod report;
mod selection;
mod settings;
mod shares;
mod stribeck;
mod task;
mod terms;
#[cfg(test)]
pub(crate) mod tests;

pub(crate) use super::methods::filtered::{Filtered, FilteredRun};
pub use named::METHODS;
pub use report::{Candidate, FrictionReport};
pub use selection::FrictionMethod;
pub(crate) use settings::{SETTINGS, note_on_direction};
pub(crate) use shares::SharedFriction;
pub use task::{FrictionData, FrictionIdentification, Offsets};

use super::error::{
    Result, require_changing, require_finite, require_length, require_samples, require_setting,
};

impl FrictionIdentification {
    /// Identifies the friction law of one joint.
    ///
    /// If the law explains too little of held-out data, the call does not fail. The result then contains a
    /// [refusal](super::result::FrictionResult::refusals).
    ///
    /// # Errors
    /// - [`Empty`](crate::IdentificationError::Empty), [`TooFewSamples`](crate::IdentificationError::TooFewSamples):
    ///   fewer samples than the method needs
    /// - [`Shape`](crate::IdentificationError::Shape), [`NotFinite`](crate::IdentificationError::NotFinite): lengths that
    ///   differ, or values that are not finite
    /// - [`Constant`](crate::IdentificationError::Constant): a velocity that never changes
    /// - [`Setting`](crate::IdentificationError::Setting): a setting out of its range, or runs that overlap or leave gaps
    /// - [`Collinear`](crate::IdentificationError::Collinear), [`ZeroColumn`](crate::IdentificationError::ZeroColumn),
    ///   [`EverythingRemoved`](crate::IdentificationError::EverythingRemoved): terms that are collinear or zero, or a
    ///   threshold or λ that removes every term
    /// - other errors of the chosen [`FrictionMethod`]
    pub fn identify(&self, data: &FrictionData) -> Result<FrictionReport> {
        check(data)?;
        let limit = self.least_r_squared;
        require_setting("least R²", limit, limit <= 1.0, "it must be finite and at most 1")?;
        match &self.method {
            FrictionMethod::Stribeck(regression) => stribeck::identify(self, data, regression),
            FrictionMethod::Ladder(regression) => {
                stribeck::or_simpler(self, data, regression, terms::identify(self, data)?)
            }
            _ => terms::identify(self, data),
        }
    }
}

fn check(data: &FrictionData) -> Result<()> {
    let m = data.velocities.len();
    require_samples(&format!("the friction of {}", data.joint), 2, m)?;
    require_length("friction torques", m, data.torques.len())?;
    require_finite(&format!("the velocity of {}", data.joint), data.velocities)?;
    require_finite(&format!("the friction torque of {}", data.joint), data.torques)?;
    check_runs(data, m)?;
    if let Some(filtered) = data.filtered {
        let kept = filtered.runs.iter().map(|run| run.kept.len()).sum();
        require_length(&format!("filtered samples of {}", data.joint), m, kept)?;
    }
    require_changing(&format!("the velocity of {}", data.joint), data.velocities)
}

fn check_runs(data: &FrictionData, samples: usize) -> Result<()> {
    let Some(runs) = data.runs else { return Ok(()) };
    let mut end = 0;
    for run in runs {
        let name = format!("first sample of a run of {}", data.joint);
        let requirement = format!("it must be {end}, because runs must not overlap or leave gaps");
        require_setting(&name, run.start as f64, run.start == end, &requirement)?;
        require_samples(&format!("a run of {}", data.joint), 1, run.len())?;
        end = run.end;
    }
    require_length(&format!("samples in the runs of {}", data.joint), samples, end)
}
