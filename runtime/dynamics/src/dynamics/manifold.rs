//! Robots with quaternions, which have more position entries than velocities.

use super::names::Named;
use core::fmt;
use gelenk_kernels::manifold;

/// Value of `NY` for a module without the constant `NY`. Its positions and velocities have the same number of
/// entries.
pub const NO_POSITIONS: usize = usize::MAX;

/// Value of `JOINT_POSITIONS` for a module without this constant.
pub const NO_WIDTHS: [usize; 0] = [];

/// Returns the number of position entries of a robot with `n` velocity entries.
///
/// - `positions`: `NY` of the module, or [`NO_POSITIONS`]
#[must_use]
pub const fn positions_of(positions: usize, n: usize) -> usize {
    if positions == NO_POSITIONS { n } else { positions }
}

/// A joint whose attitude is a quaternion x, y, z, w.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct QuaternionJoint {
    /// Name of the joint.
    pub name: &'static str,
    /// Index of the joint's first entry in the positions.
    pub position: usize,
    /// Index of the joint's first entry in the velocities.
    pub velocity: usize,
    /// Whether the joint is floating. For a floating joint, the position in the frame of the parent precedes the quaternion, and
    /// the linear velocity precedes the angular velocity. Otherwise the joint is spherical.
    pub is_floating: bool,
}

impl QuaternionJoint {
    /// Index of the first entry of the quaternion.
    #[must_use]
    pub const fn quaternion(&self) -> usize {
        if self.is_floating { self.position + 3 } else { self.position }
    }

    /// Index of the first entry of the angular velocity.
    #[must_use]
    pub const fn angular_velocity(&self) -> usize {
        if self.is_floating { self.velocity + 3 } else { self.velocity }
    }
}

/// Returns the indices of velocity entry and position entry, for each joint without a quaternion.
///
/// - `joints`: joints with quaternions, in order
/// - `n`: number of velocity entries
pub fn plain_entries(joints: &[QuaternionJoint], n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).filter_map(move |velocity| {
        let before = joints.iter().take_while(|joint| joint.velocity <= velocity).count();
        let last = before.checked_sub(1).and_then(|k| joints.get(k));
        let is_plain = last.is_none_or(|joint| joint.angular_velocity() + 3 <= velocity);
        is_plain.then_some((velocity, velocity + before))
    })
}

/// Returns one position for each velocity entry. The positions of joints with quaternions are replaced by 0.
///
/// - `joints`: joints with quaternions, in order
#[inline]
pub fn plain_positions<const N: usize, const NY: usize>(
    joints: &[QuaternionJoint],
    y: &[f64; NY],
) -> [f64; N] {
    if N == NY {
        return core::array::from_fn(|i| y[i]);
    }
    let mut positions = [0.0; N];
    for (velocity, position) in plain_entries(joints, N) {
        positions[velocity] = y.get(position).copied().unwrap_or(f64::NAN);
    }
    positions
}

/// Returns the rates `ẏ = T(y) v` of the positions y for the velocities v. Linear velocities are rotated to
/// the frame of the parent. A quaternion q has the rate `q̇ = ½ q (ω, 0)` with the angular velocity ω.
///
/// - `joints`: joints with quaternions, in order
pub fn position_rates<const N: usize, const NY: usize>(
    joints: &[QuaternionJoint],
    y: &[f64; NY],
    v: &[f64; N],
) -> [f64; NY] {
    let mut rates = [0.0; NY];
    for (velocity, position) in plain_entries(joints, N) {
        if let Some(rate) = rates.get_mut(position) {
            *rate = v[velocity];
        }
    }
    for joint in joints {
        let q = entries(y, joint.quaternion());
        let w = entries(v, joint.angular_velocity());
        set(&mut rates, joint.quaternion(), &quaternion_rate(&q, &w));
        if joint.is_floating {
            set(&mut rates, joint.position, &turned(&q, &entries(v, joint.velocity)));
        }
    }
    rates
}

fn quaternion_rate([x, y, z, w]: &[f64; 4], [a, b, c]: &[f64; 3]) -> [f64; 4] {
    [
        0.5 * (w * a + y * c - z * b),
        0.5 * (w * b + z * a - x * c),
        0.5 * (w * c + x * b - y * a),
        -0.5 * (x * a + y * b + z * c),
    ]
}

/// Rotates a vector from the frame of the body to the axes of the parent.
fn turned([x, y, z, w]: &[f64; 4], [a, b, c]: &[f64; 3]) -> [f64; 3] {
    let [d, e, f] = [2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)];
    [a + w * d + (y * f - z * e), b + w * e + (z * d - x * f), c + w * f + (x * e - y * d)]
}

fn entries<const K: usize>(all: &[f64], first: usize) -> [f64; K] {
    let chunk = all.get(first..).and_then(|rest| rest.first_chunk());
    *chunk.unwrap_or(&[f64::NAN; K])
}

fn set<const K: usize>(all: &mut [f64], first: usize, values: &[f64; K]) {
    if let Some(chunk) = all.get_mut(first..).and_then(|rest| rest.first_chunk_mut()) {
        *chunk = *values;
    }
}

/// Number of joints with a quaternion, for the numbers of position entries of all joints.
#[must_use]
pub const fn count_quaternions(widths: &[usize]) -> usize {
    let (mut count, mut joint) = (0, 0);
    while joint < widths.len() {
        count += (widths[joint] > 1) as usize;
        joint += 1;
    }
    count
}

/// Joints with a quaternion. The compiler evaluates this function, so its panics are compile errors.
#[must_use]
pub const fn quaternion_joints<const C: usize>(
    names: &[&'static str],
    widths: &[usize],
) -> [QuaternionJoint; C] {
    let none = QuaternionJoint { name: "", position: 0, velocity: 0, is_floating: false };
    let mut joints = [none; C];
    let (mut found, mut joint, mut position, mut velocity) = (0, 0, 0, 0);
    while joint < widths.len() {
        let width = widths[joint];
        assert!(width == 1 || width == 4 || width == 7, "a joint has 1, 4 or 7 positions");
        if width > 1 {
            let is_floating = width == 7;
            joints[found] = QuaternionJoint { name: names[joint], position, velocity, is_floating };
            found += 1;
        }
        position += width;
        velocity += if width > 1 { width - 1 } else { 1 };
        joint += 1;
    }
    joints
}

/// Error: a quaternion in the positions is not an attitude, because its length differs from 1 or is not
/// finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttitudeError {
    /// Name of the joint.
    pub joint: &'static str,
    /// Quaternion x, y, z, w of the joint.
    pub quaternion: [f64; 4],
}

/// Largest allowed deviation of the length of a quaternion from 1. Quaternions that were written as text with seven or more digits
/// meet this tolerance.
pub const UNIT_LENGTH: f64 = 1e-6;

impl fmt::Display for AttitudeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (joint, [x, y, z, w]) = (Named(self.joint), self.quaternion);
        write!(f, "the quaternion of joint {joint}, x {x} y {y} z {z} w {w}, ")?;
        match length(&self.quaternion) {
            length if !length.is_finite() => write!(f, "is not finite"),
            0.0 => write!(f, "is zero, so it is not an attitude"),
            length => write!(f, "has length {length}; normalize it to length 1"),
        }
    }
}

impl core::error::Error for AttitudeError {}

fn length(q: &[f64; 4]) -> f64 {
    gelenk_kernels::math::sqrt(q.iter().map(|q| q * q).sum())
}

/// Checks that all quaternions are attitudes.
///
/// # Errors
/// [`AttitudeError`] for the first quaternion that is zero, not finite, or whose length differs from 1 by more than
/// [`UNIT_LENGTH`].
pub(super) fn check(joints: &[QuaternionJoint], y: &[f64]) -> Result<(), AttitudeError> {
    for joint in joints {
        let quaternion = entries(y, joint.quaternion());
        // This form rejects NaN.
        let is_attitude = (length(&quaternion) - 1.0).abs() <= UNIT_LENGTH;
        if !is_attitude {
            return Err(AttitudeError { joint: joint.name, quaternion });
        }
    }
    Ok(())
}

/// Returns the array unchanged. Does not compile for robots with quaternions, because default methods that
/// call this function are only correct for arms.
#[inline]
pub(super) fn same<const A: usize, const B: usize>(entries: &[f64; A]) -> &[f64; B] {
    const {
        assert!(A == B, "a robot with quaternions must override this method");
    }
    entries.first_chunk().unwrap_or(const { &[f64::NAN; B] })
}

/// Computes the positions `y ⊕ d` after a motion from y with the constant velocities d for one second.
///
/// - `widths`: number of position entries of each joint. If it is empty, the robot has no quaternions, and
///   the result is `y + d`.
#[inline]
pub fn integrate<const J: usize, const N: usize, const NY: usize>(
    widths: &[usize; J],
    y: &[f64; NY],
    d: &[f64; N],
) -> [f64; NY] {
    if J == 0 {
        require_widths::<J, N, NY>();
        return core::array::from_fn(|i| y[i] + d[i]);
    }
    manifold::integrate(widths, y, d)
}

/// Computes `to ⊖ from`: the constant velocities that lead from `from` to `to` in one second.
///
/// - `widths`: number of position entries of each joint; empty for a robot without quaternions
#[inline]
pub fn difference<const J: usize, const N: usize, const NY: usize>(
    widths: &[usize; J],
    from: &[f64; NY],
    to: &[f64; NY],
) -> [f64; N] {
    if J == 0 {
        require_widths::<J, N, NY>();
        return core::array::from_fn(|i| to[i] - from[i]);
    }
    manifold::difference(widths, from, to)
}

/// Derivatives of `y ⊕ d` with respect to small displacements of y and with respect to d.
///
/// - `widths`: number of position entries of each joint; empty for a robot without quaternions
#[inline]
pub fn integrate_derivatives<const J: usize, const N: usize>(
    widths: &[usize; J],
    d: &[f64; N],
) -> ([[f64; N]; N], [[f64; N]; N]) {
    if J == 0 { (diagonal(1.0), diagonal(1.0)) } else { manifold::integrate_derivatives(widths, d) }
}

/// Derivatives of `d = to ⊖ from` with respect to small displacements of `to` and of `from`.
///
/// - `widths`: number of position entries of each joint; empty for a robot without quaternions
#[inline]
pub fn difference_derivatives<const J: usize, const N: usize>(
    widths: &[usize; J],
    d: &[f64; N],
) -> ([[f64; N]; N], [[f64; N]; N]) {
    if J == 0 { (diagonal(1.0), diagonal(-1.0)) } else { manifold::difference_derivatives(widths, d) }
}

/// Computes the Lie bracket `ad_a b` of the velocities a and b of each joint; 0 for joints without a
/// quaternion.
///
/// - `widths`: number of position entries of each joint; empty for a robot without quaternions
#[inline]
pub fn bracket<const J: usize, const N: usize>(widths: &[usize; J], a: &[f64; N], b: &[f64; N]) -> [f64; N] {
    if J == 0 { [0.0; N] } else { manifold::bracket(widths, a, b) }
}

/// Normalizes all quaternions. Returns false if a quaternion is zero or not finite.
#[inline]
pub fn normalize<const J: usize, const NY: usize>(widths: &[usize; J], y: &mut [f64; NY]) -> bool {
    manifold::normalize(widths, y)
}

/// Returns positions 0 with identity quaternions.
#[inline]
pub fn neutral<const J: usize, const NY: usize>(widths: &[usize; J]) -> [f64; NY] {
    manifold::neutral(widths)
}

/// Matrix `D = −ad_v` in `δ̇ = D δ`, the rate of a small displacement δ between two motions with the same velocities v.
pub(super) fn drift<const N: usize>(
    bracket: impl Fn(&[f64; N], &[f64; N]) -> [f64; N],
    v: &[f64; N],
) -> [[f64; N]; N] {
    let mut drift = [[0.0; N]; N];
    for j in 0..N {
        let mut unit = [0.0; N];
        unit[j] = 1.0;
        let column = bracket(v, &unit);
        (0..N).for_each(|i| drift[i][j] = 0.0 - column[i]);
    }
    drift
}

#[inline]
fn diagonal<const N: usize>(entry: f64) -> [[f64; N]; N] {
    core::array::from_fn(|i| core::array::from_fn(|j| if i == j { entry } else { 0.0 }))
}

const fn require_widths<const J: usize, const N: usize, const NY: usize>() {
    const { assert!(J > 0 || N == NY, "a robot with quaternions must list its joints with quaternions") }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plain joint, a spherical one, a floating one, a plain one.
    const WIDTHS: [usize; 4] = [1, 4, 7, 1];
    const JOINTS: [QuaternionJoint; 2] = quaternion_joints(&["slide", "ball", "body", "hinge"], &WIDTHS);

    #[test]
    fn joints_stand_where_the_widths_say() {
        let [ball, body] = JOINTS;
        assert_eq!((ball.name, ball.quaternion(), ball.angular_velocity()), ("ball", 1, 1));
        assert_eq!((body.name, body.quaternion(), body.angular_velocity()), ("body", 8, 7));
        assert_eq!(count_quaternions(&WIDTHS), 2);
        let plain: Vec<(usize, usize)> = plain_entries(&JOINTS, 11).collect();
        assert_eq!(plain, [(0, 0), (10, 12)]);
        let arm: Vec<(usize, usize)> = plain_entries(&[], 3).collect();
        assert_eq!(arm, [(0, 0), (1, 1), (2, 2)]);
        let y: [f64; 13] = core::array::from_fn(|i| i as f64);
        let mut expected = [0.0; 11];
        expected[10] = 12.0;
        assert_eq!(plain_positions::<11, 13>(&JOINTS, &y), expected);
    }

    /// ẏ = T(y) v is the derivative of `y ⊕ v t`.
    #[test]
    fn rates_are_those_of_moving() {
        let y = [0.3, 0.5, -0.5, 0.5, 0.5, 1.0, 2.0, 3.0, 0.1, 0.7, -0.5, 0.5, 0.4];
        let v: [f64; 11] = [0.4, 1.0, -2.0, 0.5, 0.3, -0.7, 0.9, -1.2, 0.8, 0.6, 2.0];
        let rates = position_rates(&JOINTS, &y, &v);
        let [before, after] = [-1e-6, 1e-6].map(|h| integrate::<4, 11, 13>(&WIDTHS, &y, &v.map(|v| h * v)));
        for i in 0..13 {
            let quotient = (after[i] - before[i]) / 2e-6;
            assert!((rates[i] - quotient).abs() < 1e-9, "{i}: {} is not {quotient}", rates[i]);
        }
    }

    #[test]
    fn the_second_attitude_is_checked_too() {
        let mut y = [0.0; 13];
        (y[4], y[11]) = (1.0, 1.0);
        assert_eq!(check(&JOINTS, &y), Ok(()));
        y[11] = 0.0;
        assert_eq!(check(&JOINTS, &y).map_err(|error| error.joint), Err("body"));
        y[1] = f64::NAN;
        assert_eq!(check(&JOINTS, &y).map_err(|error| error.joint), Err("ball"));
    }
}
