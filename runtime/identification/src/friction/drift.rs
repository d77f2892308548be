//! Friction and offsets that change over the log, as they do while a gear warms up.

use super::super::confidence::{LongRun, quantile};
use super::super::digits::with_error;
use super::design::{centre, mean, runs};
use super::task::FrictionData;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use std::ops::Range;

/// Parts into which a single run is divided.
const PARTS: usize = 10;
/// Probability of a chance result below which a trend is named.
const NAMED_LEVEL: f64 = 0.01;
/// Change, as a share of the friction, that is named.
const NAMED_CHANGE: f64 = 0.02;

/// A change from the first to the last sample, linear in the number of the sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trend {
    /// Last minus first value.
    pub change: f64,
    /// Standard error, for correlated residuals.
    pub standard_error: f64,
    /// Whether chance gives such a change in less than one of a hundred logs without a trend.
    pub significant: bool,
}

/// What is left of the torque over the log.
#[derive(Debug, Clone, PartialEq)]
pub struct Drift {
    /// Runs, or parts of equal length of a single one, with the mean of torque minus law.
    pub means: Vec<(Range<usize>, f64)>,
    /// Change of the constant torque [N·m or N].
    pub offset: Trend,
    /// Change of the friction as a share of it: −0.1 where it falls by a tenth.
    pub friction: Trend,
}

impl Drift {
    /// `None` where the law is zero or the samples are too few.
    ///
    /// - `gradients`: the law's derivatives by its coefficients, which have taken their part of a trend
    pub(super) fn new(
        data: &FrictionData,
        law: &[f64],
        gradients: DMatrix<f64>,
        residuals: &[f64],
    ) -> Option<Self> {
        let m = law.len();
        if m < 2 * PARTS {
            return None;
        }
        let left: Vec<f64> = data.torques.iter().zip(law).map(|(t, l)| t - l).collect();
        let level = mean(&left, data.weights);
        let from_mean: Vec<f64> = left.iter().map(|x| x - level).collect();
        let time: Vec<f64> = (0..m).map(|i| (i as f64 + 0.5) / m as f64 - 0.5).collect();
        let mut moving: Vec<f64> = time.iter().zip(law).map(|(t, l)| t * l).collect();
        centre(&mut moving, &runs(data), data.weights);
        let taken = Taken::new(gradients, &runs(data), data.weights)?;
        let (time, moving) = (taken.off(time), taken.off(moving));
        let whole = 0..m;
        Some(Self {
            means: parts(data).into_iter().map(|rows| (rows.clone(), mean(&left[rows], None))).collect(),
            offset: trend(&time, &from_mean, &[whole])?,
            friction: trend(&moving, residuals, &runs(data))?,
        })
    }

    /// Sentences on trends that matter.
    ///
    /// - `scale`: rms of the friction torque
    pub(super) fn warnings(&self, unit: &str, scale: f64) -> Vec<String> {
        let mut sentences = Vec::new();
        let friction = self.friction;
        if friction.significant && friction.change.abs() > NAMED_CHANGE {
            let change = with_error(100.0 * friction.change, Some(100.0 * friction.standard_error));
            sentences.push(format!(
                "friction changes by {change} % from the beginning to the end of the log, as while warming up (or the \
                 motions differ in what the model lacks): the law is that of the middle; record after warming up, or \
                 identify the runs apart"
            ));
        }
        if self.offset.significant && self.offset.change.abs() > NAMED_CHANGE * scale {
            let change = with_error(self.offset.change, Some(self.offset.standard_error));
            sentences.push(format!("the constant torque drifts by {change} {unit} over the log"));
        }
        sentences
    }
}

fn parts(data: &FrictionData) -> Vec<Range<usize>> {
    let runs = runs(data);
    if runs.len() > 1 {
        return runs;
    }
    super::super::moments::contiguous_blocks(data.velocities.len(), PARTS).collect()
}

/// What least squares on the law's columns takes of a series.
struct Taken {
    columns: DMatrix<f64>,
    factor: Cholesky<f64, Dyn>,
}

impl Taken {
    fn new(mut columns: DMatrix<f64>, runs: &[Range<usize>], weights: Option<&[f64]>) -> Option<Self> {
        let m = columns.nrows();
        for column in columns.as_mut_slice().chunks_exact_mut(m) {
            centre(column, runs, weights);
        }
        let mut gram = columns.tr_mul(&columns);
        for i in 0..gram.nrows() {
            gram[(i, i)] = gram[(i, i)] * (1.0 + 1e-9) + f64::MIN_POSITIVE;
        }
        Some(Self { factor: gram.cholesky()?, columns })
    }

    fn off(&self, series: Vec<f64>) -> Vec<f64> {
        let series = DVector::from_vec(series);
        let left = &series - &self.columns * self.factor.solve(&self.columns.tr_mul(&series));
        left.as_slice().to_vec()
    }
}

/// Slope of `y` over `x`.
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
    let limit = quantile(1.0 - NAMED_LEVEL, found.freedom).ok()? * standard_error;
    Some(Trend { change, standard_error, significant: change.abs() > limit })
}
