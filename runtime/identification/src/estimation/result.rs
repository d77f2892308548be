//! The estimate and how far to trust it.

use super::super::run::Effort;
use super::sensitivity::Sensitivity;
use gelenk_findings::Finding;
use nalgebra::{DMatrix, DVector};

/// How offsets of the measured forces are estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Offsets {
    /// None: the sensors and the gravity of the description are trusted.
    None,
    /// One for each joint.
    Common,
    /// One for each joint and run.
    ByRun,
}

/// The gravity in recorded efforts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gravity {
    /// The efforts hold it.
    Recorded,
    /// The robot compensates all of it outside the recorded efforts: `z = W π − W₀ π + …`, with W₀ at rest.
    Compensated,
    /// The robot compensates that of the bodies as described, π₀, by the same model: `z = W π − W₀ π₀ + …`. What the bodies
    /// weigh beyond it is left in the efforts, and tells their masses.
    CompensatedAsDescribed,
}

impl Gravity {
    /// The first thing to think for efforts with or without gravity.
    pub(crate) fn of(is_compensated: bool) -> Self {
        if is_compensated { Self::Compensated } else { Self::Recorded }
    }
}

/// Inertia, friction, offsets and gains of a robot, with intervals.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// The P inertial parameters π, in the robot's order [kg, kg m, kg m²].
    pub parameters: Vec<Uncertain>,
    /// Whether every body with mass can exist: its pseudo-inertia is positive definite.
    pub consistent: bool,
    /// One estimate per joint.
    pub joints: Vec<JointEstimate>,
    /// Kind of the efforts.
    pub effort: Effort,
    /// The gravity in these.
    pub gravity: Gravity,
    /// How offsets were estimated.
    pub offsets: Offsets,
    /// Weight of the distance from the description.
    pub description_weight: f64,
    /// How many combinations of the inertial parameters the data decide: the trace of `(H + λ R)⁻¹ H` over them.
    pub effective_parameters: f64,
    /// Covariance of the inertial parameters `[P × P]`: zero if the data may not change them.
    pub parameter_covariance: DMatrix<f64>,
    /// How well other inertial parameters would explain the data.
    pub(crate) sensitivity: Sensitivity,
    /// Forces at the joints as measured, gains applied, `[run][joint][sample]` [N·m or N].
    pub measured: Vec<Vec<Vec<f64>>>,
    /// The model's forces, offsets included, in the same shape.
    pub predicted: Vec<Vec<Vec<f64>>>,
    /// Measured forces without the rigid body's: friction, offset and error, in the same shape.
    pub friction: Vec<Vec<Vec<f64>>>,
    /// The share of these forces that grows with the load, in the same shape; empty if it was not asked for.
    pub load_friction: Vec<Vec<Vec<f64>>>,
    /// Level of all intervals.
    pub confidence: f64,
    /// Covariance of the coefficients of each joint's terms, and its degrees of freedom.
    pub terms_covariance: Vec<DMatrix<f64>>,
    /// Change of the coefficients of each joint's terms without the samples near rests and reversals.
    pub terms_margins: Vec<DVector<f64>>,
    /// Degrees of freedom of the covariances.
    pub freedom: usize,
    /// Delay of each effort that remains after the removed one \[s\], positive if efforts come later still;
    /// empty if delays are known. The forces above are at the times of the motion.
    pub delays: Vec<Uncertain>,
    /// Choices, as notes, and doubts.
    pub findings: Vec<Finding>,
}

/// A value with its interval, which holds under correlated residuals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertain {
    /// The estimate.
    pub value: f64,
    /// Standard error; zero if the data may not change the value.
    pub standard_error: f64,
    /// Ends of the interval at the estimate's level.
    pub interval: [f64; 2],
}

impl Uncertain {
    /// Whether the ends of its interval have one sign and differ by a factor of 2 at most.
    #[must_use]
    pub fn has_one_size(&self) -> bool {
        let [low, high] = self.interval;
        let [near, far] = [low.abs().min(high.abs()), low.abs().max(high.abs())];
        low * high > 0.0 && far <= 2.0 * near
    }
}

/// Estimate of one joint, or of the shaft that takes its row ([`crate::shafts`]).
#[derive(Debug, Clone, PartialEq)]
pub struct JointEstimate {
    /// Name of the joint in the description, or of the shaft's drive.
    pub name: String,
    /// `N·m` or `N`.
    pub unit: &'static str,
    /// Friction and reflected inertia; empty if the joint stands still.
    pub terms: Vec<EstimatedTerm>,
    /// Friction under load, `|τ_l| s₁(v)` with a share s₁ of the load without unit, where it was asked for and chosen.
    pub load: Option<EstimatedTerm>,
    /// Reflected inertia that the description does not have [kg m² or kg], where it was chosen.
    pub armature: Option<Uncertain>,
    /// Motor constant K_M [N·m/A or N/A], if the effort is a current and the description has none. The scale of torque is that
    /// of the described bodies. Intervals of parameters and friction count its own.
    pub gain: Option<Uncertain>,
    /// Offset of the measured force in each run, `measured = model + offset`.
    pub offsets: Vec<f64>,
    /// Standard error of each of these; one if all runs share an offset.
    pub offset_errors: Vec<f64>,
    /// Standard deviation of the residual.
    pub sigma: f64,
    /// `1 − RSS / Σ (τ − τ̄)²` over all data that were fitted.
    pub r_squared: f64,
    /// The same with each fold predicted from the others.
    pub held_out_r_squared: f64,
    /// The same over all samples, those at rest among them: dry friction takes any value there up to the static one, which
    /// no law of the velocity predicts. Estimates from moments do not know it: NaN.
    pub held_out_with_rest: f64,
    /// Share of the samples in which the joint rests. The estimate, and all other numbers here, are made without them.
    pub rest: f64,
    /// Whether the joint moves in the data.
    pub moves: bool,
    /// Whether its effort was measured. Where not, it has no terms, gain or armature, its numbers are NaN, and so are
    /// its measured and predicted forces.
    pub measured: bool,
    /// Whether its force is known without a sensor, as in the rows of a joint with a quaternion: it has neither an offset
    /// nor estimated friction. R² is NaN if nothing acts there.
    pub exact: bool,
}

/// A friction term with its coefficient.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimatedTerm {
    /// Expression in the joint's velocity `v`, as a description has it.
    pub basis: String,
    /// Its coefficient.
    pub coefficient: Uncertain,
}
