//! Excitation: periodic motions that show the parameters well, within the robot's limits.
//!
//! `yᵢ(t) = cᵢ + Σₖ aᵢₖ sin(k ω t) + bᵢₖ cos(k ω t)` (Swevers et al. 1997). The condition number of the
//! regressor, columns scaled to unit length, is minimized over the coefficients (Gautier and Khalil 1992) by
//! an evolution strategy with one parent and one child and adapted step (Rechenberg's 1/5 rule) from several
//! starts. Every candidate is first shrunk and shifted into the limits, so each is a motion that the robot
//! can make; the search needs no derivatives of the regressor and finds a good motion, not a proven best one.

use super::error::{IdentificationError, Result, require_length, require_samples, require_setting};
use super::random::SplitMix64;
use nalgebra::DMatrix;
use std::f64::consts::TAU;

/// Limits of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExcitationLimits {
    /// Lowest and highest position [rad or m].
    pub position: [f64; 2],
    /// Highest speed.
    pub velocity: f64,
    /// Highest acceleration.
    pub acceleration: f64,
}

/// Settings of the search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Excitation {
    /// Period T of the motion (s); ω = 2π/T.
    pub period: f64,
    /// Number of harmonics.
    pub harmonics: usize,
    /// Instants at which limits and regressor are evaluated.
    pub samples: usize,
    /// Random starts.
    pub starts: usize,
    /// Candidates tried from each start.
    pub iterations: usize,
    /// Seed.
    pub seed: u64,
}

impl Default for Excitation {
    fn default() -> Self {
        Self { period: 10.0, harmonics: 5, samples: 200, starts: 4, iterations: 1000, seed: 1 }
    }
}

/// A periodic motion of `N` joints.
#[derive(Debug, Clone, PartialEq)]
pub struct FourierMotion<const N: usize> {
    /// T (s).
    pub period: f64,
    /// cᵢ.
    pub center: [f64; N],
    /// (aᵢₖ, bᵢₖ) for k = 1, 2, ….
    pub coefficients: [Vec<[f64; 2]>; N],
}

/// Result of the search.
#[derive(Debug, Clone, PartialEq)]
pub struct ExcitationResult<const N: usize> {
    /// The motion.
    pub motion: FourierMotion<N>,
    /// Condition number of the regressor along it, columns scaled to unit length.
    pub condition: f64,
    /// The same for the best of the random starts, before the search.
    pub start: f64,
}

impl<const N: usize> FourierMotion<N> {
    /// y, ẏ, ÿ at time `t`.
    pub fn at(&self, t: f64) -> [[f64; N]; 3] {
        let mut out = [self.center, [0.0; N], [0.0; N]];
        for i in 0..N {
            for (k, [a, b]) in self.coefficients[i].iter().enumerate() {
                let rate = TAU * (k + 1) as f64 / self.period;
                let (s, c) = (rate * t).sin_cos();
                out[0][i] += a * s + b * c;
                out[1][i] += rate * (a * c - b * s);
                out[2][i] -= rate * rate * (a * s + b * c);
            }
        }
        out
    }

    fn instants(&self, samples: usize) -> Vec<[[f64; N]; 3]> {
        let step = self.period / samples as f64;
        (0..samples).map(|i| self.at(step * i as f64)).collect()
    }

    /// Shrinks and shifts each joint so that the limits hold at the sampled instants, and one of them just
    /// so.
    fn fit_into(&mut self, limits: &[ExcitationLimits; N], samples: usize) {
        self.center = [0.0; N];
        let instants = self.instants(samples);
        for i in 0..N {
            let largest = |k: usize| instants.iter().map(|x| x[k][i].abs()).fold(0.0, f64::max);
            let (low, high) = instants
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x[0][i]), b.max(x[0][i])));
            let [lowest, highest] = limits[i].position;
            let factor = ((highest - lowest) / (high - low))
                .min(limits[i].velocity / largest(1))
                .min(limits[i].acceleration / largest(2));
            // Between the instants the motion may exceed what is seen there by a little: (ω T/samples)²/8 per
            // harmonic.
            let factor = if factor.is_finite() { 0.995 * factor } else { 0.0 };
            for pair in &mut self.coefficients[i] {
                *pair = pair.map(|x| x * factor);
            }
            self.center[i] = 0.5 * (lowest + highest) - 0.5 * factor * (low + high);
        }
    }
}

impl Excitation {
    /// Searches a motion with a small condition number.
    ///
    /// - `regressor`: writes the rows at one instant, `rows` of them with `columns` entries each, row by row,
    ///   for y, ẏ, ÿ; base parameters only, as dependent columns have no finite condition number
    ///
    /// # Errors
    /// Settings or limits out of range, or a regressor whose columns stay dependent along every motion tried.
    pub fn search<const N: usize>(
        &self,
        limits: &[ExcitationLimits; N],
        [rows, columns]: [usize; 2],
        mut regressor: impl FnMut(&[f64; N], &[f64; N], &[f64; N], &mut [f64]),
    ) -> Result<ExcitationResult<N>> {
        self.check(limits)?;
        require_samples("the excitation", columns, rows * self.samples)?;
        require_length("columns of the regressor, at least one", columns.max(1), columns)?;
        let mut condition = |motion: &FourierMotion<N>| {
            let mut matrix = DMatrix::zeros(columns, rows * self.samples);
            for (instant, out) in motion
                .instants(self.samples)
                .iter()
                .zip(matrix.as_mut_slice().chunks_exact_mut(rows * columns))
            {
                regressor(&instant[0], &instant[1], &instant[2], out);
            }
            scaled_condition(&matrix)
        };
        let mut random = SplitMix64::new(self.seed);
        let mut best: Option<ExcitationResult<N>> = None;
        let mut start = f64::INFINITY;
        for _ in 0..self.starts {
            let first = self.random_motion(limits, &mut random);
            let value = condition(&first);
            start = start.min(value);
            let (motion, condition) = self.improve(first, value, limits, &mut random, &mut condition);
            if best.as_ref().is_none_or(|b| condition < b.condition) {
                best = Some(ExcitationResult { motion, condition, start });
            }
        }
        match best {
            Some(best) if best.condition.is_finite() => Ok(ExcitationResult { start, ..best }),
            _ => Err(IdentificationError::NotConverged {
                what: "the search for an excitation".into(),
                iterations: self.starts * self.iterations,
                detail: format!(
                    "the {columns} columns of the regressor are dependent along every motion tried: use base parameters"
                ),
            }),
        }
    }

    fn check<const N: usize>(&self, limits: &[ExcitationLimits; N]) -> Result<()> {
        require_setting("period", self.period, self.period > 0.0, "it must be positive")?;
        let counts = [("number of harmonics", self.harmonics), ("number of starts", self.starts)];
        for (name, count) in counts {
            require_setting(name, count as f64, count >= 1, "at least one is needed")?;
        }
        require_setting(
            "number of instants",
            self.samples as f64,
            self.samples >= 8 * self.harmonics,
            "the highest harmonic needs at least eight per oscillation",
        )?;
        for (i, limit) in limits.iter().enumerate() {
            let [low, high] = limit.position;
            let range = high - low;
            require_setting(
                &format!("range of positions of joint {}", i + 1),
                range,
                range > 0.0 && low.is_finite() && high.is_finite(),
                "it must be positive and finite; give bounds to joints without limits",
            )?;
            let others = [("velocity", limit.velocity), ("acceleration", limit.acceleration)];
            for (name, value) in others {
                require_setting(
                    &format!("highest {name} of joint {}", i + 1),
                    value,
                    value > 0.0,
                    "it must be positive and finite",
                )?;
            }
        }
        Ok(())
    }

    fn random_motion<const N: usize>(
        &self,
        limits: &[ExcitationLimits; N],
        random: &mut SplitMix64,
    ) -> FourierMotion<N> {
        let mut motion = FourierMotion {
            period: self.period,
            center: [0.0; N],
            coefficients: std::array::from_fn(|_| {
                let pair = |k: usize| [random.normal(), random.normal()].map(|x| x / (k + 1) as f64);
                (0..self.harmonics).map(pair).collect()
            }),
        };
        motion.fit_into(limits, self.samples);
        motion
    }

    fn improve<const N: usize>(
        &self,
        mut motion: FourierMotion<N>,
        mut value: f64,
        limits: &[ExcitationLimits; N],
        random: &mut SplitMix64,
        condition: &mut impl FnMut(&FourierMotion<N>) -> f64,
    ) -> (FourierMotion<N>, f64) {
        // Step in units of each joint's range. 1/5 rule: a success lengthens the step as much as four
        // failures shorten it.
        let mut step = 0.1;
        for _ in 0..self.iterations {
            let mut child = motion.clone();
            for (pairs, limit) in child.coefficients.iter_mut().zip(limits) {
                let range = limit.position[1] - limit.position[0];
                for (k, pair) in pairs.iter_mut().enumerate() {
                    *pair = pair.map(|x| x + step * range * random.normal() / (k + 1) as f64);
                }
            }
            child.fit_into(limits, self.samples);
            let new = condition(&child);
            if new < value {
                (motion, value) = (child, new);
                step *= 1.5;
            } else {
                step *= 1.5_f64.powf(-0.25);
            }
        }
        (motion, value)
    }
}

/// Condition number of the transposed matrix with its columns (here: rows) scaled to unit length.
fn scaled_condition(transposed: &DMatrix<f64>) -> f64 {
    let norms: Vec<f64> = transposed.row_iter().map(|r| r.norm()).collect();
    if norms.iter().any(|n| *n <= 0.0 || !n.is_finite()) {
        return f64::INFINITY;
    }
    let gram = transposed * transposed.transpose();
    let n = norms.len();
    let scaled = DMatrix::from_fn(n, n, |i, j| gram[(i, j)] / (norms[i] * norms[j]));
    let eigenvalues = scaled.symmetric_eigenvalues();
    // Below this the Gram matrix has no digit left.
    if eigenvalues.min() <= 1e-14 {
        return f64::INFINITY;
    }
    (eigenvalues.max() / eigenvalues.min()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: [ExcitationLimits; 2] = [
        ExcitationLimits { position: [-1.0, 1.5], velocity: 1.5, acceleration: 4.0 },
        ExcitationLimits { position: [-2.0, 2.0], velocity: 2.0, acceleration: 6.0 },
    ];

    /// Planar arm with two joints, linear in (J1, J2, h, g1, g2): design of the reduced PowerCube.
    fn planar(y: &[f64; 2], v: &[f64; 2], a: &[f64; 2], out: &mut [f64]) {
        let (s, c) = y[1].sin_cos();
        let second = (y[0] + y[1]).sin();
        out.copy_from_slice(&[
            a[0],
            a[1],
            c * (2.0 * a[0] + a[1]) - s * (2.0 * v[0] * v[1] + v[1] * v[1]),
            -y[0].sin(),
            -second,
            0.0,
            a[0] + a[1],
            c * a[0] + s * v[0] * v[0],
            0.0,
            -second,
        ]);
    }

    #[test]
    fn the_search_lowers_the_condition_number_within_the_limits() {
        let settings = Excitation { iterations: 400, ..Default::default() };
        let found = settings.search(&LIMITS, [2, 5], planar).unwrap();
        println!("condition {} from {}", found.condition, found.start);
        assert!(found.start > 2.0 && found.condition < 1.5);
        for i in 0..5000 {
            let [y, v, a] = found.motion.at(0.002 * f64::from(i));
            for j in 0..2 {
                let limit = LIMITS[j];
                assert!(limit.position[0] - 1e-2 < y[j] && y[j] < limit.position[1] + 1e-2);
                assert!(v[j].abs() < limit.velocity && a[j].abs() < limit.acceleration);
            }
        }
        assert_eq!(found, settings.search(&LIMITS, [2, 5], planar).unwrap());
    }

    #[test]
    fn velocities_and_accelerations_are_derivatives() {
        let motion = Excitation::default().random_motion(&LIMITS, &mut SplitMix64::new(3));
        for i in 0..50 {
            let t = 0.2 * f64::from(i);
            let [before, now, after] = [t - 1e-5, t, t + 1e-5].map(|t| motion.at(t));
            for j in 0..2 {
                assert!(((after[0][j] - before[0][j]) / 2e-5 - now[1][j]).abs() < 1e-6);
                assert!(((after[1][j] - before[1][j]) / 2e-5 - now[2][j]).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn dependent_columns_and_bad_settings_have_messages() {
        let short = Excitation { iterations: 5, ..Default::default() };
        let twice = |_: &[f64; 2], _: &[f64; 2], a: &[f64; 2], out: &mut [f64]| {
            out.copy_from_slice(&[a[0], 2.0 * a[0]]);
        };
        let message = short.search(&LIMITS, [1, 2], twice).unwrap_err().to_string();
        assert!(message.contains("the 2 columns of the regressor are dependent"), "{message}");
        let mut endless = LIMITS;
        endless[1].position = [f64::NEG_INFINITY, f64::INFINITY];
        let message = short.search(&endless, [2, 5], planar).unwrap_err().to_string();
        assert!(message.starts_with("range of positions of joint 2 = inf"), "{message}");
        let few = Excitation { samples: 10, ..short };
        let message = few.search(&LIMITS, [2, 5], planar).unwrap_err().to_string();
        assert!(message.starts_with("number of instants = 10"), "{message}");
    }
}
