//! Recursive estimation of a load carried by the robot.

use super::bank::Gaussian;
use super::estimator::Adaptation;
use super::filter::LowPass;
use super::joint::{Derived, GATE, Joint, Prediction, QUANTILE};
use super::law::{dot, root};
use super::settings::AdaptationError;
use super::trust::{Comparison, Trust};

/// Parameters of the load at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadState<const P: usize> {
    /// Learned parameters.
    pub learned: [f64; P],
    /// Half of the 90 % interval of each parameter.
    pub half_widths: [f64; P],
    /// Acting parameters; zero while the robot without load predicts better.
    pub acting: [f64; P],
    /// Whether the learned parameters act, and the reason.
    pub trust: Trust,
}

/// Recursive estimator of P parameters θ of a load; torques must be linear in θ.
///
/// ```text
///     M ÿ + k − q + τ_acting + Σ_k W_k(y, ẏ, ÿ) θ_k = B u
/// ```
///
/// The columns W are those of a mass at a known position, or of the ten inertial parameters of a body
/// (Atkeson, An, Hollerbach, *Int. J. Robotics Research* 5, 1986). They pass the same filter as the friction
/// terms, and the samples are those of the friction estimator. One Kalman filter over all joints predicts the
/// torque that the acting friction leaves; its noise has the variances of noise and friction of each joint. A
/// sample beyond four standard deviations is not learned, as in contact. It widens the covariance by its
/// share of [`AdaptationSettings::patience`](super::AdaptationSettings::patience), so a load is learned if it
/// lasts. θ drifts with the fastest of
/// [`AdaptationSettings::drift_times`](super::AdaptationSettings::drift_times).
///
/// # Limits
///
/// - Parameters stay in a box around 0. That a body with these ten parameters exists is not ensured.
/// - A lasting contact is learned as a load, as far as its torques resemble those of one.
/// - A saved state has no load: it may be another one after a restart.
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
    /// Estimator of parameters within a box. The prior's standard deviation is half of the largest magnitude.
    ///
    /// # Errors
    /// [`AdaptationError::Load`].
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

    /// Advances by a period, after the step of the friction estimator. Does not allocate.
    ///
    /// - `columns`: joint torques per unit of each parameter, at the motion for which [`Adaptation::step`]
    ///   requested the described forces; `None` if it did not request them
    /// - `friction`: the friction estimator, whose described forces included the [acting](Self::acting) load
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

    /// The acting parameters follow the learned ones.
    fn blend(&mut self, period: f64, time_constant: f64) {
        let target = match self.comparison.trust(true) {
            Trust::Learned => self.admissible(),
            _ => [0.0; P],
        };
        for (acting, target) in self.acting.iter_mut().zip(target) {
            *acting += period / (period + time_constant) * (target - *acting);
        }
    }

    /// The learned parameters within their box.
    fn admissible(&self) -> [f64; P] {
        core::array::from_fn(|k| self.law.mean[k].clamp(self.bounds[k][0], self.bounds[k][1]))
    }

    /// Acting parameters.
    #[must_use]
    pub fn acting(&self) -> &[f64; P] {
        &self.acting
    }

    /// Learned and acting parameters, and intervals.
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
