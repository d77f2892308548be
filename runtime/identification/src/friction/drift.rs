//! Friction and offsets that change over the log, for example while a gear warms up.

use super::super::error::Result;
use super::super::estimation::with_ridge;
use super::super::methods::confidence::{LongRun, quantile};
use super::super::methods::offset::{centre, mean};
use super::super::result::FrictionLaw;
use super::design::runs;
use super::levels;
use super::task::FrictionData;
use gelenk_findings::digits::with_error;
use gelenk_findings::{Finding, Rule};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use std::ops::Range;

/// Sees: an offset that changes from the beginning to the end of the logs.
/// Matters: a constant cannot describe the offset of the sensor.
/// Example: a torque sensor that warms up.
/// Fixture: `warming_up` in `codegen/tests/findings/arm.rs`.
const OFFSET_DRIFTS: Rule = Rule::warning("offset-drifts");

/// Sees: friction that changes from the beginning to the end of the logs.
/// Matters: the law is an average, which is wrong at the beginning and at the end.
/// Example: grease that warms up.
/// Fixture: `drift_is_shown_where_it_is_there` in `friction/tests.rs`.
const FRICTION_DRIFTS: Rule = Rule::warning("friction-drifts");

/// Smallest change of friction that gives a finding, as a share of the friction.
const NAMED_CHANGE: f64 = 0.02;

/// Linear change of a quantity from the first to the last sample, over the index of the sample.
struct Trend {
    /// Last minus first value of the linear trend.
    change: f64,
    /// Standard error of the change, which takes the correlation of the residuals into account.
    standard_error: f64,
    /// Whether the change is significant at the 1 % level.
    significant: bool,
}

impl Trend {
    /// Whether the change is significant and larger than `least`.
    fn exceeds(&self, least: f64) -> bool {
        self.significant && self.change.abs() > least
    }
}

/// Findings about a drift of the friction or of the constant torque over a log; empty if the law is zero or there are too few
/// samples.
///
/// - `scale`: rms of the friction torque
pub(super) fn drift(
    data: &FrictionData,
    law: &FrictionLaw,
    residuals: &[f64],
    scale: f64,
) -> Result<Vec<Finding>> {
    let Some([offset, friction]) = trends(data, &data.torques_of(law)?, data.gradients_of(law)?, residuals)
    else {
        return Ok(Vec::new());
    };
    let of_friction = friction.exceeds(NAMED_CHANGE).then(|| {
        let change = with_error(100.0 * friction.change, Some(100.0 * friction.standard_error));
        let message = format!(
            "friction changes by {change} % over the log, so the law is an average. Friction may fall while the joint warms \
             up, or the model lacks a term"
        );
        FRICTION_DRIFTS.found(message).help("record after the joint has warmed up, or identify each run separately")
    });
    let of_offset = offset.exceeds(NAMED_CHANGE * scale).then(|| {
        let change = with_error(offset.change, Some(offset.standard_error));
        let unit = data.unit;
        OFFSET_DRIFTS.found(format!(
            "the offset of the efforts changes by {change} {unit} over the log, but the fit assumes a constant offset"
        ))
    });
    Ok(of_friction.into_iter().chain(of_offset).collect())
}

/// Changes over a log: of the constant torque [N·m or N], and of the friction as a share of the friction. For example, −0.1
/// means that friction falls by a tenth.
///
/// - `gradients`: derivatives of the law with respect to its coefficients. They are needed because the fit of the coefficients
///   has already explained a part of the trend.
fn trends(
    data: &FrictionData,
    law: &[f64],
    gradients: DMatrix<f64>,
    residuals: &[f64],
) -> Option<[Trend; 2]> {
    let m = law.len();
    let level = mean(residuals);
    let from_mean: Vec<f64> = residuals.iter().map(|x| x - level).collect();
    let time: Vec<f64> = (0..m).map(|i| (i as f64 + 0.5) / m as f64 - 0.5).collect();
    let mut moving: Vec<f64> = time.iter().zip(law).map(|(t, l)| t * l).collect();
    centre(&mut moving, &runs(data));
    let projection = Projection::new(gradients, &runs(data))?;
    let (time, moving) = (projection.residual(time), projection.residual(moving));
    let whole = 0..m;
    Some([trend(&time, &from_mean, &[whole])?, trend(&moving, residuals, &runs(data))?])
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
        Some(Self { factor: with_ridge(columns.tr_mul(&columns)).cholesky()?, columns })
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
