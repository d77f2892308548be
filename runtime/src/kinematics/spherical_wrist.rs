//! Analytic inverse kinematics of six-axis arms with a spherical wrist.
//!
//! The position of the wrist's centre depends only on the first three joints. The last three joints then
//! complete the orientation. If the second and third axes are parallel, both parts are sequences of equations
//! `a cos y + b sin y = c` for one joint angle y (Pieper, *The Kinematics of Manipulators under Computer
//! Control*, 1968; the subproblems of Paden and Kahan in Murray, Li, Sastry, *A Mathematical Introduction to
//! Robotic Manipulation*, 1994, section 3.3).

use super::geometry::{GeometryError, Screws};
use super::{Pose, matrix, rotation, vector};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{PI, TAU};
use thiserror::Error;

/// Distances (m) and deviations of directions below this value count as zero.
const GEOMETRY: f64 = 1e-8;
/// Relative lever arm of a joint below which the arm counts as singular. The lever arm is relative to its largest
/// value. In a singular configuration two solutions coincide, or a joint is free.
const SINGULAR: f64 = 1e-6;
/// Relative distance by which a target may be out of reach because of rounding. For such a target the arm is fully
/// stretched or folded.
const REACH: f64 = 1e-12;

/// A configuration in which the frame cannot move in every direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Singularity {
    /// The wrist's centre is on the first axis, so the angle of the first joint is free.
    Shoulder,
    /// The arm is stretched or folded, so its two elbow solutions coincide.
    Elbow,
    /// The axes of the fourth and sixth joints are aligned, so the pose depends only on the sum or difference
    /// of these joints.
    Wrist,
}

/// One of the up to eight solutions for a pose. Each flag selects one of two angles of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Branch {
    /// Selects one of the two angles of the first joint.
    pub shoulder: bool,
    /// Selects one of the two angles of the third joint.
    pub elbow: bool,
    /// Selects one of the two angles of the fifth joint.
    pub wrist: bool,
}

/// Joint angles for a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// Joint angles (rad). Full turns are added so that the angles are closest to the angles given to
    /// [`SphericalWrist::solve`].
    pub positions: [f64; 6],
    /// Branch of the solution.
    pub branch: Branch,
    /// Whether shoulder, elbow and wrist are singular. If a joint is free, its angle is the angle given to
    /// [`SphericalWrist::solve`].
    pub singular: [bool; 3],
}

impl Solution {
    /// Singularities of the solution.
    pub fn singularities(&self) -> impl Iterator<Item = Singularity> + '_ {
        let all = [Singularity::Shoulder, Singularity::Elbow, Singularity::Wrist];
        all.into_iter().zip(self.singular).filter_map(|(s, on)| on.then_some(s))
    }
}

/// Largest accepted angle (rad). The rounding error of larger angles is too large for an accurate pose.
const FARTHEST: f64 = 1e6;

/// Reason why the inverse kinematics has no solution.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum KinematicsError {
    /// The wrist's centre would be too close to the first axis.
    #[error(
        "the wrist's centre would be {distance} m from the first axis, but its smallest possible distance is \
         {least} m"
    )]
    TooCloseToFirstAxis {
        /// Distance of the wrist's centre from the first axis (m).
        distance: f64,
        /// Smallest possible distance (m), which is the lateral offset of the arm.
        least: f64,
    },
    /// The wrist's centre would be too far from, or too close to, the second axis.
    #[error(
        "the wrist's centre would be {distance} m from the second axis, but the arm reaches {least} to {most} m"
    )]
    OutOfReach {
        /// Distance of the wrist's centre from the second axis, perpendicular to it (m).
        distance: f64,
        /// Shortest distance that the arm reaches (m).
        least: f64,
        /// Longest distance that the arm reaches (m).
        most: f64,
    },
    /// No angle of the fifth joint leads to the orientation. A wrist whose axes are not perpendicular cannot reach
    /// every orientation.
    #[error("no angle of the fifth joint gives the desired orientation")]
    Orientation,
    /// The pose or the given angles are not finite, a given angle exceeds 1e6 rad, or the matrix is not a rotation
    /// matrix. The number is the deviation of the matrix from a rotation matrix.
    #[error(
        "the pose or the given angles are not valid. A number is not finite, an angle exceeds 1e6 rad, or the matrix is not a \
         rotation (error {0})"
    )]
    NotAPose(f64),
    /// All solutions violate the limits.
    #[error(
        "no solution is within the joint limits. The closest solution exceeds the limit of joint {} by {excess} \
         rad",
        .joint + 1
    )]
    Limits {
        /// Index of the joint with the largest violation in the closest solution, from 0. Messages count from 1.
        joint: usize,
        /// Angle beyond the limit of this joint (rad).
        excess: f64,
    },
}

/// Analytic inverse kinematics of a six-axis arm with a spherical wrist.
///
/// The second and third axes must be parallel, and the first axis must not be parallel to them. The last
/// three axes must meet in one point. Most industrial arms have this geometry, for example the six-axis
/// PowerCube and the Puma 560.
///
/// ```
/// use gelenk_generated::puma560;
/// use gelenk_runtime::kinematics::SphericalWrist;
///
/// let arm = SphericalWrist::from_poses(puma560::frame_tool_pose)?;
/// let y = [0.3, 0.5, -0.4, 0.2, 0.7, -0.1];
/// let solutions = arm.solve(&puma560::frame_tool_pose(&y), &y)?;
/// assert_eq!(solutions.all().count(), 8);
/// let closest = solutions.closest(&y);
/// assert!(closest.positions.iter().zip(&y).all(|(a, b)| (a - b).abs() < 1e-9));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphericalWrist {
    screws: Screws,
    /// Centre of the wrist at y = 0.
    center: Vector3<f64>,
}

/// All solutions for a pose. There is at least one solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InverseKinematics {
    solutions: [Option<Solution>; 8],
    first: Solution,
}

impl InverseKinematics {
    /// All different solutions in the order of their branches; one to eight.
    pub fn all(&self) -> impl Iterator<Item = &Solution> {
        self.solutions.iter().flatten()
    }

    /// The solution that is closest to `positions` (rad). The distance is the largest difference of a joint angle.
    #[must_use]
    pub fn closest(&self, positions: &[f64; 6]) -> Solution {
        let mut best = self.first;
        for solution in self.all() {
            if distance(&solution.positions, positions) < distance(&best.positions, positions) {
                best = *solution;
            }
        }
        best
    }

    /// The solution within `limits` (rad) that is closest to `positions` (rad). Full turns are added to angles if
    /// necessary.
    ///
    /// # Errors
    /// [`KinematicsError::Limits`] if no solution is within the limits. No angle satisfies a NaN limit.
    pub fn within(&self, limits: &[[f64; 2]; 6], positions: &[f64; 6]) -> Result<Solution, KinematicsError> {
        let no_number = |limits: &[f64; 2]| limits.iter().any(|l| l.is_nan());
        if let Some(joint) = limits.iter().position(no_number) {
            let excess = f64::NAN;
            return Err(KinematicsError::Limits { joint, excess });
        }
        let mut best: Option<Solution> = None;
        let mut least = (f64::INFINITY, 0);
        for solution in self.all() {
            let mut moved = *solution;
            let mut excess = (0.0, 0);
            for (j, y) in moved.positions.iter_mut().enumerate() {
                let [low, high] = limits[j];
                if *y > high {
                    *y -= ((*y - high) / TAU).ceil() * TAU;
                } else if *y < low {
                    *y += ((low - *y) / TAU).ceil() * TAU;
                }
                let beyond = (low - *y).max(*y - high);
                // Angles beyond `FARTHEST` are too inaccurate and count as outside the limits.
                let beyond = beyond.max(y.abs() - FARTHEST);
                if beyond > excess.0 {
                    excess = (beyond, j);
                }
            }
            if excess.0 > 0.0 {
                if excess.0 < least.0 {
                    least = excess;
                }
                continue;
            }
            let nearer = best
                .is_none_or(|b| distance(&moved.positions, positions) < distance(&b.positions, positions));
            if nearer {
                best = Some(moved);
            }
        }
        best.ok_or(KinematicsError::Limits { joint: least.1, excess: least.0 })
    }
}

impl SphericalWrist {
    /// Computes the geometry of the arm from a pose function, see [`Screws::from_poses`].
    ///
    /// # Errors
    /// [`GeometryError`] if the geometry of the arm is not supported.
    pub fn from_poses(pose: impl Fn(&[f64; 6]) -> Pose) -> Result<Self, GeometryError> {
        Self::new(Screws::from_poses(pose)?)
    }

    /// The inverse kinematics of an arm with these joint axes.
    ///
    /// # Errors
    /// - [`GeometryError::NoSphericalWrist`] if the last three axes do not meet in one point.
    /// - [`GeometryError::NotSolved`] for another unsupported geometry.
    pub fn new(screws: Screws) -> Result<Self, GeometryError> {
        let axes = &screws.axes;
        let across = |i: usize, j: usize| axes[i].cross(&axes[j]).norm();
        if across(1, 2) > GEOMETRY {
            return Err(GeometryError::NotSolved { condition: "its second and third axes must be parallel" });
        }
        if across(0, 1) < SINGULAR {
            return Err(GeometryError::NotSolved {
                condition: "its first axis must not be parallel to the second axis",
            });
        }
        if across(3, 4) < SINGULAR || across(4, 5) < SINGULAR {
            return Err(GeometryError::NotSolved {
                condition: "its fifth axis must not be parallel to the fourth or sixth axis",
            });
        }
        let center = meeting_point(&screws, 3, 4);
        let distance = (3..6).map(|j| off_axis(&screws, j, &center).norm()).fold(0.0, f64::max);
        if distance > GEOMETRY {
            return Err(GeometryError::NoSphericalWrist { distance });
        }
        let arm = Self { screws, center };
        let lengths = [arm.upper_arm().norm(), arm.forearm().norm()];
        if lengths.iter().any(|l| *l < SINGULAR) {
            return Err(GeometryError::NotSolved {
                condition: "its third axis must not coincide with the second, and the wrist's centre must not be on the third",
            });
        }
        Ok(arm)
    }

    /// Joint axes of the arm.
    #[must_use]
    pub fn screws(&self) -> &Screws {
        &self.screws
    }

    /// Vector from the second to the third axis at y = 0, perpendicular to both.
    fn upper_arm(&self) -> Vector3<f64> {
        off_axis(&self.screws, 1, &self.screws.points[2])
    }

    /// Vector from the third axis to the wrist's centre at y = 0, perpendicular to the third axis.
    fn forearm(&self) -> Vector3<f64> {
        off_axis(&self.screws, 2, &self.center)
    }

    /// All solutions for `pose`. Full turns are added so that the angles are closest to `near` (rad). If a
    /// singularity leaves a joint free, its angle is the one in `near`.
    ///
    /// # Errors
    /// [`KinematicsError`] if there is no solution, or if the pose or the angles are not valid.
    pub fn solve(&self, pose: &Pose, near: &[f64; 6]) -> Result<InverseKinematics, KinematicsError> {
        let (position, target) = (vector(&pose.0), matrix(&pose.1));
        let off =
            (target.transpose() * target - Matrix3::identity()).amax() + (target.determinant() - 1.0).abs();
        let finite = pose.0.iter().all(|x| x.is_finite());
        let finite = finite && near.iter().all(|y| y.abs() <= FARTHEST);
        // This form rejects NaN.
        if !(finite && off <= 1e-6) {
            return Err(KinematicsError::NotAPose(off));
        }
        let turn = target * self.screws.home_rotation.transpose();
        let center = position + turn * (self.center - self.screws.home_position);
        let mut found = Found::default();
        let first = self.first(&center, near[0])?;
        for (shoulder, y1) in first.angles() {
            match self.elbow(&center, y1) {
                Ok((third, p)) => {
                    for (elbow, y3) in third.angles() {
                        let y2 = self.second(&p, y3);
                        let arm = [y1, y2, y3];
                        let singular = [first.singular, third.singular];
                        self.wrist(&turn, arm, [shoulder, elbow], singular, near, &mut found);
                    }
                }
                Err(error) => found.error = found.error.or(Some(error)),
            }
        }
        match found.solutions.iter().flatten().next() {
            Some(first) => Ok(InverseKinematics { first: *first, solutions: found.solutions }),
            None => Err(found.error.unwrap_or(KinematicsError::Orientation)),
        }
    }

    /// Angles of joint 1. They follow from the coordinate of the wrist's centre along the second axis, which joints
    /// 2 and 3 cannot change.
    fn first(&self, center: &Vector3<f64>, near: f64) -> Result<Pair, KinematicsError> {
        let (axes, points) = (&self.screws.axes, &self.screws.points);
        let r = center - points[0];
        let (along, across) = split(&r, &axes[0]);
        // ω2 · (along + across cos y1 − (ω1 × across) sin y1) = ω2 · (center_0 − point_1).
        let offset = axes[1].dot(&(self.center - points[0] - along));
        let a = axes[1].dot(&across);
        let b = -axes[1].dot(&axes[0].cross(&across));
        let scale = self.upper_arm().norm() + self.forearm().norm();
        let tilt = split(&axes[1], &axes[0]).1.norm();
        solve_cos_sin(a, b, offset, scale * tilt, near).ok_or(KinematicsError::TooCloseToFirstAxis {
            distance: across.norm(),
            least: offset.abs() / tilt,
        })
    }

    /// Angles of joint 3, and the wrist's centre before the rotation of joint 1. The angles follow from the distance
    /// of the wrist's centre from the second axis.
    fn elbow(&self, center: &Vector3<f64>, y1: f64) -> Result<(Pair, Vector3<f64>), KinematicsError> {
        let (axes, points) = (&self.screws.axes, &self.screws.points);
        let p = points[0] + rotation(&axes[0], -y1) * (center - points[0]);
        let (upper, fore) = (self.upper_arm(), self.forearm());
        let distance = off_axis(&self.screws, 1, &p).norm();
        // |upper + R(y3) fore|² = distance².
        let a = upper.dot(&fore);
        let b = upper.dot(&axes[2].cross(&fore));
        let c = 0.5 * (distance * distance - upper.norm_squared() - fore.norm_squared());
        let (u, f) = (upper.norm(), fore.norm());
        let pair = solve_cos_sin(a, b, c, u * f, 0.0).ok_or(KinematicsError::OutOfReach {
            distance,
            least: (u - f).abs(),
            most: u + f,
        })?;
        Ok((pair, p))
    }

    /// Angle of joint 2, which rotates the arm with the angle `y3` of joint 3 to the wrist's centre.
    fn second(&self, p: &Vector3<f64>, y3: f64) -> f64 {
        let bent = self.upper_arm() + rotation(&self.screws.axes[2], y3) * self.forearm();
        angle_about(&self.screws.axes[1], &bent, &off_axis(&self.screws, 1, p))
    }

    /// Adds the solutions with the angles of joints 4, 5, 6, which complete the rotation of the first three
    /// joints to `turn`.
    fn wrist(
        &self,
        turn: &Matrix3<f64>,
        arm: [f64; 3],
        [shoulder, elbow]: [bool; 2],
        singular: [bool; 2],
        near: &[f64; 6],
        found: &mut Found,
    ) {
        let axes = &self.screws.axes;
        let before = [arm[0], arm[1], arm[2], 0.0, 0.0, 0.0];
        let rest = self.screws.transform(&before, 0..3).1.transpose() * turn;
        // ω4 · R5 ω6 = ω4 · rest ω6.
        let goal = rest * axes[5];
        let (along, across) = split(&axes[5], &axes[4]);
        let a = axes[3].dot(&across);
        let b = axes[3].dot(&axes[4].cross(&across));
        let c = axes[3].dot(&goal) - axes[3].dot(&along);
        let size = across.norm() * split(&axes[3], &axes[4]).1.norm();
        let Some(fifth) = solve_cos_sin(a, b, c, size, 0.0) else {
            return;
        };
        for (wrist, y5) in fifth.angles() {
            let sixth_axis = rotation(&axes[4], y5) * axes[5];
            // The two solutions of joint 5 coincide if axes 4, 5 and 6 are in one plane. A joint is free only if axes 4
            // and 6 are aligned.
            let aligned = axes[3].cross(&sixth_axis).norm() < SINGULAR;
            let y4 = if aligned { near[3] } else { angle_about(&axes[3], &sixth_axis, &goal) };
            let last = (rotation(&axes[3], y4) * rotation(&axes[4], y5)).transpose() * rest;
            let mark = split(&axes[4], &axes[5]).1;
            let y6 = angle_about(&axes[5], &mark, &(last * mark));
            let angles = [arm[0], arm[1], arm[2], y4, y5, y6];
            found.add(Solution {
                positions: core::array::from_fn(|j| nearest_turn(angles[j], near[j])),
                branch: Branch { shoulder, elbow, wrist },
                singular: [singular[0], singular[1], aligned],
            });
            if aligned {
                break;
            }
        }
    }
}

#[derive(Default)]
struct Found {
    solutions: [Option<Solution>; 8],
    count: usize,
    error: Option<KinematicsError>,
}

impl Found {
    fn add(&mut self, solution: Solution) {
        if let Some(free) = self.solutions.get_mut(self.count) {
            *free = Some(solution);
            self.count += 1;
        }
    }
}

/// Two angles, or one angle if the two coincide.
struct Pair {
    first: f64,
    second: Option<f64>,
    singular: bool,
}

impl Pair {
    fn angles(&self) -> impl Iterator<Item = (bool, f64)> {
        core::iter::once((false, self.first)).chain(self.second.map(|y| (true, y)))
    }
}

/// Solutions y of `a cos y + b sin y = c`; `None` if |c| is too large. `size` is the largest value of |(a, b)| in any
/// configuration. If a, b and c are zero, every y is a solution, and the result is `free`.
fn solve_cos_sin(a: f64, b: f64, c: f64, size: f64, free: f64) -> Option<Pair> {
    let length = a.hypot(b);
    if length < SINGULAR * size && c.abs() < SINGULAR * size {
        return Some(Pair { first: free, second: None, singular: true });
    }
    let cosine = c / length;
    if cosine.abs() > 1.0 + REACH {
        return None;
    }
    let (middle, half) = (b.atan2(a), cosine.clamp(-1.0, 1.0).acos());
    // The sine of half the distance of the solutions is the relative lever arm.
    if half.sin() < SINGULAR {
        let first = if cosine > 0.0 { middle } else { middle + PI };
        return Some(Pair { first, second: None, singular: true });
    }
    Some(Pair { first: middle + half, second: Some(middle - half), singular: false })
}

/// Parts of `v` along a unit vector and perpendicular to it.
fn split(v: &Vector3<f64>, axis: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let along = axis * axis.dot(v);
    (along, v - along)
}

/// Vector from the axis of a joint to a point, perpendicular to the axis.
fn off_axis(screws: &Screws, joint: usize, point: &Vector3<f64>) -> Vector3<f64> {
    split(&(point - screws.points[joint]), &screws.axes[joint]).1
}

/// Angle of the rotation about `axis` from the direction of `from` to the direction of `to`. Only the parts
/// perpendicular to the axis count.
fn angle_about(axis: &Vector3<f64>, from: &Vector3<f64>, to: &Vector3<f64>) -> f64 {
    let (from, to) = (split(from, axis).1, split(to, axis).1);
    axis.dot(&from.cross(&to)).atan2(from.dot(&to))
}

/// Point of axis `i` that is closest to axis `j`.
fn meeting_point(screws: &Screws, i: usize, j: usize) -> Vector3<f64> {
    let (w, v) = (screws.axes[i], screws.axes[j]);
    let between = screws.points[j] - screws.points[i];
    let cosine = w.dot(&v);
    let along = (w.dot(&between) - cosine * v.dot(&between)) / (1.0 - cosine * cosine);
    screws.points[i] + w * along
}

fn nearest_turn(angle: f64, near: f64) -> f64 {
    angle + ((near - angle) / TAU).round() * TAU
}

fn distance(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
