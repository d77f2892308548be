//! Friction and offsets that change over the log, for example while a gear warms up.

use super::super::methods::confidence::{LongRun, quantile};
use super::super::methods::offset::{centre, mean};
use super::super::result::{Drift, Trend};
use super::design::runs;
use super::levels;
use super::task::FrictionData;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use std::ops::Range;

/// The drift over a log; `None` if the law is zero or there are too few samples.
///
/// - `gradients`: derivatives of the law with respect to its coefficients. They are needed because the fit of the coefficients
///   has already explained a part of the trend.
pub(super) fn drift(
    data: &FrictionData,
    law: &[f64],
    gradients: DMatrix<f64>,
    residuals: &[f64],
) -> Option<Drift> {
    let m = law.len();
    let left: Vec<f64> = data.torques.iter().zip(law).map(|(t, l)| t - l).collect();
    let level = mean(&left);
    let from_mean: Vec<f64> = left.iter().map(|x| x - level).collect();
    let time: Vec<f64> = (0..m).map(|i| (i as f64 + 0.5) / m as f64 - 0.5).collect();
    let mut moving: Vec<f64> = time.iter().zip(law).map(|(t, l)| t * l).collect();
    centre(&mut moving, &runs(data));
    let projection = Projection::new(gradients, &runs(data))?;
    let (time, moving) = (projection.residual(time), projection.residual(moving));
    let whole = 0..m;
    Some(Drift {
        offset: trend(&time, &from_mean, &[whole])?,
        friction: trend(&moving, residuals, &runs(data))?,
    })
}

/// Projection on the columns of the law by least squares.
struct Projection {
    columns: DMatrix<f64>,
    factor: Cholesky<f64, Dyn>,
}

impl Projection {
    fn new(mut columns: DMatrix<f64>, runs: &[Range<usize>]) -> Option<Self> {
        let m = columns.nrows();
        for column in columns.as_mut_slice().chunks_exact_mut(m) {
            centre(column, runs);
        }
        let mut gram = columns.tr_mul(&columns);
        for i in 0..gram.nrows() {
            gram[(i, i)] = gram[(i, i)] * (1.0 + 1e-9) + f64::MIN_POSITIVE;
        }
        Some(Self { factor: gram.cholesky()?, columns })
    }

    fn residual(&self, series: Vec<f64>) -> Vec<f64> {
        let series = DVector::from_vec(series);
        let left = &series - &self.columns * self.factor.solve(&self.columns.tr_mul(&series));
        left.as_slice().to_vec()
    }
}

/// Slope of `y` over `x`, with its standard error.
fn trend(x: &[f64], y: &[f64], runs: &[Range<usize>]) -> Option<Trend> {
    let energy: f64 = x.iter().map(|x| x * x).sum();
    let product: f64 = x.iter().zip(y).map(|(x, y)| x * y).sum();
    let change = product / energy;
    if !change.is_finite() {
        return None;
    }
    let scores: Vec<f64> = x.iter().zip(y).map(|(x, y)| x * (y - change * x)).collect();
    let found = LongRun::of_sum(&scores, runs);
    let standard_error = found.standard_error() / energy;
    let limit = quantile(1.0 - levels::DRIFT_LEVEL.get(), found.freedom).ok()? * standard_error;
    Some(Trend { change, standard_error, significant: change.abs() > limit })
}
