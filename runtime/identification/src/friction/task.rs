//! Samples of one joint, and the settings by which its law is found.

use super::super::error::Result;
use super::super::methods::filtered::Filtered;
use super::super::methods::library::Library;
use super::super::methods::thresholding::Thresholding;
use super::super::robot::JointLimits;
use super::levels;
use super::selection::FrictionMethod;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

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
    /// τ_f (N·m or N), the effort minus the rigid-body part at the joint.
    pub torques: &'a [f64],
    /// Folds of the cross-validation, each of several ranges of samples, e.g. the runs that repeat one motion; contiguous
    /// blocks of equal size where absent.
    pub folds: Option<&'a [Vec<Range<usize>>]>,
    /// Ranges of samples that were recorded without interruption. They follow each other and hold all samples;
    /// each has an offset of its own, and no error is taken to be correlated between them. One run where absent.
    pub runs: Option<&'a [Range<usize>]>,
    /// The filter that the torques passed: laws pass it too.
    pub(crate) filtered: Option<&'a Filtered<'a>>,
    /// Friction terms of the common estimate: the intervals are at least as wide as its own.
    pub(crate) common: Option<&'a CommonTerms>,
    /// Limits of the joint, where samples beyond them are to be noticed.
    pub limits: Option<JointLimits>,
    /// Source and hash of the log.
    pub data: &'a str,
    /// How these samples were made: differentiation, selection.
    pub settings: &'a [String],
}

impl<'a> FrictionData<'a> {
    /// Samples of a joint in N·m and rad/s, in one run.
    pub fn of(joint: &'a str, velocities: &'a [f64], torques: &'a [f64]) -> Self {
        Self { joint, unit: "N·m", velocity_unit: "rad/s", velocities, torques, ..Self::default() }
    }
}

/// Friction by the common estimate.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CommonTerms {
    /// Terms in the velocity `v`.
    pub(crate) bases: Vec<String>,
    /// Their changes without the samples near rests and reversals.
    pub(crate) margins: DVector<f64>,
    /// Covariance of the coefficients.
    pub(crate) covariance: DMatrix<f64>,
    /// Degrees of freedom of the covariance.
    pub(crate) freedom: f64,
}

/// Meaning of a constant torque in the data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Offsets {
    /// A constant of each run: an offset of the sensor, or gravity that the model has wrong. It is estimated with
    /// the law, reported, never restricted and never written; constant terms of the library belong to it.
    /// Coulomb friction that differs by direction cannot be told from it unless the data hold slow motion.
    #[default]
    Separate,
    /// Known: it was taken off the torques before, and constant terms of the library, which would be one more, are left out.
    Known,
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
    /// Meaning of a constant torque.
    pub offsets: Offsets,
    /// Contiguous blocks of the cross-validation, if the data name no folds.
    pub folds: usize,
    /// Forces `τ v ≥ 0` at all speeds up to ten times the largest one in the data, viscous friction ≥ 0, and a torque that
    /// grows beyond the data at most half as fast again as the speed, where least squares would break them. Terms are chosen
    /// among laws that meet this. Offsets are separated before. A Stribeck law that drives the joint is refused.
    pub passive: bool,
    /// R² on left-out data below which a law is refused.
    pub least_r_squared: f64,
}

impl FrictionIdentification {
    /// The usual terms of a joint, thresholding at 0.1, offsets separated, ten folds; the law is passive, and refused below a
    /// held-out R² of 0.05.
    ///
    /// # Errors
    /// None in practice; the signature is that of [`Library::new`].
    pub fn new() -> Result<Self> {
        Ok(Self {
            library: Library::joint_friction()?,
            method: FrictionMethod::Thresholding(Thresholding::default()),
            offsets: Offsets::default(),
            folds: 10,
            passive: true,
            least_r_squared: levels::LEAST_R_SQUARED.get(),
        })
    }
}
