//! Smooth motions through inconsistent samples.

use super::polynomial::Quintic;
use super::{GeodesicMotion, Recording, Sample, Sampled, TrajectoryError};
use crate::dynamics::Dynamics;
use nalgebra::{Matrix3, Vector3};

/// Settings of [`Recording::smoothed`], which weigh the distance from the samples against smoothness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smoothing {
    /// Time constant τ of the smoothing (s), 1 to 20 periods. Parts of the motion that are faster than τ are smoothed.
    pub time_constant: f64,
    /// Correction time ρ (s), from the time constant to 1000 s. If positions contradict the velocities, the
    /// motion follows the velocities and returns to the positions within about this time. Has no effect if
    /// the recording has no velocities.
    pub correction_time: f64,
}

impl Smoothing {
    /// Settings for samples with the given `period` (s): a time constant of two periods, and a correction time of half a second, or of
    /// two periods if they are longer. The settings are suitable for computed samples, which have no noise but can be inconsistent.
    /// Use a longer time constant for measured samples.
    #[must_use]
    pub fn of(period: f64) -> Self {
        Self { time_constant: 2.0 * period, correction_time: 0.5_f64.max(2.0 * period) }
    }
}

/// A smoothed recording, with its deviation from the recorded samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed<const N: usize> {
    /// Motion from rest to rest, with the period of the recording.
    pub trajectory: Sampled<N>,
    /// Largest distance from a recorded position for each coordinate [rad or m].
    pub position_deviation: [f64; N],
    /// Largest distance from a recorded velocity for each coordinate [rad/s or m/s]; 0 without recorded velocities.
    pub velocity_deviation: [f64; N],
}

/// A smoothed recording of a robot with quaternions, with its deviation from the recorded samples.
#[derive(Debug, Clone, PartialEq)]
pub struct SmoothedPoses<D, const N: usize, const M: usize, const NY: usize> {
    /// Motion from rest to rest.
    pub trajectory: GeodesicMotion<D, N, M, NY>,
    /// Largest distance `y ⊖ p` of the motion's positions y from recorded positions p [rad or m], one entry for each velocity
    /// entry.
    pub position_deviation: [f64; N],
}

/// Largest time constant in periods. For larger time constants, rounding errors are visible in the solution.
const MAX_PERIODS: f64 = 20.0;

/// State (y, T ẏ, T² ÿ) of one coordinate y at one sample, with the period T.
type Node = Vector3<f64>;

impl<const N: usize> Recording<N> {
    /// Returns a smooth motion near the samples. Positions, velocities and accelerations of the motion are consistent. For
    /// each coordinate with recorded positions p_k, recorded velocities v_k and the period T, the motion minimizes
    ///
    /// ```text
    ///     Σ_k T [(y(t_k) − p_k)²/ρ² + (ẏ(t_k) − v_k)²] + τ⁴ ∫ y‴² dt        with velocities v_k
    ///     Σ_k T (y(t_k) − p_k)² + τ⁶ ∫ y‴² dt                              without velocities
    /// ```
    ///
    /// among all motions that begin at the first position, and begin and end at rest (ẏ = ÿ = 0). If the
    /// recording does not end at rest, the motion slows down within the last time constant τ. The result is a
    /// spline of degree five with knots at the samples. The smoothing is a low-pass filter without delay. Its
    /// frequency response is 1/(1 + (ωτ)⁴) with velocities, and 1/(1 + (ωτ)⁶) without velocities (Wahba,
    /// *Spline Models for Observational Data*, 1990, chapter 1).
    ///
    /// # Errors
    /// [`TrajectoryError::OutOfRange`] for a time constant outside 1 to 20 periods, a correction time that is
    /// shorter than the time constant or above 1000 s, or an overflow.
    pub fn smoothed(&self, smoothing: &Smoothing) -> Result<Smoothed<N>, TrajectoryError> {
        let ratio = smoothing.time_constant / self.period();
        if !(1.0..=MAX_PERIODS).contains(&ratio) {
            return Err(TrajectoryError::OutOfRange {
                what: "time constant in periods",
                value: ratio,
                range: "1 to 20",
            });
        }
        if !(smoothing.time_constant..=1e3).contains(&smoothing.correction_time) {
            return Err(TrajectoryError::OutOfRange {
                what: "correction time",
                value: smoothing.correction_time,
                range: "at least the time constant, at most 1000 s",
            });
        }
        // Weights are in units of the period, and divided by the weight of positions.
        let trust = smoothing.correction_time / self.period();
        let weights = match self.velocities() {
            Some(_) => Weights { velocity: trust.powi(2), jerk: trust.powi(2) * ratio.powi(4) },
            None => Weights { velocity: 0.0, jerk: ratio.powi(6) },
        };
        let count = self.positions().len();
        let mut samples = vec![Sample::at_rest([0.0; N]); count];
        for i in 0..N {
            let nodes = smooth(&self.coordinate(i), &weights).ok_or(TrajectoryError::OutOfRange {
                what: "period",
                value: self.period(),
                range: "a period for which the weights of the smoothing are finite",
            })?;
            for (sample, node) in samples.iter_mut().zip(nodes) {
                sample.positions[i] = node[0];
                sample.velocities[i] = node[1] / self.period();
                sample.accelerations[i] = node[2] / (self.period() * self.period());
            }
        }
        let deviation = |of: &dyn Fn(usize, usize) -> f64| {
            core::array::from_fn(|i| (0..count).map(|k| of(k, i).abs()).fold(0.0, f64::max))
        };
        let position_deviation = deviation(&|k, i| samples[k].positions[i] - self.positions()[k][i]);
        let velocity_deviation = match self.velocities() {
            Some(v) => deviation(&|k, i| samples[k].velocities[i] - v[k][i]),
            None => [0.0; N],
        };
        Ok(Smoothed {
            trajectory: Sampled::new(samples, self.period())?,
            position_deviation,
            velocity_deviation,
        })
    }

    /// Returns a smooth motion of a robot with quaternions near the samples. The recording has one column for each of the `N`
    /// position entries of the robot, in the order of the entries. A quaternion is x, y, z, w. Recorded velocities are not
    /// used.
    ///
    /// [`Self::smoothed`] is applied to unwrapped coordinates, which are the sums of the steps `y_k ⊖ y_{k−1}` between
    /// samples in the body frames. These coordinates depend neither on the signs of quaternions nor on full turns. Their
    /// first and second derivatives are the velocities v and accelerations v̇. The smoothing changes the coordinates by a
    /// small amount. A smoothed pose is the recorded pose, moved by this change. The error of this method is of second order
    /// in the change.
    ///
    /// # Errors
    /// The errors of [`Self::through_poses`] and [`Self::smoothed`].
    pub fn smoothed_poses<D: Dynamics<V, M, N>, const V: usize, const M: usize>(
        &self,
        robot: D,
        smoothing: &Smoothing,
    ) -> Result<SmoothedPoses<D, V, M, N>, TrajectoryError> {
        let mut ways = vec![[0.0; V]];
        for (k, pair) in self.positions().windows(2).enumerate() {
            let step = robot.difference(&pair[0], &pair[1]);
            ways.push(core::array::from_fn(|i| ways[k][i] + step[i]));
        }
        // An invalid quaternion is reported here, before differences of poses are computed.
        let robot = self.through_poses(robot)?.into_robot();
        let smoothed = Recording::new(self.period(), ways.clone(), None)?.smoothed(smoothing)?;
        let moved = |(k, sample): (usize, &Sample<V>)| {
            let left = core::array::from_fn(|i| sample.positions[i] - ways[k][i]);
            Sample {
                positions: robot.integrate(&self.positions()[k], &left),
                velocities: sample.velocities,
                accelerations: sample.accelerations,
            }
        };
        let samples: Vec<Sample<V, N>> =
            smoothed.trajectory.samples().iter().enumerate().map(moved).collect();
        Ok(SmoothedPoses {
            trajectory: GeodesicMotion::sampled(robot, &samples, self.period())?,
            position_deviation: smoothed.position_deviation,
        })
    }

    /// Position, and velocity times the period, of each sample of coordinate `i`. The velocity is 0 if the
    /// recording has no velocities.
    fn coordinate(&self, i: usize) -> Vec<[f64; 2]> {
        let velocity = |k: usize| self.velocities().map_or(0.0, |v| self.period() * v[k][i]);
        let rows = self.positions().iter().enumerate();
        rows.map(|(k, y)| [y[i], velocity(k)]).collect()
    }
}

/// Weights relative to the weight of a position, with the period as the unit of time.
struct Weights {
    velocity: f64,
    jerk: f64,
}

/// Solves the least-squares problem of one coordinate; `None` on overflow.
fn smooth(data: &[[f64; 2]], weights: &Weights) -> Option<Vec<Node>> {
    let [[first, coupling], [_, second]] = jerk_energy();
    let last = data.len() - 1;
    let mut system = BlockTridiagonal {
        diagonal: Vec::with_capacity(data.len()),
        coupling: vec![coupling * weights.jerk; last],
    };
    let mut right = Vec::with_capacity(data.len());
    for (k, [position, velocity]) in data.iter().enumerate() {
        let mut block = Matrix3::zeros();
        if k > 0 {
            block += second * weights.jerk;
        }
        if k < last {
            block += first * weights.jerk;
        }
        block[(0, 0)] += 1.0;
        block[(1, 1)] += weights.velocity;
        let load = Node::new(*position, weights.velocity * velocity, 0.0);
        system.diagonal.push(block);
        right.push(load);
    }
    // Positions are relative to the first position. The first node is then zero and is removed from the system, and so are
    // velocities and accelerations at both ends.
    let origin = data[0][0];
    for load in &mut right {
        load[0] -= origin;
    }
    system.fix(0, &[0, 1, 2], &mut right);
    system.fix(last, &[1, 2], &mut right);
    let mut nodes = system.solve(&right)?;
    for node in &mut nodes {
        node[0] += origin;
    }
    Some(nodes)
}

/// Quadratic form ∫₀¹ y‴² dt of a polynomial of degree five in its values (y, ẏ, ÿ) at 0 and at 1. The form has 2 × 2
/// blocks. The integrand has degree four, so three Gauss points are exact.
fn jerk_energy() -> [[Matrix3<f64>; 2]; 2] {
    let half_width = (3.0_f64 / 5.0).sqrt() / 2.0;
    let points = [(0.5 - half_width, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.5 + half_width, 5.0 / 18.0)];
    let mut blocks = [[Matrix3::zeros(); 2]; 2];
    for (t, weight) in points {
        let mut jerks = [Node::zeros(); 2];
        for i in 0..3 {
            let mut unit = [0.0; 3];
            unit[i] = 1.0;
            jerks[0][i] = Quintic::new(unit, [0.0; 3], 1.0).jerk(t);
            jerks[1][i] = Quintic::new([0.0; 3], unit, 1.0).jerk(t);
        }
        for r in 0..2 {
            for c in 0..2 {
                blocks[r][c] += jerks[r] * jerks[c].transpose() * weight;
            }
        }
    }
    blocks
}

/// A symmetric positive definite matrix of 3 × 3 blocks with three block diagonals.
struct BlockTridiagonal {
    diagonal: Vec<Matrix3<f64>>,
    /// Blocks from node k (rows) to node k + 1 (columns).
    coupling: Vec<Matrix3<f64>>,
}

impl BlockTridiagonal {
    /// Sets components of a node to zero and removes these components from the system.
    fn fix(&mut self, node: usize, components: &[usize], right: &mut [Node]) {
        for &i in components {
            self.diagonal[node].row_mut(i).fill(0.0);
            self.diagonal[node].column_mut(i).fill(0.0);
            self.diagonal[node][(i, i)] = 1.0;
            right[node][i] = 0.0;
            if node > 0 {
                self.coupling[node - 1].column_mut(i).fill(0.0);
            }
            if let Some(next) = self.coupling.get_mut(node) {
                next.row_mut(i).fill(0.0);
            }
        }
    }

    /// Solves by block elimination and one step of iterative refinement. Returns `None` if a pivot is singular, which only
    /// happens on overflow.
    fn solve(&self, right: &[Node]) -> Option<Vec<Node>> {
        let n = self.diagonal.len();
        // The pivots D_k = A_k − Cᵀ D_{k−1}⁻¹ C of a positive definite matrix are positive definite.
        let mut inverses: Vec<Matrix3<f64>> = Vec::with_capacity(n);
        for k in 0..n {
            let mut pivot = self.diagonal[k];
            if k > 0 {
                pivot -= self.coupling[k - 1].transpose() * inverses[k - 1] * self.coupling[k - 1];
            }
            inverses.push(pivot.try_inverse()?);
        }
        let mut x = self.substitute(&inverses, right);
        let residual: Vec<Node> = (0..n).map(|k| right[k] - self.row(k, &x)).collect();
        for (x, correction) in x.iter_mut().zip(self.substitute(&inverses, &residual)) {
            *x += correction;
        }
        Some(x)
    }

    fn substitute(&self, inverses: &[Matrix3<f64>], right: &[Node]) -> Vec<Node> {
        let n = right.len();
        let mut x = right.to_vec();
        for k in 1..n {
            let before = inverses[k - 1] * x[k - 1];
            x[k] -= self.coupling[k - 1].transpose() * before;
        }
        for k in (0..n).rev() {
            let known = if k + 1 < n { self.coupling[k] * x[k + 1] } else { Node::zeros() };
            x[k] = inverses[k] * (x[k] - known);
        }
        x
    }

    fn row(&self, k: usize, x: &[Node]) -> Node {
        let mut sum = self.diagonal[k] * x[k];
        if k > 0 {
            sum += self.coupling[k - 1].transpose() * x[k - 1];
        }
        if k + 1 < x.len() {
            sum += self.coupling[k] * x[k + 1];
        }
        sum
    }
}
