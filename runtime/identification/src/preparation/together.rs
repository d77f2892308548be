//! Fit of one set of parameters to all efforts.

use super::super::run::PreparedRun;
use super::levels;
use super::regression::{Columns, Equations, Sample, ridged};
use nalgebra::{DMatrix, DVector};

/// Smallest share of the variation of an effort that counts as unexplained.
const LEAST_SHARE: f64 = 1e-12;

/// Efforts at the chosen samples, filtered and unfiltered.
pub(super) struct Efforts {
    /// Efforts that passed the filter of the positions.
    pub filtered: Vec<DVector<f64>>,
    /// Measured efforts, which passed no filter.
    pub measured: Vec<DVector<f64>>,
}

/// Returns ln(1 − R²) of each measured effort that varies. One set of parameters is fitted to all filtered efforts. The
/// weight of each effort is the inverse of its residual sum of squares in the fit before.
pub(super) fn together(
    columns: &Columns,
    runs: &[&PreparedRun],
    samples: &[Sample],
    efforts: &Efforts,
) -> Vec<f64> {
    let targets = efforts.filtered.iter().zip(&efforts.measured);
    let all = Equations::of_efforts(columns, runs, samples).into_iter().zip(targets);
    let mut all: Vec<EffortFit> = all.filter_map(|(of, (f, m))| EffortFit::new(of, f, m)).collect();
    for _ in 0..levels::FITS.get() {
        let Some(parameters) = fitted(&all) else { return Vec::new() };
        all.iter_mut().for_each(|effort| effort.judge(&parameters));
    }
    all.iter().map(|effort| effort.score).collect()
}

/// Part of the common fit that belongs to one effort.
struct EffortFit<'a> {
    equations: Equations,
    filtered: &'a DVector<f64>,
    measured: &'a DVector<f64>,
    gram: DMatrix<f64>,
    products: DVector<f64>,
    variation: f64,
    weight: f64,
    /// ln(1 − R²) of the measured effort, with R² of the common fit.
    score: f64,
}

impl<'a> EffortFit<'a> {
    /// Returns `None` if the effort is not finite or does not vary.
    fn new(equations: Equations, filtered: &'a DVector<f64>, measured: &'a DVector<f64>) -> Option<Self> {
        let variation = variation(&equations.moving, measured);
        let is_known = filtered.sum().is_finite() && variation.is_finite() && variation > 0.0;
        is_known.then(|| Self {
            gram: &equations.rows * equations.rows.transpose(),
            products: &equations.rows * filtered,
            equations,
            filtered,
            measured,
            variation,
            weight: 1.0 / variation,
            score: 0.0,
        })
    }

    fn judge(&mut self, parameters: &DVector<f64>) {
        let explained = self.equations.rows.tr_mul(parameters);
        let share = |target: &DVector<f64>| {
            let left = (target - &explained).component_mul(&self.equations.moving).norm_squared();
            (left / self.variation).max(LEAST_SHARE)
        };
        (self.weight, self.score) =
            (1.0 / (share(self.filtered) * self.variation), share(self.measured).ln());
    }
}

/// Fits the parameters to the filtered efforts by weighted least squares; `None` if the normal equations have no Cholesky
/// factor.
fn fitted(efforts: &[EffortFit]) -> Option<DVector<f64>> {
    let size = efforts.first()?.products.len();
    let (mut gram, mut products) = (DMatrix::zeros(size, size), DVector::zeros(size));
    for effort in efforts {
        gram += &effort.gram * effort.weight;
        products += &effort.products * effort.weight;
    }
    let unit = |square: f64| if square > 0.0 { 1.0 / square.sqrt() } else { 0.0 };
    let units = gram.diagonal().map(unit);
    let scaled = DMatrix::from_fn(size, size, |a, b| gram[(a, b)] * units[a] * units[b]);
    Some(ridged(scaled).cholesky()?.solve(&products.component_mul(&units)).component_mul(&units))
}

/// Returns the sum of squares of a target minus its mean, over the samples in motion.
fn variation(moving: &DVector<f64>, target: &DVector<f64>) -> f64 {
    let mean = target.dot(moving) / moving.sum();
    target.add_scalar(-mean).component_mul(moving).norm_squared()
}
