//! Samples of one joint, and the settings of the identification of its friction law.

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
    /// Velocity ẏ of each sample.
    pub velocities: &'a [f64],
    /// Friction torque τ_f of each sample [N·m or N]: the effort minus the rigid-body force at the joint.
    pub torques: &'a [f64],
    /// Folds of the cross-validation. Each fold has several ranges of samples, e.g. the runs that repeat one motion. `None`
    /// takes contiguous blocks of equal size.
    pub folds: Option<&'a [Vec<Range<usize>>]>,
    /// Ranges of samples that were recorded without interruption. They are contiguous and contain all samples. Each run has
    /// an offset of its own. Errors of different runs count as uncorrelated. `None` takes all samples as one run.
    pub runs: Option<&'a [Range<usize>]>,
    /// The filter that the torques passed. Friction laws pass it, too. `None` if the torques passed no filter.
    pub(crate) filtered: Option<&'a Filtered<'a>>,
    /// Friction terms of the common estimate; `None` if there are none. The errors of the law are at least as large as those
    /// that follow from the estimate.
    pub(crate) common: Option<&'a CommonTerms>,
    /// Limits of the joint; `None` if the law is not compared with limits.
    pub limits: Option<JointLimits>,
    /// Source and hash of the log.
    pub data: &'a str,
    /// Sentences on the processing of the samples, as differentiation and selection.
    pub settings: &'a [String],
}

impl<'a> FrictionData<'a> {
    /// Samples of a joint in N·m and rad/s, in one run.
    pub fn of(joint: &'a str, velocities: &'a [f64], torques: &'a [f64]) -> Self {
        Self { joint, unit: "N·m", velocity_unit: "rad/s", velocities, torques, ..Self::default() }
    }
}

/// Friction terms of the common estimate.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CommonTerms {
    /// Terms in the velocity `v`.
    pub(crate) bases: Vec<String>,
    /// Changes of the coefficients if the samples near rests and reversals are left out.
    pub(crate) margins: DVector<f64>,
    /// Covariance of the coefficients.
    pub(crate) covariance: DMatrix<f64>,
    /// Degrees of freedom of the covariance.
    pub(crate) freedom: f64,
}

/// Meaning of a constant torque in the data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Offsets {
    /// A constant of each run is an offset of the sensor, or an error of the modelled gravity. It is estimated together with
    /// the law and reported, but neither constrained nor written. Constant terms of the library are left out. Coulomb
    /// friction that differs by direction cannot be distinguished from an offset unless the data contain slow motion.
    #[default]
    Separate,
    /// The offsets are known and were subtracted from the torques before. Constant terms of the library are left out.
    Known,
    /// A constant is friction: the torques have no offset, and constant terms of the library are part of the law.
    PartOfLaw,
}

/// Settings of the identification of a friction law.
#[derive(Debug, Clone)]
pub struct FrictionIdentification {
    /// Candidate terms in the velocity `v`.
    pub library: Library,
    /// Method by which the law is identified.
    pub method: FrictionMethod,
    /// Meaning of a constant torque.
    pub offsets: Offsets,
    /// Number of contiguous blocks of the cross-validation, if the data have no folds.
    pub folds: usize,
    /// Whether the law must be passive: `τ v ≥ 0` at all speeds up to ten times the largest one in the data, viscous
    /// friction ≥ 0, and at c times the largest speed (c > 1) a torque of at most 1.5 c times that at the largest speed.
    /// Terms are chosen among laws that meet these constraints. Offsets are separated before. A Stribeck law that drives the
    /// joint is refused.
    pub passive: bool,
    /// Least R² on held-out data. A law with a lower R² is refused.
    pub least_r_squared: f64,
}

impl FrictionIdentification {
    /// Settings with the usual terms of a joint, thresholding at 0.1, separate offsets and ten folds. The law is passive. It
    /// is refused if its held-out R² is below 0.05.
    ///
    /// # Errors
    /// An error of [`Library::new`], which does not occur.
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
