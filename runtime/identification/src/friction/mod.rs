//! The friction law of one joint from its velocity and friction torque, with everything that says how far to
//! trust it.
//!
//! Order of work: constant torques are separated (`design`), terms are chosen by one of the
//! [`FrictionMethod`]s and refitted by least squares (`selection`, `terms`), standard errors are taken that hold
//! for correlated residuals ([`super::confidence`]), and the law is judged on data that were left out
//! (`judgement`). The printed coefficients are those of the refit, never values that the LASSO has shrunk; the
//! standard errors belong to them.

mod dependence;
mod design;
mod drift;
mod errors;
mod held_out;
mod judgement;
mod load;
mod selection;
mod shares;
mod stribeck;
mod terms;
#[cfg(test)]
mod tests;

pub(crate) use design::centre;
pub use drift::{Drift, Trend};
pub use load::LoadFriction;
pub(crate) use shares::SharedFriction;

use super::cross_validation::{CrossValidation, ParetoPoint};
use super::ensemble::Ensemble;
use super::error::{
    IdentificationError, Result, require_finite, require_length, require_samples, require_setting,
};
use super::lasso::Lasso;
use super::library::Library;
use super::result::FrictionResult;
use super::robot::JointLimits;
use super::stribeck::StribeckRegression;
use super::subset::{ModelAverage, SubsetValidation};
use super::thresholding::Thresholding;
use nalgebra::DMatrix;
use std::ops::Range;

/// Least R² on data that were left out of a law that may be written. Below 0.05 the law takes away less than
/// 2.6 % of the torque's root mean square: as a feed-forward it changes nothing that could be measured, and
/// its terms mean nothing.
pub const LEAST_R_SQUARED: f64 = 0.05;

/// Friction samples of one joint.
#[derive(Debug, Clone, Default)]
pub struct FrictionData<'a> {
    /// Name of the joint in the description.
    pub joint: &'a str,
    /// Unit of the torque, `N·m` or `N`.
    pub unit: &'a str,
    /// Unit of the velocity, `rad/s` or `m/s`.
    pub velocity_unit: &'a str,
    /// ẏ.
    pub velocities: &'a [f64],
    /// τ, from [`super::torque::friction_torques`].
    pub torques: &'a [f64],
    /// Weights of the samples, 1 where absent.
    pub weights: Option<&'a [f64]>,
    /// Folds of the cross-validation, e.g. runs, or groups of runs that repeat one motion; contiguous blocks
    /// of equal size where absent.
    pub folds: Option<&'a [Range<usize>]>,
    /// Ranges of samples that were recorded without interruption. They follow each other and hold all samples;
    /// each has an offset of its own, and no error is taken to be correlated between them. One run where absent.
    pub runs: Option<&'a [Range<usize>]>,
    /// y, where residuals that depend on it are to be noticed.
    pub positions: Option<&'a [f64]>,
    /// ÿ, where residuals that depend on it are to be noticed.
    pub accelerations: Option<&'a [f64]>,
    /// Limits of the joint, where samples beyond them are to be noticed.
    pub limits: Option<JointLimits>,
    /// Source and hash of the log.
    pub data: &'a str,
    /// How these samples were made: differentiation, selection.
    pub settings: &'a [String],
}

/// Which λ of a cross-validated path is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LambdaChoice {
    /// The one with the least error on left-out blocks.
    Minimum,
    /// The largest one whose error is within one standard error of the least.
    OneStandardError,
}

/// How the law is found.
#[derive(Debug, Clone, PartialEq)]
pub enum FrictionMethod {
    /// Least squares on all terms of the library.
    LeastSquares,
    /// Sequentially thresholded least squares.
    Thresholding(Thresholding),
    /// LASSO on 100 values of λ, cross-validated on contiguous blocks, then least squares on the chosen
    /// terms.
    Lasso(Lasso, LambdaChoice),
    /// The subset with the fewest terms whose error on left-out blocks is within one standard error of the
    /// least, for libraries of at most twelve terms.
    BestSubset,
    /// Nonlinear regression of the Stribeck law; the library is not used.
    Stribeck(StribeckRegression),
}

/// What a constant torque in the data is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Offsets {
    /// A constant of each run: an offset of the sensor, or gravity that the model has wrong. It is estimated with
    /// the law, reported, never restricted and never written; constant terms of the library belong to it.
    /// Coulomb friction that differs by direction cannot be told from it unless the data hold slow motion.
    #[default]
    Separate,
    /// Friction: torques are known to have no offset, and constant terms of the library belong to the law.
    PartOfLaw,
}

/// Settings.
#[derive(Debug, Clone)]
pub struct FrictionIdentification {
    /// Terms in the velocity `v`.
    pub library: Library,
    /// How the law is found.
    pub method: FrictionMethod,
    /// What a constant torque is.
    pub offsets: Offsets,
    /// Contiguous blocks of the cross-validation, where the data name no folds.
    pub folds: usize,
    /// Bootstrap draws; 0 for none.
    pub draws: usize,
    /// Contiguous blocks among which the bootstrap draws: longer than the errors are correlated.
    pub blocks: usize,
    /// Seed of the bootstrap.
    pub seed: u64,
    /// Forces `τ v ≥ 0` over the speeds in the data and viscous friction ≥ 0, where least squares would break
    /// them. Offsets are separated before. A Stribeck law that breaks it is refused.
    pub passive: bool,
    /// R² on left-out data below which a law is refused.
    pub least_r_squared: f64,
}

impl FrictionIdentification {
    /// [`Library::joint_friction`], thresholding at 0.1, offsets separated, ten folds, 200 draws from 60 blocks,
    /// passive, refused below [`LEAST_R_SQUARED`].
    ///
    /// # Errors
    /// None in practice; the signature is that of [`Library::new`].
    pub fn new() -> Result<Self> {
        Ok(Self {
            library: Library::joint_friction()?,
            method: FrictionMethod::Thresholding(Thresholding::default()),
            offsets: Offsets::default(),
            folds: 10,
            draws: 200,
            blocks: 60,
            seed: 1,
            passive: true,
            least_r_squared: LEAST_R_SQUARED,
        })
    }

    /// Finds the law of one joint.
    ///
    /// # Errors
    /// Lengths that disagree, values that are not finite, a velocity that never changes, and what the method
    /// reports: collinear terms, too few samples, a threshold or λ that removes every term. A law that explains
    /// nothing is no error but a [`FrictionResult::refusal`].
    pub fn identify(&self, data: &FrictionData) -> Result<FrictionReport> {
        check(data)?;
        let limit = self.least_r_squared;
        require_setting("least R²", limit, limit <= 1.0, "it must be finite and at most 1")?;
        match &self.method {
            FrictionMethod::Stribeck(regression) => stribeck::identify(self, data, regression),
            _ => terms::identify(self, data),
        }
    }
}

impl FrictionIdentification {
    /// Finds friction that grows with the load, `τ = s₀(v) + |τ_l| s₁(v)`: [`Self::library`] holds the terms of s₀.
    ///
    /// - `load_library`: terms of s₁ in the velocity `v`, e.g. `tanh(20*v)`
    /// - `loads`: τ_l, the torque `M ÿ + k − q` without friction that the gear carries, at the same samples
    ///
    /// The law is not kept from driving the joint; a warning says where it would. The Stribeck method is taken for
    /// least squares on all terms.
    ///
    /// # Errors
    /// As [`Self::identify`]; a load that never changes is collinear with s₀.
    pub fn identify_with_load(
        &self,
        load_library: &Library,
        data: &FrictionData,
        loads: &[f64],
    ) -> Result<LoadFriction> {
        check(data)?;
        require_length(&format!("loads of {}", data.joint), data.velocities.len(), loads.len())?;
        require_finite(&format!("the load of {}", data.joint), loads)?;
        load::identify(self, load_library, data, loads)
    }
}

/// The law, and what it was chosen from.
#[derive(Debug, Clone)]
pub struct FrictionReport {
    /// The law with its numbers.
    pub result: FrictionResult,
    /// Candidate terms of the law: the library's without constants, where offsets are separated.
    pub terms: Vec<String>,
    /// Cosines between the candidate terms, offsets taken off `[p × p]`.
    pub correlation: DMatrix<f64>,
    /// Condition number of the candidate terms, columns scaled.
    pub condition: f64,
    /// Covariance of the law's coefficients, for correlated residuals; rows and columns as in the law.
    pub covariance: DMatrix<f64>,
    /// Cross-validated path, for the LASSO.
    pub validation: Option<CrossValidation>,
    /// Error against number of terms over λ, for the LASSO.
    pub front: Vec<ParetoPoint>,
    /// The best subset of each size with its error on left-out data, for the best subset.
    pub subsets: Option<SubsetValidation>,
    /// Bootstrap; none without draws.
    pub ensemble: Option<Ensemble>,
    /// All subsets of the candidate terms, weighed; none for the Stribeck law and for libraries of more than
    /// twelve terms.
    pub average: Option<ModelAverage>,
    /// Torque minus offset minus law at the samples.
    pub residuals: Vec<f64>,
}

impl FrictionReport {
    /// Half the width of the law's confidence band at `velocities`, at `level` (e.g. 0.95).
    ///
    /// # Errors
    /// A level outside (0, 1), or no samples.
    pub fn band(&self, velocities: &[f64], level: f64) -> Result<Vec<f64>> {
        let t = super::confidence::quantile(level, self.result.freedom)?;
        let gradients = self.result.law.gradients(velocities)?;
        let width = |row: nalgebra::DVector<f64>| t * row.dot(&(&self.covariance * &row)).max(0.0).sqrt();
        Ok(gradients.row_iter().map(|row| width(row.transpose())).collect())
    }
}

fn check(data: &FrictionData) -> Result<()> {
    let m = data.velocities.len();
    require_samples(&format!("the friction of {}", data.joint), 2, m)?;
    require_length("friction torques", m, data.torques.len())?;
    require_finite(&format!("the velocity of {}", data.joint), data.velocities)?;
    require_finite(&format!("the friction torque of {}", data.joint), data.torques)?;
    for (what, column) in [("position", data.positions), ("acceleration", data.accelerations)] {
        let Some(column) = column else { continue };
        require_length(&format!("samples of the {what} of {}", data.joint), m, column.len())?;
        require_finite(&format!("the {what} of {}", data.joint), column)?;
    }
    check_runs(data, m)?;
    if data.velocities.iter().all(|v| *v == data.velocities[0]) {
        return Err(IdentificationError::Constant {
            what: format!("the velocity of {}", data.joint),
            value: data.velocities[0],
            samples: m,
        });
    }
    Ok(())
}

fn check_runs(data: &FrictionData, samples: usize) -> Result<()> {
    let Some(runs) = data.runs else { return Ok(()) };
    let mut end = 0;
    for run in runs {
        require_length(&format!("first sample of a run of {}", data.joint), end, run.start)?;
        require_samples(&format!("a run of {}", data.joint), 1, run.len())?;
        end = run.end;
    }
    require_length(&format!("samples in the runs of {}", data.joint), samples, end)
}
