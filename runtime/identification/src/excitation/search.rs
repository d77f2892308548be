//! The search for the motion with the smallest score, by an evolution strategy.

use super::super::error::{Result, require_setting};
use super::super::numeric::random::SplitMix64;
use super::super::numeric::spectrum::symmetric_eigenvalues;
use super::{FourierMotion, Instant, levels};
use nalgebra::DMatrix;

/// Limits of one coordinate of the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ExcitationLimits {
    /// Lowest and highest position [rad or m].
    pub position: [f64; 2],
    /// Largest speed [rad/s or m/s].
    pub velocity: f64,
    /// Largest acceleration [rad/s² or m/s²].
    pub acceleration: f64,
}

/// Settings of the search for an exciting motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Excitation {
    /// Period T of the motion \[s\].
    pub period: f64,
    /// Number of harmonics of the motion's Fourier series. The first harmonic has the frequency 1/T.
    pub harmonics: usize,
    /// Number of equidistant times of a period at which limits and regressor are evaluated.
    pub samples: usize,
    /// Number of random motions from which the search starts.
    pub starts: usize,
    /// Number of candidate motions that are tried from each start.
    pub iterations: usize,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Default for Excitation {
    fn default() -> Self {
        Self { period: 10.0, harmonics: 5, samples: 200, starts: 4, iterations: 1000, seed: 1 }
    }
}

/// The motion with the smallest score, its score, and the smallest score of the random starts.
#[derive(Debug, PartialEq)]
pub(super) struct Best {
    pub motion: FourierMotion,
    pub score: f64,
    pub start: f64,
    /// Size of the motion, as a share of the size that the limits allow.
    pub size: f64,
}

impl Excitation {
    /// Searches the motion with the smallest score; `None` if every score is infinite.
    ///
    /// - `score`: score of a motion from its states at equidistant times; infinite if the motion is not possible
    /// - `restrict`: linear map of a motion to a motion of the requested kind
    /// - `narrow`: changes a motion within the limits so that it also keeps other limits
    ///
    /// A start with an infinite score is scaled down until its score is finite. All motions that are derived from this start
    /// have the same size.
    pub(super) fn minimize(
        &self,
        limits: &[ExcitationLimits],
        mut score: impl FnMut(&[Instant]) -> f64,
        restrict: impl Fn(FourierMotion) -> FourierMotion,
        narrow: impl Fn(&mut FourierMotion),
    ) -> Result<Option<Best>> {
        self.check(limits)?;
        let mut random = SplitMix64::new(self.seed);
        let mut fitted = |motion: FourierMotion, size: f64| {
            let mut motion = restrict(motion);
            motion.fit_into(limits, self.samples);
            motion.shrink(size);
            narrow(&mut motion);
            let score = score(&motion.instants(self.samples));
            (motion, score)
        };
        let mut best: Option<Best> = None;
        let mut start = f64::INFINITY;
        for _ in 0..self.starts {
            let (size, (motion, score)) =
                possible(&self.random_motion(limits.len(), &mut random), &mut fitted);
            start = start.min(score);
            let (motion, score) = self.improve(size, motion, score, limits, &mut random, &mut fitted);
            if best.as_ref().is_none_or(|b| score < b.score) {
                best = Some(Best { motion, score, start, size });
            }
        }
        Ok(best.filter(|best| best.score < f64::INFINITY).map(|best| Best { start, ..best }))
    }

    fn check(&self, limits: &[ExcitationLimits]) -> Result<()> {
        require_setting("period", self.period, self.period > 0.0, "it must be positive")?;
        let counts = [("number of harmonics", self.harmonics), ("number of starts", self.starts)];
        for (name, count) in counts {
            require_setting(name, count as f64, count >= 1, "at least one is needed")?;
        }
        require_setting(
            "number of instants",
            self.samples as f64,
            self.samples >= 8 * self.harmonics,
            "the highest harmonic needs at least eight instants per oscillation",
        )?;
        for (i, limit) in limits.iter().enumerate() {
            let [low, high] = limit.position;
            let range = high - low;
            require_setting(
                &format!("range of positions of joint {}", i + 1),
                range,
                range > 0.0 && low.is_finite() && high.is_finite(),
                "it must be positive and finite. Give bounds to joints without limits",
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

    fn random_motion(&self, joints: usize, random: &mut SplitMix64) -> FourierMotion {
        let mut pairs = || {
            let pair = |k: usize| [random.normal(), random.normal()].map(|x| x / (k + 1) as f64);
            (0..self.harmonics).map(pair).collect()
        };
        let coefficients = (0..joints).map(|_| pairs()).collect();
        FourierMotion { period: self.period, center: vec![0.0; joints], coefficients }
    }

    fn improve(
        &self,
        size: f64,
        mut motion: FourierMotion,
        mut score: f64,
        limits: &[ExcitationLimits],
        random: &mut SplitMix64,
        fitted: &mut impl FnMut(FourierMotion, f64) -> Scored,
    ) -> Scored {
        // The step is in units of each joint's range. 1/5 rule: a success lengthens the step by as much as four failures
        // shorten it.
        let mut step = 0.1 * size;
        for _ in 0..self.iterations {
            let mut child = motion.clone();
            for (pairs, limit) in child.coefficients.iter_mut().zip(limits) {
                let range = limit.position[1] - limit.position[0];
                for (k, pair) in pairs.iter_mut().enumerate() {
                    *pair = pair.map(|x| x + step * range * random.normal() / (k + 1) as f64);
                }
            }
            let (child, new) = fitted(child, size);
            if new < score {
                (motion, score) = (child, new);
                step *= 1.5;
            } else {
                step *= 1.5_f64.powf(-0.25);
            }
        }
        (motion, score)
    }
}

/// A motion with its score.
type Scored = (FourierMotion, f64);

/// The largest tried size at which a motion is possible, and the motion of this size; the full size if the motion is not
/// possible at any size.
fn possible(motion: &FourierMotion, fitted: &mut impl FnMut(FourierMotion, f64) -> Scored) -> (f64, Scored) {
    let first = fitted(motion.clone(), 1.0);
    let factor = 1.0 - levels::SMALLER.get();
    let sizes = std::iter::successors(Some(factor), |size| Some(size * factor));
    let smaller = sizes.take_while(|size| first.1 == f64::INFINITY && *size >= levels::SMALLEST.get());
    let mut tried = smaller.map(|size| (size, fitted(motion.clone(), size)));
    tried.find(|(_, (_, score))| *score < f64::INFINITY).unwrap_or((1.0, first))
}

/// Condition number of a regressor whose columns are scaled to unit length, from its Gram matrix; infinite if columns are
/// dependent.
pub(super) fn condition_of_scaled(gram: &DMatrix<f64>) -> f64 {
    let norms: Vec<f64> = gram.diagonal().iter().map(|square| square.sqrt()).collect();
    if norms.iter().any(|n| *n <= 0.0 || !n.is_finite()) {
        return f64::INFINITY;
    }
    let n = norms.len();
    let scaled = DMatrix::from_fn(n, n, |i, j| gram[(i, j)] / (norms[i] * norms[j]));
    let eigenvalues = symmetric_eigenvalues(&scaled);
    // If the eigenvalue is smaller, the Gram matrix has no significant digit left.
    match eigenvalues.min() {
        least if least > 1e-14 => (eigenvalues.max() / least).sqrt(),
        _ => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: [ExcitationLimits; 2] = [
        ExcitationLimits { position: [-1.0, 1.5], velocity: 1.5, acceleration: 4.0 },
        ExcitationLimits { position: [-2.0, 2.0], velocity: 2.0, acceleration: 6.0 },
    ];

    /// Planar arm with two joints, linear in (J1, J2, h, g1, g2): design of the reduced PowerCube.
    fn planar(y: &[f64], v: &[f64], a: &[f64], out: &mut [f64]) {
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

    /// The motion with the smallest condition number of a regressor with rows of `columns` entries.
    fn searched(
        settings: &Excitation,
        limits: &[ExcitationLimits],
        [rows, columns]: [usize; 2],
        regressor: impl Fn(&[f64], &[f64], &[f64], &mut [f64]),
    ) -> Result<Option<Best>> {
        let condition = |instants: &[Instant]| {
            let mut matrix = DMatrix::zeros(columns, rows * instants.len());
            let parts = matrix.as_mut_slice().chunks_exact_mut(rows * columns);
            parts.zip(instants).for_each(|(out, [y, v, a])| regressor(y, v, a, out));
            condition_of_scaled(&(&matrix * matrix.transpose()))
        };
        settings.minimize(limits, condition, |motion| motion, |_| {})
    }

    #[test]
    fn the_search_lowers_the_condition_number_within_the_limits() {
        let settings = Excitation { iterations: 400, ..Default::default() };
        let found = searched(&settings, &LIMITS, [2, 5], planar).unwrap().unwrap();
        println!("condition {} from {}", found.score, found.start);
        assert!(found.start > 2.0 && found.score < 1.5);
        for i in 0..5000 {
            let [y, v, a] = found.motion.instant(0.002 * f64::from(i));
            for j in 0..2 {
                let limit = LIMITS[j];
                assert!(limit.position[0] - 1e-2 < y[j] && y[j] < limit.position[1] + 1e-2);
                assert!(v[j].abs() < limit.velocity && a[j].abs() < limit.acceleration);
            }
        }
        assert_eq!(Some(found), searched(&settings, &LIMITS, [2, 5], planar).unwrap());
    }

    #[test]
    fn velocities_and_accelerations_are_derivatives() {
        let motion = Excitation::default().random_motion(2, &mut SplitMix64::new(3));
        for i in 0..50 {
            let t = 0.2 * f64::from(i);
            let [before, now, after] = [t - 1e-5, t, t + 1e-5].map(|t| motion.instant(t));
            for j in 0..2 {
                assert!(((after[0][j] - before[0][j]) / 2e-5 - now[1][j]).abs() < 1e-6);
                assert!(((after[1][j] - before[1][j]) / 2e-5 - now[2][j]).abs() < 1e-5);
            }
        }
    }

    /// If the starts are too fast, the search continues from smaller starts, and the motion grows to the largest possible size.
    #[test]
    fn a_search_whose_starts_are_impossible_begins_smaller() {
        let settings = Excitation { iterations: 100, starts: 2, ..Default::default() };
        let fastest = |instants: &[Instant]| {
            let speeds = instants.iter().flat_map(|[_, v, _]| v).map(|v| v.abs());
            speeds.fold(0.0, f64::max)
        };
        let found = |most: f64| {
            let score = |instants: &[Instant]| match fastest(instants) {
                speed if speed > most => f64::INFINITY,
                speed => -speed,
            };
            settings.minimize(&LIMITS, score, |motion| motion, |_| {}).unwrap()
        };
        assert_eq!(found(10.0).unwrap().size, 1.0, "all is possible");
        let small = found(0.4).unwrap();
        assert!(small.size < 0.7 && small.score <= -0.32, "{} {}", small.size, small.score);
        assert!(fastest(&small.motion.instants(settings.samples)) <= 0.4);
        assert!(found(0.01).is_none(), "smaller than a tenth is not tried");
    }

    #[test]
    fn dependent_columns_and_bad_settings_have_messages() {
        let short = Excitation { iterations: 5, ..Default::default() };
        let twice = |_: &[f64], _: &[f64], a: &[f64], out: &mut [f64]| {
            out.copy_from_slice(&[a[0], 2.0 * a[0]]);
        };
        assert_eq!(searched(&short, &LIMITS, [1, 2], twice).unwrap(), None);
        let mut endless = LIMITS;
        endless[1].position = [f64::NEG_INFINITY, f64::INFINITY];
        let message = searched(&short, &endless, [2, 5], planar).unwrap_err().to_string();
        assert!(message.starts_with("range of positions of joint 2 = inf"), "{message}");
        let few = Excitation { samples: 10, ..short };
        let message = searched(&few, &LIMITS, [2, 5], planar).unwrap_err().to_string();
        assert!(message.starts_with("number of instants = 10"), "{message}");
    }
}
