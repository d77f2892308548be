//! Joint axes of a serial arm, computed from its pose function.

use super::{Pose, matrix, rotation, rows, skew, vector};
use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};
use thiserror::Error;

/// Largest accepted difference between the pose function and the computed geometry (m for positions, 1 for
/// rotation matrices).
const TOLERANCE: f64 = 1e-9;
/// Rotation of one joint from which its axis is computed (rad).
const PROBE: f64 = 1.0;

/// Reason why a pose function does not belong to a supported arm.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum GeometryError {
    /// A joint does not rotate the frame about an axis by the angle of its coordinate.
    #[error("joint {} is not a revolute joint that rotates the frame by its coordinate (rad)", .joint + 1)]
    NotRevolute {
        /// Index of the joint, from 0. Messages count from 1.
        joint: usize,
    },
    /// The pose is not a product of rotations about six axes.
    #[error(
        "the pose function does not describe the last link of six revolute joints in series. Poses differ by up to {error} \
         (position in m, or entry of the rotation matrix)"
    )]
    NotSerial {
        /// Largest difference of positions (m) or of entries of the rotation matrix.
        error: f64,
    },
    /// The last three axes do not meet in one point.
    #[error(
        "the arm has no spherical wrist. The axes of the last three joints miss a common point by {distance} m"
    )]
    NoSphericalWrist {
        /// Largest distance of an axis from the common point (m).
        distance: f64,
    },
    /// The arm has an unsupported geometry for one of these reasons:
    ///
    /// - the second and third axes are not parallel
    /// - the first axis is parallel to the second axis
    /// - an axis of the wrist is parallel to the next axis
    /// - the upper arm or the forearm has the length 0
    #[error("the geometry of the arm is not supported: {condition}")]
    NotSolved {
        /// The condition that is not satisfied.
        condition: &'static str,
    },
}

/// Joint axes (screws) of a six-axis arm at y = 0, for the product of exponentials
///
/// ```text
///     T(y) = exp(ξ_1 y_1) … exp(ξ_6 y_6) T(0)
/// ```
///
/// with the pose T of the frame, the joint angles y (rad) and the screw ξ_i of joint i (Murray, Li, Sastry, *A
/// Mathematical Introduction to Robotic Manipulation*, 1994, section 3.2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Screws {
    /// Unit vectors along the axes at y = 0, in the base frame.
    pub(super) axes: [Vector3<f64>; 6],
    /// A point on each axis at y = 0, in the base frame (m).
    pub(super) points: [Vector3<f64>; 6],
    /// Pose of the frame at y = 0.
    pub(super) home_position: Vector3<f64>,
    pub(super) home_rotation: Matrix3<f64>,
}

impl Screws {
    /// Computes the axes from a pose function. Each joint is rotated separately from y = 0. The change of the pose
    /// is a rotation about the axis of this joint.
    ///
    /// # Errors
    /// - [`GeometryError::NotRevolute`] for a joint that does not rotate the frame about an axis.
    /// - [`GeometryError::NotSerial`] if poses at other positions are not the product of these rotations.
    pub fn from_poses(pose: impl Fn(&[f64; 6]) -> Pose) -> Result<Self, GeometryError> {
        let (home_position, home_rotation) = pose(&[0.0; 6]);
        let mut screws = Self {
            axes: [Vector3::zeros(); 6],
            points: [Vector3::zeros(); 6],
            home_position: vector(&home_position),
            home_rotation: matrix(&home_rotation),
        };
        for joint in 0..6 {
            let mut y = [0.0; 6];
            y[joint] = PROBE;
            let (axis, point) = screws.axis(&pose(&y)).ok_or(GeometryError::NotRevolute { joint })?;
            screws.axes[joint] = axis;
            screws.points[joint] = point;
        }
        let error = screws.largest_error(pose);
        // This form counts NaN as a difference.
        if error <= TOLERANCE { Ok(screws) } else { Err(GeometryError::NotSerial { error }) }
    }

    /// Axis of the rotation by [`PROBE`] from the home pose to `turned`, and the point on the axis that is closest
    /// to the origin; `None` if this motion is not a rotation by [`PROBE`].
    fn axis(&self, turned: &Pose) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let turn = matrix(&turned.1) * self.home_rotation.transpose();
        let antisymmetric = (turn - turn.transpose()) * 0.5;
        let sine = Vector3::new(antisymmetric[(2, 1)], antisymmetric[(0, 2)], antisymmetric[(1, 0)]);
        let axis = sine / PROBE.sin();
        let shift = vector(&turned.0) - turn * self.home_position;
        let unit = (axis.norm() - 1.0).abs() <= TOLERANCE;
        let no_slide = axis.dot(&shift).abs() <= TOLERANCE;
        // This is the solution p of (I − R) p = shift that is perpendicular to the axis.
        let point = (shift + axis.cross(&shift) / (0.5 * PROBE).tan()) * 0.5;
        (unit && no_slide).then_some((axis.normalize(), point))
    }

    /// Largest difference from the pose function at five configurations with irregular joint angles.
    fn largest_error(&self, pose: impl Fn(&[f64; 6]) -> Pose) -> f64 {
        (1..=5).fold(0.0_f64, |largest, k| {
            let y = core::array::from_fn(|j| (f64::from(k) * (2.7 + j as f64 * 1.9)).sin() * 3.0);
            let ((p, r), (q, s)) = (pose(&y), self.pose(&y));
            let position = (vector(&p) - vector(&q)).amax();
            let rotation = (matrix(&r) - matrix(&s)).amax();
            if (position + rotation).is_nan() { f64::NAN } else { largest.max(position).max(rotation) }
        })
    }

    /// Pose of the frame at joint angles `y` (rad).
    #[must_use]
    pub fn pose(&self, y: &[f64; 6]) -> Pose {
        let (p, r) = self.transform(y, 0..6);
        let position = r * self.home_position + p;
        (position.into(), rows(&(r * self.home_rotation)))
    }

    /// Displacement and rotation of the product of exp(ξ_i y_i) over a range of joints, with the screw ξ_i
    /// and the angle y_i of joint i.
    pub(super) fn transform(
        &self,
        y: &[f64; 6],
        joints: core::ops::Range<usize>,
    ) -> (Vector3<f64>, Matrix3<f64>) {
        let (mut p, mut r) = (Vector3::zeros(), Matrix3::identity());
        for j in joints {
            let turn = rotation(&self.axes[j], y[j]);
            p += r * (self.points[j] - turn * self.points[j]);
            r *= turn;
        }
        (p, r)
    }

    /// Joint velocities `ẏ = J⁻¹ V` (rad/s) and accelerations `ÿ = J⁻¹ (A − J̇ ẏ)` (rad/s²) at joint angles `y`, with
    /// the Jacobian J; `None` if J is singular. V is the velocity of the frame and A its acceleration, at the
    /// origin of the frame and in base coordinates. The three linear entries (m/s, m/s²) come before the three
    /// angular entries (rad/s, rad/s²).
    #[must_use]
    pub fn rates(
        &self,
        y: &[f64; 6],
        velocity: &[f64; 6],
        acceleration: &[f64; 6],
    ) -> Option<([f64; 6], [f64; 6])> {
        let (origin, _) = self.pose(y);
        let origin = vector(&origin);
        let mut axes = [Vector3::zeros(); 6];
        let mut arms = [Vector3::zeros(); 6];
        for j in 0..6 {
            let (p, r) = self.transform(y, 0..j);
            axes[j] = r * self.axes[j];
            arms[j] = origin - (r * self.points[j] + p);
        }
        let jacobian =
            Matrix6::from_fn(|i, j| if i < 3 { axes[j].cross(&arms[j])[i] } else { axes[j][i - 3] });
        let lu = jacobian.lu();
        let rates = lu.solve(&Vector6::from(*velocity))?;
        let bias = bias(&axes, &arms, &rates);
        let accelerations = lu.solve(&(Vector6::from(*acceleration) - bias))?;
        let (rates, accelerations): ([f64; 6], [f64; 6]) = (rates.into(), accelerations.into());
        let finite = rates.iter().chain(&accelerations).all(|x| x.is_finite());
        finite.then_some((rates, accelerations))
    }
}

/// The acceleration J̇ ẏ that the frame has at constant joint velocities (Craig, *Introduction to Robotics*, 2005,
/// section 6.2).
fn bias(axes: &[Vector3<f64>; 6], arms: &[Vector3<f64>; 6], rates: &Vector6<f64>) -> Vector6<f64> {
    let (mut linear, mut angular, mut omega) = (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
    for j in 0..6 {
        // The axis rotates with all joints before it.
        let spin = axes[j] * rates[j];
        let change = skew(&omega) * spin;
        linear += change.cross(&arms[j]);
        angular += change;
        omega += spin;
    }
    // These are the centripetal parts. The vector from joint j to joint j + 1 rotates with the link of joint j.
    for j in 0..6 {
        let spin = axes[j] * rates[j];
        let end_velocity: Vector3<f64> =
            (j..6).map(|k| (axes[k] * rates[k]).cross(&arms[k])).sum::<Vector3<f64>>()
                + (0..j).map(|k| (axes[k] * rates[k]).cross(&arms[j])).sum::<Vector3<f64>>();
        linear += spin.cross(&end_velocity);
    }
    Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
}
