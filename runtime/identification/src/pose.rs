//! Joints whose orientation is a quaternion (spherical and floating joints): their poses, and the displacements between poses,
//! which can be filtered.

use gelenk_dynamics::dynamics::{difference, integrate};

/// A spherical or floating joint.
///
/// The positions of a spherical joint are a quaternion x, y, z, w of unit length. A floating joint has the position of its
/// origin in the parent's frame before the quaternion. The velocities of a spherical joint are the angular velocity in the
/// body's frame. A floating joint has the linear velocity of its origin in the same frame before the angular velocity.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct QuaternionJoint {
    /// Name of the joint.
    pub name: String,
    /// Index of the joint's first position entry.
    pub position: usize,
    /// Index of the joint's first velocity entry.
    pub velocity: usize,
    /// Whether the joint is floating instead of spherical.
    pub is_floating: bool,
}

impl QuaternionJoint {
    /// Range of the joint's position entries.
    pub(crate) fn positions(&self) -> std::ops::Range<usize> {
        self.position..self.position + if self.is_floating { 7 } else { 4 }
    }

    /// Range of the joint's velocity entries.
    pub(crate) fn velocities(&self) -> std::ops::Range<usize> {
        self.velocity..self.velocity + if self.is_floating { 6 } else { 3 }
    }

    /// Index of the quaternion's first entry among the joint's positions.
    pub(crate) fn quaternion(&self) -> usize {
        if self.is_floating { 3 } else { 0 }
    }

    /// Displacement `to ⊖ from` between two poses of this joint: the constant velocity that moves the joint from one pose to
    /// the other in one second, with the shorter rotation.
    pub(crate) fn way(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        if self.is_floating {
            return difference::<1, 6, 7>(&[7], &entries(from), &entries(to)).to_vec();
        }
        difference::<1, 3, 4>(&[4], &entries(from), &entries(to)).to_vec()
    }

    /// The pose `pose ⊕ way`, which the displacement `way` reaches.
    pub(crate) fn moved(&self, pose: &[f64], way: &[f64]) -> Vec<f64> {
        if self.is_floating {
            return integrate::<1, 6, 7>(&[7], &entries(pose), &entries(way)).to_vec();
        }
        integrate::<1, 3, 4>(&[4], &entries(pose), &entries(way)).to_vec()
    }
}

/// The first K values; NaN if there are fewer.
fn entries<const K: usize>(values: &[f64]) -> [f64; K] {
    values.first_chunk().copied().unwrap_or([f64::NAN; K])
}

/// For each of `n` velocity entries, whether it belongs to a joint with a quaternion.
///
/// No sensor measures the forces of the rows of such joints. If inputs act there, their sum is the force; otherwise the force
/// is zero. Therefore neither offsets nor friction are estimated for these rows.
pub(crate) fn rows_of(joints: &[QuaternionJoint], n: usize) -> Vec<bool> {
    (0..n).map(|i| joints.iter().any(|joint| joint.velocities().contains(&i))).collect()
}

/// The index of the position entry of each of `n` velocity entries; `None` for entries of joints with a quaternion.
pub(crate) fn plain_positions(joints: &[QuaternionJoint], n: usize) -> Vec<Option<usize>> {
    let before = |i: usize| joints.iter().filter(|joint| joint.velocity < i).count();
    let rows = rows_of(joints, n);
    (0..n).map(|i| (!rows[i]).then(|| i + before(i))).collect()
}

/// Names of the position entries, as in `POSITION_NAMES` of a generated module.
///
/// - `names`: names of the velocity entries
pub(crate) fn position_names(joints: &[QuaternionJoint], names: &[String]) -> Vec<String> {
    let mut all = vec![String::new(); names.len() + joints.len()];
    for (entry, name) in plain_positions(joints, names.len()).into_iter().zip(names) {
        entry.iter().for_each(|entry| all[*entry].clone_from(name));
    }
    for joint in joints {
        let letters = ["x", "y", "z"].into_iter().take(joint.quaternion()).chain(["qx", "qy", "qz", "qw"]);
        let places = all[joint.positions()].iter_mut().zip(letters);
        places.for_each(|(place, letter)| *place = format!("{}_{letter}", joint.name));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joints() -> [QuaternionJoint; 2] {
        let joint = |name: &str, position, velocity, is_floating| QuaternionJoint {
            name: name.into(),
            position,
            velocity,
            is_floating,
        };
        [joint("base", 0, 0, true), joint("ball", 8, 7, false)]
    }

    #[test]
    fn entries_have_their_places() {
        let [base, ball] = joints();
        assert_eq!((base.positions(), base.velocities()), (0..7, 0..6));
        assert_eq!((ball.positions(), ball.velocities()), (8..12, 7..10));
        let plain = plain_positions(&joints(), 11);
        assert_eq!((plain[6], plain[10], plain[0], plain[8]), (Some(7), Some(12), None, None));
        assert_eq!(rows_of(&joints(), 11).iter().filter(|row| **row).count(), 9);
    }

    #[test]
    fn ways_lead_to_their_ends_and_signs_do_not_matter() {
        let base = &joints()[0];
        let from = [1.0, -2.0, 0.5, 0.5, 0.5, 0.5, 0.5];
        let way = [0.3, 0.1, -0.2, 0.4, -0.7, 0.2];
        let to = base.moved(&from, &way);
        let other: Vec<f64> = to.iter().enumerate().map(|(i, x)| if i < 3 { *x } else { -x }).collect();
        for end in [&to, &other] {
            let back = base.way(&from, end);
            assert!(back.iter().zip(way).all(|(a, b)| (a - b).abs() < 1e-14), "{back:?}");
        }
    }
}
