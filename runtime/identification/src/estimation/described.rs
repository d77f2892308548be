//! Comparison of the rigid-body forces in the efforts with the forces of the described bodies. No body is estimated.

use super::super::numeric::statistics::largest;
use super::super::pose::rows_of;
use super::super::robot::Robot;
use super::super::run::{Effort, PreparedRun};
use super::levels;
use super::normal::with_ridge;
use super::unit::{CommonRatio, Sizes, common_ratio};
use nalgebra::{DMatrix, DVector};

/// Columns of the regression of a joint: the described force, an offset, viscous friction and Coulomb friction.
const COLUMNS: usize = 4;
/// Ratio of measured to described rigid-body forces for the robot as a whole; `None` if no joint determines the ratio, or if
/// the efforts are currents and a motor constant is not described.
pub(crate) fn described_ratio(robot: &dyn Robot, runs: &[PreparedRun]) -> Option<CommonRatio> {
    let (joints, effort) = (robot.joint_names().len(), runs.first()?.effort);
    if effort == Effort::Current && robot.described_currents().contains(&false) {
        return None;
    }
    let exact = rows_of(&robot.quaternion_joints(), joints);
    let mut sums = vec![DMatrix::zeros(COLUMNS + 1, COLUMNS + 1); joints];
    let fastest: Vec<f64> =
        (0..joints).map(|joint| largest(runs.iter().flat_map(|run| &run.velocities[joint]))).collect();
    for run in runs {
        add(robot, run, &fastest, &mut sums);
    }
    let known: Vec<bool> =
        (0..joints).map(|j| !exact[j] && fastest[j] > 0.0 && is_finite(&sums[j])).collect();
    let sizes: Vec<Sizes> = sums.iter().map(sizes).collect();
    common_ratio(robot, effort, &known, &sizes)
}

fn is_finite(sums: &DMatrix<f64>) -> bool {
    sums.iter().all(|x| x.is_finite())
}

/// Adds the products of the columns and of the measured force of each joint, without the samples at rest.
fn add(robot: &dyn Robot, run: &PreparedRun, fastest: &[f64], sums: &mut [DMatrix<f64>]) {
    let matrix = robot.input_matrix();
    let mut forces = vec![0.0; sums.len()];
    for i in 0..run.times.len() {
        let [y, v, a] = run.state(i);
        robot.rigid_forces(&y, &v, &a, &mut forces);
        for (joint, sums) in sums.iter_mut().enumerate().filter(|(joint, _)| !run.rests(*joint, i)) {
            let share = if fastest[joint] > 0.0 { v[joint] / fastest[joint] } else { 0.0 };
            let friction = (levels::STEEPNESS.get() * share).tanh();
            let row =
                DVector::from_vec(vec![forces[joint], 1.0, share, friction, run.force(&matrix, joint, i)]);
            sums.ger(1.0, &row, &row, 1.0);
        }
    }
}

/// Root sums of squares of a joint's rigid-body force from the regression, of its described rigid-body force, and of its
/// measured force.
fn sizes(sums: &DMatrix<f64>) -> Sizes {
    let normal = with_ridge(sums.view((0, 0), (COLUMNS, COLUMNS)).into_owned());
    let right = sums.view((0, COLUMNS), (COLUMNS, 1)).into_owned();
    let factor = normal.cholesky().map_or(0.0, |normal| normal.solve(&right)[(0, 0)]);
    let size = |place: usize| sums[(place, place)].max(0.0).sqrt();
    [factor.max(0.0) * size(0), size(0), size(COLUMNS)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Friction and an offset do not change the factor.
    #[test]
    fn the_factor_is_that_of_the_described_force() {
        let mut sums = DMatrix::zeros(COLUMNS + 1, COLUMNS + 1);
        for i in 0..500 {
            let t = 0.02 * f64::from(i);
            let (force, share) = ((1.7 * t).sin() + 2.0, (0.9 * t).cos());
            let friction = (levels::STEEPNESS.get() * share).tanh();
            let row = DVector::from_vec(vec![
                force,
                1.0,
                share,
                friction,
                12.0 * force - 3.0 + 5.0 * share + friction,
            ]);
            sums.ger(1.0, &row, &row, 1.0);
        }
        let [needed, described, _] = sizes(&sums);
        assert!((needed / described - 12.0).abs() < 1e-4, "{}", needed / described);
    }
}
