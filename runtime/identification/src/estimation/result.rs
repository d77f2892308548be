//! The estimate and its uncertainty.

use super::super::run::Effort;
use super::sensitivity::Sensitivity;
use gelenk_findings::Finding;
use nalgebra::{DMatrix, DVector};

/// Kind of the offsets of measured forces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Offsets {
    /// Measured forces have no offset, because the sensors and the described gravity are assumed to be exact.
    None,
    /// One offset for each joint.
    Common,
    /// One offset for each joint and run.
    ByRun,
}

/// Part of the robot's weight that recorded efforts contain. In the equations, z is the recorded effort, W is the regressor,
/// W₀ is the regressor at rest, and π are the inertial parameters. The dots are friction, offset and other forces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gravity {
    /// The recorded efforts z contain the robot's weight: `z = W π + …` with the regressor W and the inertial
    /// parameters π.
    Recorded,
    /// The robot compensates its whole weight outside the recorded efforts z: `z = W π − W₀ π + …` with the
    /// regressor W, the regressor at rest W₀ and the inertial parameters π.
    Compensated,
    /// The robot compensates the weight of the described bodies outside the recorded efforts z: `z = W π − W₀
    /// π₀ + …` with the regressor W, the regressor at rest W₀, the inertial parameters π and the described
    /// parameters π₀. The efforts contain the rest of the weight, which determines the masses.
    CompensatedAsDescribed,
}

impl Gravity {
    /// The assumption before the fit: [`Self::Compensated`] if the robot compensates gravity, otherwise [`Self::Recorded`].
    pub(crate) fn of(is_compensated: bool) -> Self {
        if is_compensated { Self::Compensated } else { Self::Recorded }
    }
}

/// Inertia, friction, offsets and gains of a robot, with intervals.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Inertial parameters π, in the robot's order [kg, kg m, kg m²].
    pub parameters: Vec<Uncertain>,
    /// Whether every body with mass is physically possible: its pseudo-inertia is positive definite.
    pub consistent: bool,
    /// Estimate of each joint.
    pub joints: Vec<JointEstimate>,
    /// Kind of the recorded efforts: forces at the joints, inputs, or currents.
    pub effort: Effort,
    /// Part of the robot's weight that the recorded efforts contain.
    pub gravity: Gravity,
    /// Kind of the estimated offsets: none, one for each joint, or one for each joint and run.
    pub offsets: Offsets,
    /// Weight λ of the squared distance from the description.
    pub description_weight: f64,
    /// Covariance matrix of the inertial parameters; zero for parameters that the data may not change.
    pub parameter_covariance: DMatrix<f64>,
    /// Sums of products from which [`Self::r_squared_lost`] is computed.
    pub(crate) sensitivity: Sensitivity,
    /// Measured efforts, converted to forces at the joints by the gains of the drives, `[run][joint][sample]` [N·m or N].
    pub measured: Vec<Vec<Vec<f64>>>,
    /// Forces at the joints by the fitted model, including friction and offsets, `[run][joint][sample]` [N·m or N].
    pub predicted: Vec<Vec<Vec<f64>>>,
    /// Measured forces minus the estimated rigid-body forces, `[run][joint][sample]` [N·m or N]. These differences contain
    /// friction, offset and error.
    pub friction: Vec<Vec<Vec<f64>>>,
    /// Estimated load-dependent friction, `[run][joint][sample]` [N·m or N]; empty if it was not requested.
    pub load_friction: Vec<Vec<Vec<f64>>>,
    /// Confidence level of all intervals, between 0 and 1.
    pub confidence: f64,
    /// Friction terms of each joint with the errors of their coefficients, for the identification of the joint's law. `None`
    /// if the joint has no terms.
    pub(crate) common: Vec<Option<CommonTerms>>,
    /// Degrees of freedom of the covariances, for Student's t distribution.
    pub freedom: usize,
    /// Delay of each effort that remained after the preparation \[s\], positive if the effort is late; empty if the delays are
    /// known. The forces of this estimate are shifted by these delays to the times of the motion.
    pub delays: Vec<Uncertain>,
    /// Findings about the choices of the fit and about the data.
    pub findings: Vec<Finding>,
}

/// An estimated value with its confidence interval. The interval takes correlated residuals into account.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Uncertain {
    /// Estimated value.
    pub value: f64,
    /// Standard error; zero if the data may not change the value.
    pub standard_error: f64,
    /// Lower and upper end of the interval at the level [`Estimate::confidence`].
    pub interval: [f64; 2],
}

impl Uncertain {
    /// Whether both ends of the interval have the same sign and differ at most by a factor of 2.
    #[must_use]
    pub fn has_one_size(&self) -> bool {
        let [low, high] = self.interval;
        let [near, far] = [low.abs().min(high.abs()), low.abs().max(high.abs())];
        low * high > 0.0 && far <= 2.0 * near
    }
}

/// Estimate of one joint, or of the shaft that replaces the joint in the equations ([`crate::shafts`]).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointEstimate {
    /// Name of the joint in the description, or of the drive whose shaft replaces the joint.
    pub name: String,
    /// Unit of the forces: `N·m` or `N`.
    pub unit: &'static str,
    /// Friction terms; empty if the joint does not move.
    pub terms: Vec<EstimatedTerm>,
    /// Load-dependent friction `|τ_l| s₁(v)`: τ_l is the load of the gear (the force of the drive without all friction), and
    /// s₁ is a dimensionless function of the velocity v. `None` if the term was not requested or not chosen.
    pub load: Option<EstimatedTerm>,
    /// Reflected inertia in addition to the described inertia [kg m² or kg]; `None` if this term was not chosen.
    pub armature: Option<Uncertain>,
    /// Motor constant K_M [N·m/A or N/A]; `None` if the effort is not a current or if the description has the constant. The
    /// described bodies determine the scale of K_M. The intervals of parameters and friction include the uncertainty of K_M.
    pub gain: Option<Uncertain>,
    /// Offset of the measured force in each run, `measured = model + offset` [N·m or N].
    pub offsets: Vec<f64>,
    /// Standard error of each offset; a single entry if all runs share an offset.
    pub offset_errors: Vec<f64>,
    /// Standard deviation of the residual, which is measured minus predicted force [N·m or N].
    pub sigma: f64,
    /// `R² = 1 − RSS / Σ (τ − τ̄)²` over all fitted data, with the residual sum of squares RSS, the measured force τ
    /// and its mean τ̄.
    pub r_squared: f64,
    /// R² on held-out data: each fold of the data is predicted by the fit to the other folds.
    pub held_out_r_squared: f64,
    /// R² on held-out data over all samples including those at rest. At rest, dry friction can have any value up
    /// to the static friction. No law of the velocity predicts this value. NaN if the estimate was made from
    /// moments.
    pub held_out_with_rest: f64,
    /// Share of the samples in which the joint rests. These samples are not used for the estimate and for the other numbers
    /// of this struct, except [`Self::held_out_with_rest`].
    pub rest: f64,
    /// Whether the joint moves in the data.
    pub moves: bool,
    /// Whether the effort of the joint was measured. Without a measured effort the joint has no terms, gain or armature. Its
    /// numbers and its measured and predicted forces are then NaN.
    pub measured: bool,
    /// Whether the force is known without a sensor, as it is for a joint with a quaternion. Then neither an offset nor friction
    /// is estimated. R² is NaN if no force acts at the joint.
    pub exact: bool,
}

/// A friction term with its coefficient.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimatedTerm {
    /// Expression in the joint's velocity `v`, as in a description.
    pub basis: String,
    /// Coefficient of the expression. The product of coefficient and expression is in N·m or N. For [`JointEstimate::load`], it
    /// is dimensionless.
    pub coefficient: Uncertain,
}

/// Friction terms of one joint in the estimate of all joints.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CommonTerms {
    /// Friction terms as expressions in the velocity `v`.
    pub(crate) bases: Vec<String>,
    /// Changes of the terms' coefficients if the samples near rests and reversals are left out.
    pub(crate) margins: DVector<f64>,
    /// Covariance of the terms' coefficients.
    pub(crate) covariance: DMatrix<f64>,
    /// Degrees of freedom of the coefficients' covariance.
    pub(crate) freedom: f64,
}
