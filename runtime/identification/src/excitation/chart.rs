//! Coordinates in which motions of robots with quaternions are planned. There are as many coordinates as velocities.
//!
//! The coordinates of a joint with a quaternion are the rotation vector φ of its orientation, R = exp([φ]×). A floating
//! joint has the position p of its origin in the parent's frame before φ. Along φ(t) and p(t), the angular velocity ω and the
//! linear velocity v in the body's frame are (Chirikjian, *Stochastic Models, Information Theory, and Lie Groups 2*, 2012,
//! section 10.8)
//!
//! ```text
//!     ω = J(φ) φ̇,    J(φ) x = x − β φ × x + γ φ × (φ × x),    β = (1 − cos θ)/θ²,    γ = (θ − sin θ)/θ³,    θ = |φ|
//!     ω̇ = J(φ) φ̈ − β̇ φ × φ̇ + γ̇ φ × (φ × φ̇) + γ φ̇ × (φ × φ̇)
//!     v = Rᵀ ṗ,    v̇ = Rᵀ p̈ − ω × v
//! ```

use super::super::pose::{QuaternionJoint, plain_positions};
use super::super::robot::{Instant, Robot};
use super::{ExcitationLimits, FourierMotion};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use std::ops::Range;

/// Number of terms of the power series in the squared angle θ² of a rotation. The error is below rounding for
/// all rotations up to π.
const TERMS: i32 = 16;
/// Largest number of times that a motion is scaled towards its limits. The excess of a speed falls fast.
const ROUNDS: usize = 6;
/// Share of a limit that is left for the error of the next scaling.
const MARGIN: f64 = 1e-3;

/// Map from the coordinates of a motion to positions, velocities and accelerations of a robot. The coordinates of joints
/// without a quaternion are their positions.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chart {
    joints: Vec<QuaternionJoint>,
    /// Index of the entry of the positions y for each coordinate; `None` for coordinates of joints with a
    /// quaternion.
    plain: Vec<Option<usize>>,
}

impl Chart {
    pub(super) fn of(robot: &dyn Robot) -> Self {
        let joints = robot.quaternion_joints();
        Self { plain: plain_positions(&joints, robot.joint_names().len()), joints }
    }

    /// The coordinates of a robot without quaternions.
    #[cfg(test)]
    pub(super) fn plain(joints: usize) -> Self {
        Self { plain: plain_positions(&[], joints), joints: Vec::new() }
    }

    /// For each coordinate, whether it belongs to a joint with a quaternion.
    pub(super) fn turns(&self) -> Vec<bool> {
        self.plain.iter().map(Option::is_none).collect()
    }

    /// Name of each joint with a quaternion, and the coordinates of its rotation vector.
    pub(super) fn rotations(&self) -> impl Iterator<Item = (&str, Range<usize>)> {
        self.joints.iter().map(|joint| {
            let rows = joint.velocities();
            (joint.name.as_str(), rows.end - 3..rows.end)
        })
    }

    /// Positions y, velocities v and accelerations v̇ from coordinates and their derivatives.
    pub(super) fn instant(&self, of: &Instant) -> Instant {
        if self.joints.is_empty() {
            return of.clone();
        }
        let [z, dz, ddz] = of;
        let mut found = [vec![0.0; z.len() + self.joints.len()], dz.clone(), ddz.clone()];
        for (coordinate, entry) in self.plain.iter().enumerate() {
            entry.iter().for_each(|entry| found[0][*entry] = z[coordinate]);
        }
        self.joints.iter().for_each(|joint| place(joint, of, &mut found));
        found
    }

    /// Positions, velocities and accelerations of several states, as by [`Self::instant`].
    pub(super) fn instants(&self, of: &[Instant]) -> Vec<Instant> {
        of.iter().map(|instant| self.instant(instant)).collect()
    }

    /// Largest ratio of a velocity or acceleration of the coordinates `rows` to its limit.
    fn excess(&self, rows: Range<usize>, instants: &[Instant], limits: &[ExcitationLimits]) -> f64 {
        let of = |[_, v, a]: &Instant| {
            let row = |i: usize| (v[i].abs() / limits[i].velocity).max(a[i].abs() / limits[i].acceleration);
            rows.clone().map(row).fold(0.0, f64::max)
        };
        instants.iter().map(of).fold(0.0, f64::max)
    }

    /// Largest ratio of a velocity or acceleration of a joint with a quaternion to its limit.
    pub(super) fn largest_excess(&self, instants: &[Instant], limits: &[ExcitationLimits]) -> f64 {
        let of = |joint: &QuaternionJoint| self.excess(joint.velocities(), instants, limits);
        self.joints.iter().map(of).fold(0.0, f64::max)
    }

    /// Scales down the motion of joints with quaternions, so that velocities and accelerations of their bodies keep the
    /// limits of the coordinates.
    pub(super) fn narrow(&self, motion: &mut FourierMotion, limits: &[ExcitationLimits], samples: usize) {
        for joint in &self.joints {
            for _ in 0..ROUNDS {
                let instants = self.instants(&motion.instants(samples));
                let excess = self.excess(joint.velocities(), &instants, limits);
                // This form also ends the rounds for NaN.
                let is_beyond = excess > 1.0;
                if !is_beyond {
                    break;
                }
                let share = (1.0 - MARGIN) / excess;
                let pairs = motion.coefficients[joint.velocities()].iter_mut().flatten();
                pairs.for_each(|pair| *pair = pair.map(|x| share * x));
            }
        }
    }
}

/// Computes pose, velocities and accelerations of a joint with a quaternion.
fn place(joint: &QuaternionJoint, [z, dz, ddz]: &Instant, [y, v, a]: &mut Instant) {
    let rows = joint.velocities();
    let three = |of: &[f64], first: usize| Vector3::new(of[first], of[first + 1], of[first + 2]);
    let last = rows.end - 3;
    let (attitude, turn, change) = turning(&three(z, last), &three(dz, last), &three(ddz, last));
    let entries = joint.positions();
    let quaternion = entries.start + joint.quaternion();
    y[quaternion..entries.end].copy_from_slice(attitude.coords.as_slice());
    v[last..rows.end].copy_from_slice(turn.as_slice());
    a[last..rows.end].copy_from_slice(change.as_slice());
    if joint.is_floating {
        let first = rows.start;
        let velocity = attitude.inverse() * three(dz, first);
        let acceleration = attitude.inverse() * three(ddz, first) - turn.cross(&velocity);
        y[entries.start..quaternion].copy_from_slice(&z[first..last]);
        v[first..last].copy_from_slice(velocity.as_slice());
        a[first..last].copy_from_slice(acceleration.as_slice());
    }
}

/// Orientation exp(φ) with the rotation vector φ = `phi`, and the angular velocity and acceleration in the
/// body's frame.
fn turning(
    phi: &Vector3<f64>,
    rate: &Vector3<f64>,
    change: &Vector3<f64>,
) -> (UnitQuaternion<f64>, Vector3<f64>, Vector3<f64>) {
    let square = phi.norm_squared();
    // Σ (−s)ᵏ/(2 k + n)! = 1/n! − s/(n + 2)! + …, and its derivative times ṡ.
    let series = |n: i32| {
        let (mut term, mut sum, mut slope) = (1.0 / (1..=n).map(f64::from).product::<f64>(), 0.0, 0.0);
        for k in 0..TERMS {
            sum += term;
            let next = -term / f64::from((2 * k + n + 1) * (2 * k + n + 2));
            slope += f64::from(k + 1) * next;
            term = next * square;
        }
        [sum, slope * 2.0 * phi.dot(rate)]
    };
    let ([beta, dbeta], [gamma, dgamma]) = (series(2), series(3));
    let (across, twice) = (phi.cross(rate), phi.cross(&phi.cross(rate)));
    let turn = rate - beta * across + gamma * twice;
    let along = change - beta * phi.cross(change) + gamma * phi.cross(&phi.cross(change));
    let acceleration = along - dbeta * across + dgamma * twice + gamma * rate.cross(&across);
    let (sine, cosine) = (0.5 * square.sqrt()).sin_cos();
    let factor = if square > 0.0 { sine / square.sqrt() } else { 0.5 };
    let attitude = Quaternion::from_parts(cosine, factor * phi);
    (UnitQuaternion::from_quaternion(attitude), turn, acceleration)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart() -> Chart {
        let joint = |name: &str, position, velocity, is_floating| QuaternionJoint {
            name: name.into(),
            position,
            velocity,
            is_floating,
        };
        let joints = vec![joint("base", 0, 0, true), joint("ball", 8, 7, false)];
        Chart { plain: plain_positions(&joints, 11), joints }
    }

    /// ⊖ of poses a short time apart is the velocity in between, and differences of velocities are accelerations.
    #[test]
    fn velocities_and_accelerations_are_those_of_the_poses() {
        const H: f64 = 1e-4;
        let chart = chart();
        let wave = |k: usize| [[0.3 + 0.05 * k as f64, -0.2], [0.1 * k as f64 - 0.4, 0.25], [0.2, 0.1]];
        let motion = FourierMotion {
            period: 7.0,
            center: vec![0.1; 11],
            coefficients: (0..11).map(|k| wave(k).to_vec()).collect(),
        };
        let at = |t: f64| chart.instant(&motion.instant(t));
        let mut errors = [0.0_f64; 2];
        for i in 0..70 {
            let t = 0.1 * f64::from(i);
            let [before, now, after] = [at(t - H), at(t), at(t + H)];
            for joint in &chart.joints {
                let [from, to] = [&before, &after].map(|instant| &instant[0][joint.positions()]);
                let rows = joint.velocities();
                let way = joint.way(from, to).into_iter().zip(&now[1][rows.clone()]);
                errors[0] = way.map(|(way, v)| (way / (2.0 * H) - v).abs()).fold(errors[0], f64::max);
                let of_row = |row: usize| ((after[1][row] - before[1][row]) / (2.0 * H) - now[2][row]).abs();
                errors[1] = rows.map(of_row).fold(errors[1], f64::max);
                let q = &now[0][joint.positions().end - 4..joint.positions().end];
                assert!((q.iter().map(|q| q * q).sum::<f64>() - 1.0).abs() < 1e-15);
            }
            assert_eq!((now[0][7], now[0][12]), (motion.instant(t)[0][6], motion.instant(t)[0][10]));
        }
        println!("velocities {:.1e}, accelerations {:.1e}", errors[0], errors[1]);
        assert!(errors[0] < 1e-6 && errors[1] < 1e-6, "{errors:?}");
    }

    #[test]
    fn a_rotation_vector_is_that_of_the_quaternion() {
        for phi in [[0.0; 3], [1e-9, 0.0, 0.0], [0.3, -0.4, 0.5], [1.7, -1.8, 1.9]].map(Vector3::from) {
            let (attitude, ..) = turning(&phi, &Vector3::zeros(), &Vector3::zeros());
            assert!((attitude.scaled_axis() - phi).norm() < 4e-15 * phi.norm() + f64::MIN_POSITIVE, "{phi}");
        }
    }
}
