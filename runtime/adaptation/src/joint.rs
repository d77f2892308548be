//! Recursive estimation of the friction of one joint.

use super::bank::{Bank, Gaussian, Sample};
use super::filter::LowPass;
use super::law::{JointScale, TERMS, dot, root, terms};
use super::nested::{averaged, constrained};
use super::settings::AdaptationSettings;
use super::trust::{Comparison, Trust};

/// Largest residual that the law and its noise explain, in standard deviations.
pub(super) const GATE: f64 = 4.0;
/// Standard deviation of the noise before the first sample, relative to the friction at the largest speed.
const FIRST_NOISE: f64 = 0.1;
/// Smallest variance of the noise, relative to the square of the friction at the largest speed. Numbers with seven digits have
/// this variance.
const LEAST_NOISE: f64 = 1e-14;
/// Settling time of the filter, in time constants. After x time constants, the share 1 − (1 + x) e⁻ˣ of a step has passed
/// (0.96).
const SETTLED: f64 = 5.0;
/// Number of consecutive equal torques (bit for bit) after which a sensor counts as stuck or at the end of its range.
const REPEATED: u32 = 5;
/// Time between samples, in time constants of the filter.
const STRIDE: f64 = 3.0;
/// Two-sided 90 % quantile of the normal distribution.
pub(super) const QUANTILE: f64 = 1.645;

/// Settings converted for one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Derived {
    pub bounds: [f64; TERMS],
    pub prior: [f64; TERMS],
    /// Variances of the terms' coefficients before the first sample, averaged over the nested laws.
    pub unknown: [f64; TERMS],
    /// Weight of a new sample in the filter.
    pub weight: f64,
    /// Fraction of the difference to the learned law by which the acting law changes in a period.
    pub blend: f64,
    /// Number of periods between samples.
    pub stride: u32,
    /// Number of periods that the filter takes to settle.
    pub settle: u32,
    /// Time between samples (s).
    pub interval: f64,
    /// Decay factor of leaky sums from one sample to the next.
    pub keep: f64,
    /// Speed below which the joint counts as at rest [rad/s or m/s].
    pub rest: f64,
}

impl Derived {
    pub(super) fn new(settings: &AdaptationSettings, scale: &JointScale) -> Self {
        let bounds = scale.bounds(settings.largest_change);
        let periods =
            |constants: f64| (constants * settings.time_constant / settings.period + 0.5) as u32 + 1;
        let stride = periods(STRIDE);
        let interval = f64::from(stride) * settings.period;
        let prior = bounds.map(|bound| 0.25 * bound * bound);
        let unknown = averaged(&Gaussian::prior(&prior), &prior).covariance;
        Self {
            bounds,
            prior,
            unknown: core::array::from_fn(|k| unknown[k][k]),
            weight: settings.period / (settings.period + settings.time_constant),
            blend: settings.period / (settings.period + settings.blending),
            stride,
            settle: periods(SETTLED),
            interval,
            keep: 1.0 - interval / (settings.memory + interval),
            rest: settings.rest * scale.speed,
        }
    }
}

/// Motion and torques of a joint at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Instant {
    pub position: f64,
    pub velocity: f64,
    /// Described friction without its load-dependent part [N m or N].
    pub friction: f64,
    /// Described load-dependent friction [N m or N].
    pub load_friction: f64,
    /// Drive torques of the periods after and before the instant [N m or N], in this order.
    pub measured: [f64; 2],
    /// Mean of `measured` [N m or N].
    pub applied: f64,
    /// Part of `applied` that the described robot does not explain [N m or N].
    pub torque: f64,
    /// Whether the torque is known. False in saturation.
    pub is_exact: bool,
}

/// A sample of the filtered torque of a joint, with its prediction by the law that was learned before the sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// Filtered values of the [`terms`] of the learned law.
    pub terms: [f64; TERMS],
    /// Filtered torque minus the torque of the described robot, including its friction [N m or N]. It is the prediction error
    /// of the described law.
    pub torque: f64,
    /// Prediction error of the learned law [N m or N].
    pub error: f64,
    /// Whether the sample is within the prediction interval. Samples outside this interval are not used.
    pub is_explained: bool,
}

/// State of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Joint {
    pub filter: LowPass,
    pub bank: Bank,
    pub comparison: Comparison,
    /// Average of the nested laws, which have the first 0, 1, … terms of the learned law.
    pub law: Gaussian,
    /// Coefficients δ of the learned law: mean of `law` within its bounds.
    pub learned: [f64; TERMS],
    /// Coefficients δ of the acting law.
    pub acting: [f64; TERMS],
    pub trust: Trust,
    /// Time of the last change of trust (s).
    pub since: f64,
    /// Sign of the last velocity that was not at rest.
    pub direction: f64,
    /// Last torque [N m or N].
    pub torque: f64,
    /// Number of repetitions of the last torque.
    pub repeated: u32,
    /// Magnitude of the torque at which the sensor is stuck or at the end of its range; `None` if this has not been observed.
    pub stuck: Option<f64>,
    /// Number of periods until the filter has settled.
    pub settling: u32,
    /// Number of periods until the next sample.
    pub waiting: u32,
    /// Sample of the last period; `None` in periods without a sample.
    pub prediction: Option<Prediction>,
}

impl Joint {
    /// Initial state of a joint.
    ///
    /// - `index`: index of the joint. Joints take their samples in different periods, so that the computing time of all periods
    ///   is similar.
    pub(super) fn new(index: usize, derived: &Derived, scale: &JointScale) -> Self {
        let noise = FIRST_NOISE * scale.torque;
        let bank = Bank::new(&derived.prior, noise * noise);
        Self {
            filter: LowPass::ZERO,
            bank,
            comparison: Comparison::NEW,
            law: averaged(&bank.average(), &derived.prior),
            learned: [0.0; TERMS],
            acting: [0.0; TERMS],
            trust: Trust::Unknown,
            since: 0.0,
            direction: 0.0,
            torque: 0.0,
            repeated: 0,
            stuck: None,
            settling: derived.settle,
            waiting: derived.stride + index as u32 % derived.stride,
            prediction: None,
        }
    }

    /// Handles a missing measurement. Samples are not used until the filter has settled again.
    pub(super) fn pause(&mut self, derived: &Derived) {
        self.settling = derived.settle;
        self.bank.pause();
    }

    /// Advances the estimation by a period.
    ///
    /// - `now`: motion and torques; `None` if they are missing
    /// - `time`: time of the period (s)
    pub(super) fn step(
        &mut self,
        settings: &AdaptationSettings,
        derived: &Derived,
        scale: &JointScale,
        now: Option<&Instant>,
        time: f64,
    ) {
        self.prediction = None;
        match now {
            Some(now) => self.take(settings, derived, scale, now),
            None => self.pause(derived),
        }
        let trust = self.comparison.trust(self.dissipates(scale));
        if trust != self.trust {
            (self.trust, self.since) = (trust, time);
        }
        let target = match trust {
            Trust::Learned => self.learned,
            _ => [0.0; TERMS],
        };
        for (acting, target) in self.acting.iter_mut().zip(target) {
            *acting += derived.blend * (target - *acting);
        }
    }

    fn take(&mut self, settings: &AdaptationSettings, derived: &Derived, scale: &JointScale, now: &Instant) {
        let v = now.velocity;
        let direction = if v > derived.rest {
            1.0
        } else if v < -derived.rest {
            -1.0
        } else {
            0.0
        };
        let terms = terms(scale.shape(now.friction, v, derived.rest), v, now.load_friction);
        let others = [now.torque, now.applied];
        let signals = core::array::from_fn(|k| if k < TERMS { terms[k] } else { others[k - TERMS] });
        let filtered = self.filter.take(&signals, derived.weight);
        self.repeated = if now.measured[0] == self.torque { self.repeated.saturating_add(1) } else { 0 };
        self.torque = now.measured[0];
        if self.repeated >= REPEATED {
            self.stuck = Some(self.torque.abs());
        }
        // With noise, a torque near the end of the sensor's range can be clipped in single periods.
        let is_exact = now.is_exact && now.measured.iter().all(|torque| Some(torque.abs()) != self.stuck);
        if direction == 0.0 || direction != self.direction || !is_exact {
            self.pause(derived);
        }
        self.direction = direction;
        self.waiting = self.waiting.saturating_sub(1);
        let is_settled = self.settling == 0;
        self.settling = self.settling.saturating_sub(1);
        if self.waiting > 0 {
            return;
        }
        self.waiting = derived.stride;
        let drift = self.bank.drift(derived.interval, &settings.drift_times, &derived.prior, is_settled);
        if !is_settled {
            // Without a sample the weights of the nested laws must not change. A new average of the wider covariance would change
            // them, so only the covariance of the average is widened.
            self.law.widen(drift, &derived.prior);
            return;
        }
        let phi = core::array::from_fn(|i| filtered[i]);
        let share = now.position / scale.range;
        let [torque, applied] = [filtered[TERMS], filtered[TERMS + 1]];
        let error = torque - dot(&phi, &self.learned);
        self.comparison.whole([error, applied], derived.keep);
        let is_explained = self.learn(settings, derived, scale, &phi, [torque, error], share);
        self.prediction = Some(Prediction { terms: phi, torque, error, is_explained });
        self.average(derived, scale);
    }

    /// Computes the average law over the rates of drift and over the nested laws, which have the first 0, 1,
    /// … terms.
    fn average(&mut self, derived: &Derived, scale: &JointScale) {
        self.law = averaged(&self.bank.average(), &derived.prior);
        self.bound(derived, scale);
    }

    /// Sets the learned law to the average, constrained to its bounds.
    pub(super) fn bound(&mut self, derived: &Derived, scale: &JointScale) {
        self.learned = constrained(&self.law, scale, &derived.bounds, &derived.prior);
    }

    /// Whether the friction of the average law dissipates energy at the largest speed in both directions. Bounds and offset are
    /// ignored. The result is false if the sign of the torque or of the position is wrong.
    fn dissipates(&self, scale: &JointScale) -> bool {
        let described = if scale.is_described { scale.torque } else { 0.0 };
        let [along, viscous, _, asymmetry, _] = terms(scale.torque, scale.speed, 0.0);
        [1.0, -1.0]
            .iter()
            .all(|side| described + dot(&[along, viscous, 0.0, side * asymmetry, 0.0], &self.law.mean) > 0.0)
    }

    /// Learns from a sample. `error` is the prediction error of the learned law. Returns false without learning if the sample
    /// is outside the prediction interval.
    fn learn(
        &mut self,
        settings: &AdaptationSettings,
        derived: &Derived,
        scale: &JointScale,
        phi: &[f64; TERMS],
        [torque, error]: [f64; 2],
        share: f64,
    ) -> bool {
        let variance = self.law.variance(phi) + self.bank.noise;
        if error * error > GATE * GATE * variance {
            self.comparison.exclude();
            self.bank.widen(derived.interval / settings.patience, &derived.prior);
            self.bank.pause();
            return false;
        }
        self.comparison.take([torque, error]);
        let sample = Sample { phi: *phi, torque, share, forwards: self.direction > 0.0 };
        self.bank.update(&sample, derived.keep, LEAST_NOISE * scale.torque * scale.torque);
        true
    }

    /// Half width of the 90 % confidence interval of the learned friction at a velocity [N m or N].
    ///
    /// - `phi`: [`terms`] at this velocity
    pub(super) fn half_width(&self, phi: &[f64; TERMS]) -> f64 {
        QUANTILE * root(self.law.variance(phi))
    }

    /// Half width of the 90 % confidence interval of each coefficient δ.
    pub(super) fn term_half_widths(&self) -> [f64; TERMS] {
        core::array::from_fn(|i| QUANTILE * root(self.law.covariance[i][i].max(0.0)))
    }
}
