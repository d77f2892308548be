//! Recursive estimation of a load carried by the robot.

use super::bank::Gaussian;
use super::estimator::Adaptation;
use super::filter::LowPass;
use super::joint::{Derived, GATE, Joint, Prediction, QUANTILE};
use super::law::{dot, root};
use super::settings::AdaptationError;
use super::trust::{Comparison, Trust};

/// State of a [`LoadEstimator`] at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadState<const P: usize> {
    /// Learned parameters θ of the load, within their bounds.
    pub learned: [f64; P],
    /// Half width of the 90 % confidence interval of each parameter.
    pub half_widths: [f64; P],
    /// Acting parameters of the load, which controllers use. They follow the learned parameters, or 0 if the robot without load
    /// predicts the torques better.
    pub acting: [f64; P],
    /// Whether the learned parameters act, and the reason.
    pub trust: Trust,
}

/// Recursive estimator of P parameters θ of a load that the robot carries. The joint torques must be linear in θ:
///
/// ```text
///     M ÿ + k − q + τ_acting + Σ_k W_k(y, ẏ, ÿ) θ_k = B u
/// ```
///
/// M is the mass matrix, k is the bias force, q are gravity, springs and other forces of the robot without load, and B u are
/// the forces of the inputs. τ_acting is the friction by the acting law of [`Adaptation`]. The columns W_k of the regressor
/// belong, for example, to a mass at a known position, or to the ten inertial parameters of a body (Atkeson, An, Hollerbach,
/// *Int. J. Robotics Research* 5, 1986). Columns and friction terms pass the same filter, and samples are taken at the same
/// times. One Kalman filter for all joints predicts the torque that the acting friction τ_acting does not explain. The noise
/// variance of a sample is the variance of the joint's noise plus the variance of its learned friction. θ drifts as a random
/// walk with the third of [`AdaptationSettings::drift_times`](super::AdaptationSettings::drift_times).
///
/// A sample whose prediction error exceeds four standard deviations, for example in contact, is not used. Each of these samples
/// increases the covariance by a share of the prior's covariance: the time between samples, divided by
/// [`AdaptationSettings::patience`](super::AdaptationSettings::patience). Therefore a lasting load is learned after some time.
///
/// # Limits
///
/// - Each parameter remains within its bounds. The estimator does not ensure that a body with the ten estimated parameters
///   exists.
/// - A lasting contact is learned as a load if its torques resemble those of a load.
/// - The saved state ([`Adaptation::save`]) does not contain the load, because the load can change before a restart.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadEstimator<const N: usize, const P: usize> {
    bounds: [[f64; 2]; P],
    prior: [f64; P],
    filters: [LowPass<P>; N],
    comparison: Comparison,
    law: Gaussian<P>,
    acting: [f64; P],
}

impl<const N: usize, const P: usize> LoadEstimator<N, P> {
    /// Constructs an estimator for parameters within `bounds`. The standard deviation of the prior of each parameter is half of
    /// the largest magnitude of its bounds.
    ///
    /// # Errors
    /// [`AdaptationError::Load`] if bounds are not finite or 0 is not between them.
    pub fn new(bounds: [[f64; 2]; P]) -> Result<Self, AdaptationError> {
        let is_box =
            |[low, high]: &[f64; 2]| low.is_finite() && high.is_finite() && *low <= 0.0 && *high >= 0.0;
        if let Some(place) = bounds.iter().position(|bounds| !is_box(bounds)) {
            return Err(AdaptationError::Load(place));
        }
        let prior = bounds.map(|[low, high]| 0.25 * high.max(-low) * high.max(-low));
        Ok(Self {
            bounds,
            prior,
            filters: [LowPass::ZERO; N],
            comparison: Comparison::NEW,
            law: Gaussian::prior(&prior),
            acting: [0.0; P],
        })
    }

    /// Advances the estimation by a period. Call this method after the step of the friction estimator. Does not allocate.
    ///
    /// - `columns`: joint torques per unit of each parameter, at the motion for which [`Adaptation::step`] requested the
    ///   described torques; `None` if it did not request them
    /// - `friction`: the friction estimator. Its described torques must include the [acting](Self::acting) load.
    pub fn step(&mut self, columns: Option<&[[f64; P]; N]>, friction: &Adaptation<N>) {
        let settings = friction.settings();
        self.law.widen(settings.period / settings.drift_times[2], &self.prior);
        let Some(columns) = columns else { return self.blend(settings.period, settings.blending) };
        for i in 0..N {
            let (Some(joint), Some(derived)) = (&friction.joints[i], &friction.derived[i]) else { continue };
            let column = self.filters[i].take(&columns[i], derived.weight);
            if let Some(prediction) = &joint.prediction {
                self.learn(&column, prediction, joint, derived, settings.patience);
            }
        }
        self.blend(settings.period, settings.blending);
    }

    fn learn(
        &mut self,
        column: &[f64; P],
        prediction: &Prediction,
        joint: &Joint,
        derived: &Derived,
        patience: f64,
    ) {
        let left = prediction.torque - dot(&prediction.terms, &joint.acting);
        let torque = left + dot(column, &self.acting);
        let error = torque - dot(column, &self.admissible());
        let of_friction = joint.law.variance(&prediction.terms);
        let known = joint.bank.noise + of_friction;
        if error * error > GATE * GATE * (self.law.variance(column) + known) {
            self.comparison.exclude();
            self.law.widen(derived.interval / patience, &self.prior);
            return;
        }
        let deviation = root(known);
        self.comparison.whole([0.0; 2], derived.keep);
        self.comparison.take([torque / deviation, error / deviation]);
        let noise = joint.bank.noise * joint.bank.correlated() + of_friction;
        self.law.update(column, torque - dot(column, &self.law.mean), noise);
    }

    /// Moves the acting parameters towards the learned parameters, or towards 0.
    fn blend(&mut self, period: f64, time_constant: f64) {
        let target = match self.comparison.trust(true) {
            Trust::Learned => self.admissible(),
            _ => [0.0; P],
        };
        for (acting, target) in self.acting.iter_mut().zip(target) {
            *acting += period / (period + time_constant) * (target - *acting);
        }
    }

    /// The learned parameters, clamped to their bounds.
    fn admissible(&self) -> [f64; P] {
        core::array::from_fn(|k| self.law.mean[k].clamp(self.bounds[k][0], self.bounds[k][1]))
    }

    /// Returns the acting parameters of the load, which controllers use.
    #[must_use]
    pub fn acting(&self) -> &[f64; P] {
        &self.acting
    }

    /// Returns the learned and the acting parameters, the confidence intervals, and the reason why the learned parameters act
    /// or do not act.
    #[must_use]
    pub fn state(&self) -> LoadState<P> {
        LoadState {
            learned: self.admissible(),
            half_widths: core::array::from_fn(|k| QUANTILE * root(self.law.covariance[k][k].max(0.0))),
            acting: self.acting,
            trust: self.comparison.trust(true),
        }
    }
}
