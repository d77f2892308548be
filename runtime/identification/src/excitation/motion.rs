//! Periodic motions as sums of sines and cosines.

use super::super::numeric::statistics::extremes;
use super::super::robot::Instant;
use super::ExcitationLimits;
use std::f64::consts::TAU;

/// A periodic motion of any number of joints, `yᵢ(t) = cᵢ + Σₖ aᵢₖ sin(k ω t) + bᵢₖ cos(k ω t)` with the
/// centres cᵢ, the coefficients aᵢₖ and bᵢₖ of harmonic k, and the frequency ω.
#[derive(Debug, Clone, PartialEq)]
pub struct FourierMotion {
    /// Period T of the motion \[s\]. The first harmonic has the frequency ω = 2π/T.
    pub period: f64,
    /// Centre cᵢ of each joint [rad or m].
    pub center: Vec<f64>,
    /// Coefficients (aᵢₖ, bᵢₖ) for k = 1, 2, …, for each joint [rad or m].
    pub coefficients: Vec<Vec<[f64; 2]>>,
}

impl FourierMotion {
    /// y, ẏ, ÿ of joint `i` at time `t` [s].
    fn joint_at(&self, i: usize, t: f64) -> [f64; 3] {
        let mut out = [self.center[i], 0.0, 0.0];
        for (k, [a, b]) in self.coefficients[i].iter().enumerate() {
            let rate = TAU * (k + 1) as f64 / self.period;
            let (s, c) = (rate * t).sin_cos();
            out[0] += a * s + b * c;
            out[1] += rate * (a * c - b * s);
            out[2] -= rate * rate * (a * s + b * c);
        }
        out
    }

    /// Returns positions y, velocities ẏ and accelerations ÿ of all joints at the time `t` \[s\], in this order.
    pub fn instant(&self, t: f64) -> Instant {
        let joints: Vec<[f64; 3]> = (0..self.center.len()).map(|i| self.joint_at(i, t)).collect();
        std::array::from_fn(|k| joints.iter().map(|joint| joint[k]).collect())
    }

    /// States of the motion at `samples` equidistant times of a period.
    pub(crate) fn instants(&self, samples: usize) -> Vec<Instant> {
        let step = self.period / samples as f64;
        (0..samples).map(|i| self.instant(step * i as f64)).collect()
    }

    /// Changes the first harmonic so that the motion is at rest without acceleration at the start of each period: Σ k aₖ = 0
    /// and Σ k² bₖ = 0.
    pub(super) fn start_at_rest(&mut self) {
        for pairs in &mut self.coefficients {
            let order = |k: usize| (k + 1) as f64;
            let velocity: f64 = pairs.iter().enumerate().map(|(k, [a, _])| order(k) * a).sum();
            let acceleration: f64 = pairs.iter().enumerate().map(|(k, [_, b])| order(k) * order(k) * b).sum();
            if let Some([a, b]) = pairs.first_mut() {
                *a -= velocity;
                *b -= acceleration;
            }
        }
    }

    /// Scales the motion of all joints about their centres by `size`.
    pub(super) fn shrink(&mut self, size: f64) {
        let pairs = self.coefficients.iter_mut().flatten();
        pairs.flatten().for_each(|x| *x *= size);
    }

    /// Scales and shifts the motion of each joint. The limits then hold at the sampled times, and the motion
    /// nearly reaches one of them.
    pub(super) fn fit_into(&mut self, limits: &[ExcitationLimits], samples: usize) {
        self.center.fill(0.0);
        let instants = self.instants(samples);
        for i in 0..limits.len() {
            let largest = |k: usize| instants.iter().map(|x| x[k][i].abs()).fold(0.0, f64::max);
            let [low, high] = extremes(instants.iter().map(|x| x[0][i]));
            let [lowest, highest] = limits[i].position;
            let factor = ((highest - lowest) / (high - low))
                .min(limits[i].velocity / largest(1))
                .min(limits[i].acceleration / largest(2));
            // Between the sampled times the motion may exceed the limits slightly: by (ω T/samples)²/8 per harmonic.
            let factor = if factor.is_finite() { 0.995 * factor } else { 0.0 };
            for pair in &mut self.coefficients[i] {
                *pair = pair.map(|x| x * factor);
            }
            self.center[i] = 0.5 * (lowest + highest) - 0.5 * factor * (low + high);
        }
    }
}
