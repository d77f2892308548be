//! Choice of the joints that shafts of drives replace in the fit. The fit has an equation for each joint. The
//! equation of a shaft that acts on several joints replaces that of one of these joints.

use nalgebra::{DMatrix, RowDVector};

/// Largest entry that counts as rounding error, as a fraction of the shaft's largest entry.
const ROUNDING: f64 = 1e-9;

/// Returns for each shaft the joint whose row in the fit it replaces. The result is `None` if the motion of
/// the shaft depends only on rows that are already replaced or must not be replaced.
///
/// Shafts choose in their order. A shaft replaces the joint along which it turns most while the motions of
/// all other rows are fixed. If several joints are equal, it replaces the first one.
///
/// - `ratios`: for each shaft, its displacement for a unit displacement of each joint
/// - `free`: for each joint, whether its row may be replaced
pub(super) fn seats(ratios: &[Vec<f64>], free: &[bool]) -> Vec<Option<usize>> {
    let joints = free.len();
    let mut rows = DMatrix::<f64>::identity(joints, joints);
    let mut free = free.to_vec();
    let mut seat = |shaft: &Vec<f64>| {
        let shaft = RowDVector::from_row_slice(shaft);
        let along = &shaft * rows.clone().try_inverse()?;
        let largest = along.amax();
        let may = |joint: &usize| free[*joint] && along[*joint].abs() > ROUNDING * largest;
        let taken = (0..joints)
            .filter(may)
            .reduce(|best, joint| if along[joint].abs() > along[best].abs() { joint } else { best })?;
        free[taken] = false;
        rows.set_row(taken, &shaft);
        Some(taken)
    };
    ratios.iter().map(|shaft| if shaft.len() == joints { seat(shaft) } else { None }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shafts_take_the_rows_of_joints_without_drives() {
        let differential = [vec![80.0, 80.0], vec![80.0, -80.0]];
        assert_eq!(seats(&differential, &[true, true]), [Some(0), Some(1)]);
        // The second joint has no drive of its own, and the motor acts on both joints, as in many wrists.
        assert_eq!(seats(&[vec![32.0, 32.0]], &[false, true]), [Some(1)]);
        // Three motors move two joints, and two motors turn equally.
        assert_eq!(
            seats(&[vec![1.0, 1.0], vec![1.0, -1.0], vec![1.0, 2.0]], &[true; 2]),
            [Some(0), Some(1), None]
        );
        assert_eq!(seats(&[vec![1.0, 1.0], vec![2.0, 2.0]], &[true; 2]), [Some(0), None]);
        assert_eq!(seats(&[vec![1.0, 1.0]], &[false; 2]), [None]);
    }
}
