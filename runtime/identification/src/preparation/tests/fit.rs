//! Ordinary least squares over all parameters with friction, independent of the project's estimator.

use super::super::super::robot::Robot;
use super::super::super::run::PreparedRun;
use nalgebra::{DMatrix, DVector};

/// Width v_s of the smooth Coulomb term `tanh(v/v_s)` in rad/s.
pub(crate) const ROUNDING: f64 = 0.02;

/// Returns the columns of joint torques at one sample: the regressor W, then viscous friction, Coulomb friction and offset
/// of each joint.
pub(crate) fn columns(robot: &dyn Robot, y: &[f64], v: &[f64], a: &[f64]) -> DMatrix<f64> {
    let (n, p) = (y.len(), robot.parameters().len());
    let mut w = vec![0.0; n * p];
    robot.inertial_regressor(y, v, a, &mut w);
    DMatrix::from_fn(n, p + 3 * n, |j, k| match k.checked_sub(p) {
        None => w[j * p + k],
        Some(f) if f / 3 == j => [v[j], (v[j] / ROUNDING).tanh(), 1.0][f % 3],
        Some(_) => 0.0,
    })
}

fn at(columns: &[Vec<f64>], i: usize) -> Vec<f64> {
    columns.iter().map(|c| c[i]).collect()
}

fn rows<'a>(
    robot: &'a dyn Robot,
    run: &'a PreparedRun,
) -> impl Iterator<Item = (DMatrix<f64>, Vec<f64>)> + 'a {
    (0..run.times.len()).map(move |i| {
        let (y, v, a) = (at(&run.positions, i), at(&run.velocities, i), at(&run.accelerations, i));
        (columns(robot, &y, &v, &a), at(&run.efforts, i))
    })
}

/// Solves least squares over all joints. Each joint is weighted by the deviation of its efforts, and directions with
/// singular values below 1e-4 are cut.
pub(crate) fn fit(robot: &dyn Robot, runs: &[PreparedRun]) -> DVector<f64> {
    let n = runs[0].positions.len();
    let p = robot.parameters().len() + 3 * n;
    let weights: Vec<f64> = (0..n).map(|j| 1.0 / deviation(runs, j)).collect();
    let (mut gram, mut right) = (DMatrix::zeros(p, p), DVector::zeros(p));
    for run in runs {
        let (mut block, mut target) = (Vec::new(), Vec::new());
        for (w, u) in rows(robot, run) {
            for j in 0..n {
                block.extend(w.row(j).iter().map(|x| x * weights[j]));
                target.push(u[j] * weights[j]);
            }
        }
        let block = DMatrix::from_row_slice(target.len(), p, &block);
        gram += block.tr_mul(&block);
        right += block.tr_mul(&DVector::from_vec(target));
    }
    let scale: Vec<f64> =
        (0..p).map(|k| if gram[(k, k)] > 0.0 { 1.0 / gram[(k, k)].sqrt() } else { 0.0 }).collect();
    let scaled = DMatrix::from_fn(p, p, |r, c| gram[(r, c)] * scale[r] * scale[c]);
    let eigen = scaled.symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    let in_eigen = eigen.eigenvectors.tr_mul(&DVector::from_fn(p, |k, _| right[k] * scale[k]));
    let solved = DVector::from_fn(p, |k, _| {
        if eigen.eigenvalues[k] > 1e-8 * largest { in_eigen[k] / eigen.eigenvalues[k] } else { 0.0 }
    });
    let solution = eigen.eigenvectors * solved;
    DVector::from_fn(p, |k, _| solution[k] * scale[k])
}

fn deviation(runs: &[PreparedRun], j: usize) -> f64 {
    let all: Vec<f64> = runs.iter().flat_map(|r| r.efforts[j].iter().copied()).collect();
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    (all.iter().map(|u| (u - mean).powi(2)).sum::<f64>() / all.len() as f64).sqrt()
}

/// Returns the centred R² of each joint's efforts in `runs` for parameters from other data.
pub(crate) fn r_squared(robot: &dyn Robot, parameters: &DVector<f64>, runs: &[PreparedRun]) -> Vec<f64> {
    let n = runs[0].positions.len();
    let mut squares = vec![0.0; n];
    let mut count = 0.0;
    for (w, u) in runs.iter().flat_map(|run| rows(robot, run)) {
        let predicted = w * parameters;
        for j in 0..n {
            squares[j] += (u[j] - predicted[j]).powi(2);
        }
        count += 1.0;
    }
    (0..n).map(|j| 1.0 - squares[j] / count / deviation(runs, j).powi(2)).collect()
}
