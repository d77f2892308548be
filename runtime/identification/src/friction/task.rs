//! Samples of one joint, and the settings of the identification of its friction law.

use super::super::error::Result;
use super::super::estimation::CommonTerms;
use super::super::methods::filtered::Filtered;
use super::super::methods::library::Library;
use super::super::methods::thresholding::Thresholding;
use super::super::robot::JointLimits;
use super::levels;
use super::selection::FrictionMethod;
use gelenk_findings::Finding;
use std::ops::Range;

/// Samples of the velocity and the friction torque of one joint, with their units and origin.
#[derive(Debug, Clone, Default)]
pub struct FrictionData<'a> {
    /// Name of the joint in the description, for the report.
    pub joint: &'a str,
    /// Unit of the torque, `N·m` or `N`.
    pub unit: &'a str,
    /// Unit of the velocity, `rad/s` or `m/s`.
    pub velocity_unit: &'a str,
    /// Velocity ẏ of each sample [rad/s or m/s].
    pub velocities: &'a [f64],
    /// Friction torque τ_f of each sample [N·m or N]: the effort minus the rigid-body force at the joint and minus the offset
    /// of the sensor.
    pub torques: &'a [f64],
    /// Folds of the cross-validation. Each fold has several ranges of samples, for example the runs that repeat one motion.
    /// `None` takes contiguous blocks of equal size.
    pub folds: Option<&'a [Vec<Range<usize>>]>,
    /// Runs: ranges of samples that were recorded without interruption. Each range starts at the end of the previous range,
    /// and the ranges contain all samples. Errors of different runs count as uncorrelated.
    /// `None` takes all samples as one run.
    pub runs: Option<&'a [Range<usize>]>,
    /// The filter that the torques passed. The values of friction laws pass the same filter. `None` if the torques passed no
    /// filter.
    pub(crate) filtered: Option<&'a Filtered<'a>>,
    /// Friction terms of the estimate of all joints ([`crate::estimation`]); `None` if there are no terms. The errors of the
    /// law are at least as large as the errors that follow from this estimate.
    pub(crate) common: Option<&'a CommonTerms>,
    /// Described limits of the joint; `None` if the law is not compared with limits.
    pub limits: Option<JointLimits>,
    /// Name and hash of the log, as text for the report.
    pub data: &'a str,
    /// Settings with which the samples were made, for example the filter.
    pub(crate) settings: &'a [Finding],
}

impl<'a> FrictionData<'a> {
    /// Returns data with samples in N·m and rad/s, in one run, and with defaults for all other fields.
    pub fn of(joint: &'a str, velocities: &'a [f64], torques: &'a [f64]) -> Self {
        Self { joint, unit: "N·m", velocity_unit: "rad/s", velocities, torques, ..Self::default() }
    }
}

/// Meaning of a constant torque in the friction samples of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Offsets {
    /// The offsets are known and were subtracted from the torques before. Constant terms of the library are left out.
    #[default]
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
    /// Whether a constant torque can be friction. In both cases the torques must not contain an offset of the sensor.
    pub offsets: Offsets,
    /// Number of contiguous blocks of the cross-validation, if the data have no folds.
    pub folds: usize,
    /// Whether the law must be passive. A passive law has these properties:
    /// - The torque τ brakes, `τ v ≥ 0`, at all speeds up to ten times the largest speed in the data.
    /// - Viscous friction is not negative.
    /// - At c times the largest speed (c > 1) the torque is at most 1.5 c times the torque at the largest speed.
    ///
    /// Terms are chosen among laws with these properties. A Stribeck law that drives the joint is refused.
    pub passive: bool,
    /// Smallest acceptable R² on held-out data. A law with a lower R² is refused.
    pub least_r_squared: f64,
}

impl FrictionIdentification {
    /// Returns settings with the usual friction terms of a joint, sequential thresholding at 0.1 and ten folds. Constant terms
    /// are left out. The law must be passive. It is refused if its held-out R² is below 0.05.
    ///
    /// # Errors
    /// The call fails if the default terms are invalid, which does not happen.
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
