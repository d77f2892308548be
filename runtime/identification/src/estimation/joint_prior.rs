//! Prior knowledge of the friction and the offset of a joint.
//!
//! If a joint moves in one direction only, its Coulomb friction and a constant error of its force have the same column. The
//! data then determine only the sum of the two. The standard deviations of this prior divide the sum between friction and
//! offset.

use super::super::robot::Robot;
use super::super::run::PreparedRun;
use super::layout::{ASYMMETRY, COULOMB, Layout, VISCOUS, fast_speed};
use super::levels;

/// Prior of the friction and the offset of one joint, with standard deviations.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct JointPrior {
    /// Described factors of the viscous and the Coulomb term, for each width of the Coulomb term.
    factors: [[f64; 2]; COULOMB.end - COULOMB.start],
    /// Standard deviation of the friction at the fast speed [N·m or N]; infinite if nothing is known.
    spread: f64,
    /// Fast speed of the joint in the data: 95 % of the samples do not exceed it [rad/s or m/s].
    fast: f64,
    /// Standard deviation of an offset [N·m or N].
    offset: f64,
    /// Number of correlated samples that count as one independent sample.
    pub(super) time: f64,
}

impl JointPrior {
    /// The prior of each joint. If the description has no effort limit of a joint, the largest measured force replaces it.
    pub(super) fn all(robot: &dyn Robot, layout: &Layout, runs: &[PreparedRun]) -> Vec<Self> {
        let limits = robot.limits();
        let of_joint = |joint: usize| {
            let fast = fast_speed(runs, joint);
            let limit = limits.get(joint).map_or(f64::INFINITY, |limits| limits.effort);
            let largest = if limit.is_finite() { limit } else { largest(layout, runs, joint) };
            let odd = |v: f64| 0.5 * (robot.friction(joint, v) - robot.friction(joint, -v));
            Self {
                factors: layout.steepness[joint].map(|k| projected(&odd, fast, k)),
                spread: (levels::DESCRIBED_FRICTION.get() * odd(fast).abs())
                    .max(levels::LEAST_FRICTION.get() * largest),
                fast,
                offset: levels::OFFSET.get() * largest,
                time: 1.0,
            }
        };
        (0..layout.joints).map(of_joint).collect()
    }

    /// Described factor of a term and the inverse of its variance; zeros if nothing is known of the term.
    ///
    /// - `width`: index of the chosen width of the Coulomb term
    pub(super) fn term(&self, term: usize, width: usize) -> [f64; 2] {
        let precision = if self.spread > 0.0 { self.spread.powi(-2) } else { 0.0 };
        let [viscous, coulomb] = self.factors[width];
        match term {
            VISCOUS => [viscous, precision * self.fast.powi(2)],
            ASYMMETRY => [0.0, precision * self.fast.powi(2)],
            _ if COULOMB.contains(&term) => [coulomb, precision],
            _ => [0.0; 2],
        }
    }

    /// Weight of the prior that the offset is zero, as a number of samples with zero force. The variance of this prior is the
    /// sum of [`Self::offset`] squared and of the variance of the residual, because a part of the residual may be constant.
    ///
    /// - `deviation`: standard deviation of the residual of one sample [N·m or N]
    pub(super) fn samples_of_offset(&self, deviation: f64) -> f64 {
        let spread = self.offset.hypot(deviation);
        if self.offset > 0.0 { self.time * (deviation / spread).powi(2) } else { 0.0 }
    }

    /// Weight of the prior of an offset whose standard deviation is larger by the factor
    /// [`levels::LARGER_OFFSET`].
    ///
    /// - `samples`: weight for the usual standard deviation, as a number of samples
    pub(super) fn fewer(samples: f64) -> f64 {
        samples / levels::LARGER_OFFSET.get().powi(2)
    }
}

/// Largest force that was measured at a joint; zero if the effort is a current with an unknown gain.
fn largest(layout: &Layout, runs: &[PreparedRun], joint: usize) -> f64 {
    if !layout.known_gains[joint] || !layout.measured[joint] {
        return 0.0;
    }
    let of_run = |run: &PreparedRun| {
        let forces = (0..run.times.len()).map(|i| run.force(&layout.input_matrix, joint, i).abs());
        forces.fold(0.0, f64::max)
    };
    runs.iter().map(of_run).fold(0.0, f64::max)
}

/// Factors of v and tanh(k v), with the velocity v, that approximate a friction law by least squares at
/// speeds up to the fast speed.
fn projected(law: &dyn Fn(f64) -> f64, fast: f64, k: f64) -> [f64; 2] {
    let mut sums = [[0.0; 3]; 2];
    for i in 1..=levels::SPEEDS.get() {
        let v = fast * i as f64 / levels::SPEEDS.get() as f64;
        let columns = [v / fast, (k * v).tanh(), law(v)];
        for (row, a) in sums.iter_mut().zip(columns) {
            row.iter_mut().zip(columns).for_each(|(sum, b)| *sum += a * b);
        }
    }
    let [[a, b, p], [_, c, q]] = sums;
    let determinant = a * c - b * b;
    [(c * p - b * q) / (determinant * fast), (a * q - b * p) / determinant]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_of_both_terms_has_their_factors() {
        for k in [7.0, 40.0] {
            let [viscous, coulomb] = projected(&|v| 4.0 * v + 3.0 * (k * v).tanh(), 1.3, k);
            assert!((viscous - 4.0).abs() < 1e-9 && (coulomb - 3.0).abs() < 1e-9, "{viscous} {coulomb}");
        }
    }
}
