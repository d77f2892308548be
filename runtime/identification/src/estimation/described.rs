//! Comparison of the rigid-body forces in the efforts with the forces of the described bodies. No body is estimated.

use super::super::pose::rows_of;
use super::super::robot::Robot;
use super::super::run::{Effort, PreparedRun};
use super::blocks::{FRICTION, sums_of_blocks};
use super::normal::with_ridge;
use super::sums::Piece;
use super::unit::{CommonRatio, Sizes, common_ratio};
use nalgebra::DMatrix;

/// Ratio of measured to described rigid-body forces for the robot as a whole; `None` if no joint determines the ratio, or if
/// the efforts are currents and a motor constant is not described.
pub(crate) fn described_ratio(robot: &dyn Robot, runs: &[PreparedRun]) -> Option<CommonRatio> {
    let (exact, effort) =
        (rows_of(&robot.quaternion_joints(), robot.joint_names().len()), runs.first()?.effort);
    if effort == Effort::Current && robot.described_currents().contains(&false) {
        return None;
    }
    let whole = |(run, samples): (usize, &PreparedRun)| Piece { run, fold: 0, rows: 0..samples.times.len() };
    let pieces: Vec<Piece> = runs.iter().enumerate().map(whole).collect();
    let sums = sums_of_blocks(robot, runs, &pieces, 0.0).ok()?.pop()?;
    let known: Vec<bool> = sums.iter().zip(exact).map(|(sums, exact)| !exact && sums.samples > 0.0).collect();
    let sizes: Vec<Sizes> = sums.iter().map(|sums| sizes(&sums.products)).collect();
    common_ratio(robot, effort, &known, &sizes)
}

/// Root sums of squares of a joint's rigid-body force from a regression on the described force, an offset and friction, of its
/// described rigid-body force, and of its measured force. The last columns are those of the regression and the measured force.
fn sizes(products: &DMatrix<f64>) -> Sizes {
    let (force, measured) = (products.nrows() - 2, products.nrows() - 1);
    let first = force - FRICTION;
    let normal = with_ridge(products.view_range(first..measured, first..measured).into_owned());
    let right = products.view_range(first..measured, measured..=measured).into_owned();
    let factor = normal.cholesky().map_or(0.0, |normal| normal.solve(&right)[(FRICTION, 0)]);
    let size = |place: usize| products[(place, place)].max(0.0).sqrt();
    [factor.max(0.0) * size(force), size(force), size(measured)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;

    /// Friction and an offset do not change the factor.
    #[test]
    fn the_factor_is_that_of_the_described_force() {
        let mut sums = DMatrix::zeros(FRICTION + 2, FRICTION + 2);
        for i in 0..500 {
            let t = 0.02 * f64::from(i);
            let (force, v) = ((1.7 * t).sin() + 2.0, (0.9 * t).cos());
            let friction = [100.0, 40.0, 17.0, 7.0].map(|k: f64| (k * v).tanh());
            let measured = 12.0 * force - 3.0 + 5.0 * v + friction[1];
            let row = [&[1.0, v][..], &friction, &[force, measured]].concat();
            let row = DVector::from_vec(row);
            sums.ger(1.0, &row, &row, 1.0);
        }
        let [needed, described, _] = sizes(&sums);
        assert!((needed / described - 12.0).abs() < 1e-4, "{}", needed / described);
    }
}
