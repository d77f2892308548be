//! Joints that follow coordinates and driven joints, `θ = G y + G_d d + g₀`, and their limits.

/// A joint with limits whose position `θ = G y + G_d d + g₀` follows coordinates y and driven joints d, with
/// the ratios G and G_d and the offset g₀. Code that keeps the limits of coordinates also keeps the limits of
/// these joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DependentJoint<const N: usize> {
    /// Name of the joint.
    pub name: &'static str,
    /// Ratios G: motion of this joint per unit of motion of each coordinate.
    pub ratios: [f64; N],
    /// Ratios G_d: motion of this joint per unit of motion of each driven joint; empty for a robot without driven joints.
    pub driven_ratios: &'static [f64],
    /// Offset g₀: position of this joint if all followed joints are at 0 [rad or m].
    pub offset: f64,
    /// Lower and upper position limit [rad or m]; infinite without a limit.
    pub position: [f64; 2],
    /// Speed limit [rad/s or m/s]; infinite without a limit.
    pub velocity: f64,
}

impl<const N: usize> DependentJoint<N> {
    /// Position [rad or m] and velocity [rad/s or m/s] of the joint, for positions `y` and velocities `v` of the coordinates. The
    /// result is NaN if the joint follows a driven joint with unknown motion.
    ///
    /// - `driven`: position, velocity and acceleration of each driven joint, see
    ///   [`Dynamics::driven_motion`](super::Dynamics::driven_motion)
    #[must_use]
    pub fn motion(&self, y: &[f64; N], v: &[f64; N], driven: &[[f64; 3]]) -> [f64; 2] {
        let mut motion = [self.offset, 0.0];
        let mut add = |ratio: f64, [y, v]: [f64; 2]| {
            // The motion of a driven joint that this joint does not follow may be NaN, and is not needed.
            if ratio != 0.0 {
                motion[0] += ratio * y;
                motion[1] += ratio * v;
            }
        };
        for i in 0..N {
            add(self.ratios[i], [y[i], v[i]]);
        }
        for (j, ratio) in self.driven_ratios.iter().enumerate() {
            let [y, v, _] = driven.get(j).copied().unwrap_or([f64::NAN; 3]);
            add(*ratio, [y, v]);
        }
        motion
    }

    /// Whether the joint follows driven joints.
    #[must_use]
    pub const fn follows_driven_joints(&self) -> bool {
        count(self.driven_ratios) > 0
    }

    /// Index of the followed coordinate if the joint follows exactly one coordinate and no driven joint; `None` otherwise.
    #[must_use]
    pub fn followed_alone(&self) -> Option<usize> {
        if self.follows_driven_joints() || count(&self.ratios) != 1 {
            return None;
        }
        self.ratios.iter().position(|ratio| *ratio != 0.0)
    }

    /// Whether the joint follows several coordinates and no driven joint.
    #[must_use]
    pub const fn is_sum(&self) -> bool {
        !self.follows_driven_joints() && count(&self.ratios) > 1
    }

    /// Whether the position of the joint has a limit.
    #[must_use]
    pub const fn has_position_limit(&self) -> bool {
        self.position[0] != f64::NEG_INFINITY || self.position[1] != f64::INFINITY
    }

    /// Whether the speed of the joint has a limit.
    #[must_use]
    pub const fn has_velocity_limit(&self) -> bool {
        self.velocity != f64::INFINITY
    }

    /// Index of the followed coordinate, and limits of its position and speed for which this joint keeps its limits; `None` if the
    /// joint follows several coordinates or a driven joint.
    fn limits_of_followed(&self) -> Option<(usize, [f64; 2], f64)> {
        let i = self.followed_alone()?;
        let ratio = self.ratios[i];
        let [a, b] = self.position.map(|end| (end - self.offset) / ratio);
        Some((i, if ratio > 0.0 { [a, b] } else { [b, a] }, self.velocity / ratio.abs()))
    }
}

const fn count(ratios: &[f64]) -> usize {
    let (mut i, mut found) = (0, 0);
    while i < ratios.len() {
        if ratios[i] != 0.0 {
            found += 1;
        }
        i += 1;
    }
    found
}

/// Narrows the limits of coordinates so that joints that follow a single coordinate keep their limits.
pub(super) fn narrowed<const N: usize>(
    joints: &[DependentJoint<N>],
    positions: &mut [[f64; 2]; N],
    velocities: &mut [f64; N],
) {
    for (i, [low, high], velocity) in joints.iter().filter_map(DependentJoint::limits_of_followed) {
        positions[i] = [positions[i][0].max(low), positions[i][1].min(high)];
        velocities[i] = velocities[i].min(velocity);
    }
}

/// Number of rows for the limits of joints that follow several coordinates, see [`LimitRows`].
pub const fn count_rows<const N: usize>(joints: &[DependentJoint<N>]) -> usize {
    let (mut i, mut rows) = (0, 0);
    while i < joints.len() {
        if joints[i].is_sum() {
            rows += joints[i].has_position_limit() as usize + joints[i].has_velocity_limit() as usize;
        }
        i += 1;
    }
    rows
}

/// Number NR of rows that limit weighted sums. The rows are `lower ≤ G y + g₀ ≤ upper` and `|G ẏ| ≤ limit` for joints that follow
/// several coordinates, and `|u + c ẏ| ≤ limit` for torque–speed lines of motors. [`dynamics!`](crate::dynamics!) implements
/// this trait, so that the size of a predictive controller includes all rows.
#[diagnostic::on_unimplemented(
    note = "a hand-written robot must declare the number of rows for joints that follow several coordinates and \
            for torque–speed lines: `impl LimitRows<0> for Robot {{}}`"
)]
pub trait LimitRows<const NR: usize> {}

/// Converts the constants of a module to its K joints that follow other joints.
///
/// - `ratios`, `driven_ratios`: K rows, stored one after the other
pub const fn dependent_joints<const N: usize, const K: usize>(
    names: &[&'static str],
    [ratios, driven_ratios]: [&'static [f64]; 2],
    offsets: &[f64],
    positions: &[[f64; 2]],
    velocities: &[f64],
) -> [DependentJoint<N>; K] {
    const { assert!(N > 0 || K == 0, "a robot without coordinates cannot have joints that follow coordinates") }
    let mut joints = [DependentJoint {
        name: "",
        ratios: [0.0; N],
        driven_ratios: &[],
        offset: 0.0,
        position: [f64::NEG_INFINITY, f64::INFINITY],
        velocity: f64::INFINITY,
    }; K];
    let mut k = 0;
    while k < K {
        let joint = &mut joints[k];
        (joint.name, joint.offset) = (names[k], offsets[k]);
        (joint.position, joint.velocity) = (positions[k], velocities[k]);
        let mut i = 0;
        while i < N {
            joint.ratios[i] = ratios[k * N + i];
            i += 1;
        }
        let width = driven_ratios.len() / K;
        let (_, rest) = driven_ratios.split_at(k * width);
        (joint.driven_ratios, _) = rest.split_at(width);
        k += 1;
    }
    joints
}

/// Value of `DEPENDENT_JOINT_NAMES` for a module without joints that follow other joints.
pub const NO_NAMES: [&str; 0] = [];
/// Value of `DEPENDENT_JOINT_RATIOS`, `DEPENDENT_DRIVEN_RATIOS` and `TORQUE_SPEED_SLOPES` for a module
/// without these constants.
pub const NO_ROWS: [[f64; 0]; 0] = [];
/// Value of `DEPENDENT_JOINT_OFFSETS`, `DEPENDENT_VELOCITY_LIMITS` and `TORQUE_SPEED_LIMITS` for a module
/// without these constants.
pub const NO_NUMBERS: [f64; 0] = [];
/// Value of `DEPENDENT_POSITION_LIMITS` for a module without joints that follow other joints.
pub const NO_RANGES: [[f64; 2]; 0] = [];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_with_limits_take_rows() {
        let joints: [DependentJoint<2>; 2] = dependent_joints(
            &["sum", "alone"],
            [&[1.0, -1.0, 0.0, 2.0], &[]],
            &[0.1, 0.2],
            &[[-1.0, 1.0], [-2.0, 2.0]],
            &[3.0, 4.0],
        );
        assert!(joints[0].has_position_limit() && joints[0].has_velocity_limit() && joints[0].is_sum());
        assert_eq!((joints[1].followed_alone(), joints[1].name), (Some(1), "alone"));
        assert_eq!(count_rows(&joints), 2);
    }
}
