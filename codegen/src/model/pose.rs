//! Poses: products, and rotations that are exact at multiples of 90°.

use crate::numeric;
use gelenk_formula::Formula;
use std::f64::consts::FRAC_PI_2;

/// A rotation matrix, as a list of rows.
pub(crate) type Rotation = [[f64; 3]; 3];

/// The rotation matrix of the identity.
pub(crate) const IDENTITY: Rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Pose of a frame in another frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose {
    /// Position of the frame's origin in the other frame (m).
    pub translation: [Formula; 3],
    /// Rotation matrix as a list of rows. Its columns are the frame's axes.
    pub rotation: [[f64; 3]; 3],
}

/// Which parts of a pose (translation, rotation) a description leaves out.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Unsaid {
    pub translation: bool,
    pub rotation: bool,
}

impl Unsaid {
    /// Completes `pose`: parts that the description leaves out are taken from `known`, the pose that `pose`
    /// replaces.
    pub fn filled(self, pose: Pose, known: Option<&Pose>) -> Pose {
        let Some(known) = known else { return pose };
        Pose {
            translation: if self.translation { known.translation.clone() } else { pose.translation },
            rotation: if self.rotation { known.rotation } else { pose.rotation },
        }
    }
}

impl Pose {
    /// The identity pose, that of a frame in itself.
    pub fn identity() -> Self {
        Self { translation: [Formula::ZERO; 3], rotation: IDENTITY }
    }

    /// Whether the pose is the identity for all values of the parameters.
    pub(crate) fn is_identity(&self) -> bool {
        self.translation.iter().all(Formula::is_zero) && self.rotation == IDENTITY
    }

    /// Product of two poses: `self` is the pose of frame b in frame a, and `next` the pose of frame c in
    /// frame b. The result is the pose of c in a.
    pub fn then(&self, next: &Self) -> Self {
        Self { translation: self.point(&next.translation), rotation: product(&self.rotation, &next.rotation) }
    }

    /// Transforms a point from this frame to the frame in which the pose is given.
    pub fn point(&self, point: &[Formula; 3]) -> [Formula; 3] {
        let turned = rotate(&self.rotation, point);
        let [x, y, z] = &self.translation;
        let [a, b, c] = turned;
        [Formula::sum(x.clone(), a), Formula::sum(y.clone(), b), Formula::sum(z.clone(), c)]
    }
}

/// The point `R p` after a rotation R.
pub(crate) fn rotate(rotation: &Rotation, point: &[Formula; 3]) -> [Formula; 3] {
    let row = |row: &[f64; 3]| {
        let terms = row.iter().zip(point).map(|(r, p)| Formula::product(Formula::Number(*r), p.clone()));
        terms.fold(Formula::ZERO, Formula::sum)
    };
    [row(&rotation[0]), row(&rotation[1]), row(&rotation[2])]
}

/// The vector `R a` after a rotation R, with numbers as entries.
pub(crate) fn rotate_numbers(rotation: &Rotation, a: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| (0..3).map(|j| rotation[i][j] * a[j]).sum::<f64>() + 0.0)
}

/// The inertia `R I Rᵀ` in axes rotated by R, with the entries xx, xy, xz, yy, yz, zz.
pub(crate) fn rotate_inertia(rotation: &Rotation, inertia: &[Formula; 6]) -> [Formula; 6] {
    if *rotation == IDENTITY {
        return inertia.clone();
    }
    let index = [[0, 1, 2], [1, 3, 4], [2, 4, 5]];
    let entry = |i: usize, j: usize| {
        let mut sum = Formula::ZERO;
        for (k, row) in index.iter().enumerate() {
            for (l, at) in row.iter().enumerate() {
                let factor = Formula::Number(rotation[i][k] * rotation[j][l]);
                sum = Formula::sum(sum, Formula::product(factor, inertia[*at].clone()));
            }
        }
        sum
    };
    [entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)]
}

/// The product `A B` of two rotation matrices.
pub(crate) fn product(a: &Rotation, b: &Rotation) -> Rotation {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum::<f64>() + 0.0))
}

/// The rotation `R_z(yaw) R_y(pitch) R_x(roll)`, the convention of URDF.
pub(crate) fn from_rpy([roll, pitch, yaw]: [f64; 3]) -> Rotation {
    product(&about_z(yaw), &product(&about_y(pitch), &about_x(roll)))
}

/// Rotation matrix about x by an angle in rad.
pub(crate) fn about_x(angle: f64) -> Rotation {
    let (s, c) = sin_cos(angle);
    [[1.0, 0.0, 0.0], [0.0, c, 0.0 - s], [0.0, s, c]]
}

/// Rotation matrix about y by an angle in rad.
pub(crate) fn about_y(angle: f64) -> Rotation {
    let (s, c) = sin_cos(angle);
    [[c, 0.0, s], [0.0, 1.0, 0.0], [0.0 - s, 0.0, c]]
}

/// Rotation matrix about z by an angle in rad.
pub(crate) fn about_z(angle: f64) -> Rotation {
    let (s, c) = sin_cos(angle);
    [[c, 0.0 - s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
}

/// Sine and cosine of the angle. They are exactly 0 or ±1 if the angle is a multiple of 90° within rounding.
fn sin_cos(angle: f64) -> (f64, f64) {
    match right_angles(angle, 4.0 * f64::EPSILON * angle.abs().max(1.0)) {
        Some(0) => (0.0, 1.0),
        Some(1) => (1.0, 0.0),
        Some(2) => (0.0, -1.0),
        Some(_) => (-1.0, 0.0),
        None => numeric::sin_cos(angle),
    }
}

/// Number of right angles in the angle, modulo 4; `None` if the angle differs from a multiple of 90° by more
/// than the tolerance.
fn right_angles(angle: f64, tolerance: f64) -> Option<u8> {
    let count = (angle / FRAC_PI_2).round();
    // Above 1e6 turns the remainder is a rounding error. Below 1e6 turns the cast is exact.
    let near = count.abs() < 4e6 && (angle - count * FRAC_PI_2).abs() <= tolerance;
    near.then_some(count.rem_euclid(4.0) as u8)
}

/// The nearest multiple of 90° if the angle differs from it by at most the tolerance; otherwise the angle.
pub(crate) fn snapped(angle: f64, tolerance: f64) -> f64 {
    match right_angles(angle, tolerance) {
        Some(_) => (angle / FRAC_PI_2).round() * FRAC_PI_2,
        None => angle,
    }
}

/// Whether rounding the angle with this tolerance would change its sine or cosine.
pub(crate) fn is_nearly_right(angle: f64, tolerance: f64) -> bool {
    let (s, c) = sin_cos(angle);
    right_angles(angle, tolerance).is_some() && s != 0.0 && c != 0.0
}

/// Rotation of a unit quaternion w + x i + y j + z k. If all entries are within `tolerance` of 0 or ±1, they
/// are rounded to these values.
pub(crate) fn from_quaternion([w, x, y, z]: [f64; 4], tolerance: f64) -> Rotation {
    let rotation = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ];
    let tolerance = tolerance.max(8.0 * f64::EPSILON);
    let near = |value: f64| (value - value.round()).abs() <= tolerance;
    match rotation.iter().flatten().all(|value| near(*value)) {
        true => rotation.map(|row| row.map(|value| value.round() + 0.0)),
        false => rotation,
    }
}

/// Standard Denavit–Hartenberg row: pose of frame i in the frame that turns with joint i.
///
/// The pose is `T_z(d) T_x(a) R_x(α)`. The joint's rotation `R_z(θ)` precedes it (Denavit and Hartenberg,
/// 1955).
pub(crate) fn standard_dh(d: Formula, a: Formula, alpha: f64) -> Pose {
    Pose { translation: [a, Formula::ZERO, d], rotation: about_x(alpha) }
}

/// Modified Denavit–Hartenberg row: pose of frame i in frame i − 1 at position 0.
///
/// The pose is `R_x(α) T_x(a) R_z(θ) T_z(d)` (Khalil and Kleinfinger, 1986; Craig, Introduction to Robotics,
/// 1986).
pub(crate) fn modified_dh(d: Formula, a: Formula, alpha: f64, theta: f64) -> Pose {
    let tilt = Pose { translation: [a, Formula::ZERO, Formula::ZERO], rotation: about_x(alpha) };
    let lift = Pose { translation: [Formula::ZERO, Formula::ZERO, d], rotation: about_z(theta) };
    tilt.then(&lift)
}

/// Length of a vector with three components.
pub(crate) fn norm(a: &[f64; 3]) -> f64 {
    numeric::length(*a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn right_angles_are_exact() {
        for (quarter, expected) in
            [(1.0, [0.0, 1.0]), (2.0, [-1.0, 0.0]), (3.0, [0.0, -1.0]), (-1.0, [0.0, -1.0])]
        {
            let [row, _, _] = about_z(quarter * FRAC_PI_2);
            assert_eq!([row[0], -row[1]], expected, "{quarter}");
        }
        assert_eq!(from_rpy([0.0, PI, 0.0]), [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]);
        let half = std::f64::consts::FRAC_1_SQRT_2;
        assert_eq!(from_quaternion([half, half, 0.0, 0.0], 0.0), about_x(FRAC_PI_2));
    }

    #[test]
    #[expect(clippy::approx_constant, reason = "what vendors write")]
    fn nearly_right_angles_stay_unless_snapped() {
        assert_ne!(about_x(1.5708)[1][1], 0.0);
        assert_eq!(about_x(snapped(1.5708, 1e-4))[1][1], 0.0);
        assert_eq!(snapped(1.57, 1e-4), 1.57);
        assert!(is_nearly_right(1.57079632679, 1e-4) && !is_nearly_right(FRAC_PI_2, 1e-4));
        assert!(!is_nearly_right(0.0, 1e-4) && is_nearly_right(1e-6, 1e-4));
    }

    #[test]
    fn rpy_turns_about_fixed_axes_in_this_order() {
        // Roll by 90° takes y to z, then yaw by 90° leaves z.
        let rotation = from_rpy([FRAC_PI_2, 0.0, FRAC_PI_2]);
        assert_eq!(rotate_numbers(&rotation, &[0.0, 1.0, 0.0]), [0.0, 0.0, 1.0]);
        assert_eq!(rotate_numbers(&rotation, &[1.0, 0.0, 0.0]), [0.0, 1.0, 0.0]);
    }
}
