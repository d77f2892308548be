//! The weighted fit for a given choice of terms, and its error on held-out data.

use super::super::error::Result;
use super::super::methods::offset::mean;
use super::consistent::bounded;
use super::layout::Layout;
use super::levels;
use super::normal::{Centred, Factor, Model, Values, assemble, regularized};
use super::prior::Prior;
use nalgebra::{DMatrix, DVector};

/// Largest number of repetitions of the fit that update the variances of the joints' residuals. A few
/// repetitions are usually enough.
const ROUNDS: usize = 8;

/// Weights of the joints' equations and of the description in the fit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Weighting {
    /// Standard deviation of each joint's residual, in units of the measured effort times the input matrix B.
    pub(super) sigma: Vec<f64>,
    /// Weight λ of the distance from the description.
    pub(super) description: f64,
    /// Factor of [`Self::description`] for each inertial parameter. All parameters of a body have the same factor.
    pub(super) trust: Vec<f64>,
}

impl Weighting {
    /// Metric `Λ = λ √t R √t` over the active unknowns, with the weight λ of the description, its metric R
    /// and the factors t of [`Self::trust`]; zero for unknowns that are not inertial parameters.
    pub(super) fn metric(&self, prior: &Prior, active: &[usize]) -> DMatrix<f64> {
        let p = prior.held.len();
        let entry = |i: usize, k: usize| {
            self.description * (self.trust[i] * self.trust[k]).sqrt() * prior.metric[(i, k)]
        };
        DMatrix::from_fn(active.len(), active.len(), |i, k| {
            let (i, k) = (active[i], active[k]);
            if i < p && k < p { entry(i, k) } else { 0.0 }
        })
    }
}

/// Errors of a fit on held-out data, for each fold and for each joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct HeldOut {
    /// Sum of RSS / σ² over the joints, for each fold, with the residual sum of squares RSS and the variance
    /// σ² of a joint's residual.
    pub(super) scores: Vec<f64>,
    /// RSS (residual sum of squares) of each joint over all folds.
    pub(super) rss: Vec<f64>,
    /// Weighted squared distance of friction and offsets from the description, in units of RSS / σ² and
    /// averaged over the fits of the folds. RSS is the residual sum of squares, and σ² is the variance of the
    /// residual.
    pub(super) distance: f64,
    /// For each fold, the values that were fitted to the other folds.
    pub(super) values: Vec<Values>,
}

impl HeldOut {
    pub(super) fn total(&self) -> f64 {
        self.scores.iter().sum()
    }

    /// Held-out error of `self` minus that of `other` ([`Self::excess`]), including the distances of friction
    /// and offsets from the description, and its standard error. Because of these distances, a quantity that
    /// the data do not determine stays as described.
    pub(super) fn excess_of_choice(&self, other: &Self) -> (f64, f64) {
        let (excess, deviation) = self.excess(other);
        (excess + self.distance - other.distance, deviation)
    }

    /// Relative decrease of the error from `self` to `other`; `None` if `other` is not clearly smaller.
    ///
    /// The residual sums of squares of each joint must have the same units in `self` and `other`.
    ///
    /// - `joints`: joints whose decreases are averaged; empty for the decrease of the total error
    pub(super) fn gain(&self, other: &Self, joints: &[usize]) -> Option<f64> {
        let (excess, deviation) = other.excess(self);
        let share = match joints {
            [] => -excess / self.total(),
            _ => mean(&joints.iter().map(|j| 1.0 - other.rss[*j] / self.rss[*j]).collect::<Vec<_>>()),
        };
        let is_harmed = |(own, other): (&f64, &f64)| *other > (1.0 + levels::CLEARLY.get()) * own;
        let harms = self.rss.iter().zip(&other.rss).any(is_harmed);
        (share > levels::CLEARLY.get() && -excess > 2.0 * deviation && !harms).then_some(share)
    }

    /// Whether the error `other` is larger than this error by more than the standard error of the difference.
    pub(super) fn is_exceeded_by(&self, other: &Self) -> bool {
        let (excess, deviation) = other.excess(self);
        excess > deviation
    }

    /// Sum over the folds of the differences of the scores from `other`, and the standard error of this sum.
    pub(super) fn excess(&self, other: &Self) -> (f64, f64) {
        let differences: Vec<f64> = self.scores.iter().zip(&other.scores).map(|(a, b)| a - b).collect();
        let n = differences.len() as f64;
        let mean = differences.iter().sum::<f64>() / n;
        let squares: f64 = differences.iter().map(|d| (d - mean).powi(2)).sum();
        (n * mean, (squares * n / (n - 1.0).max(1.0)).sqrt())
    }
}

/// Fitted values of the unknowns, and the equations from which they follow.
pub(super) struct Solved {
    pub(super) values: Values,
    pub(super) active: Vec<usize>,
    /// Hessian H of the sum of squares plus the metric Λ of the description.
    pub(super) regularized: DMatrix<f64>,
    /// Metric Λ with the weights of the described bodies and of friction.
    pub(super) metric: DMatrix<f64>,
    /// The described values of the active unknowns.
    pub(super) mean: DVector<f64>,
    /// For each active unknown, the number of correlated samples that count as one independent sample.
    pub(super) time: DVector<f64>,
}

impl Solved {
    /// Number of inertial parameters among the active unknowns.
    pub(super) fn bodies(&self, layout: &Layout) -> usize {
        self.active.iter().take_while(|&&global| global < layout.parameters).count()
    }

    /// Weighted squared distance of the friction terms from their described values.
    fn distance_of_friction(&self, layout: &Layout) -> f64 {
        let bodies = self.bodies(layout);
        let distances = self.distances(&self.values);
        (bodies..self.active.len()).map(|i| self.metric[(i, i)] * distances[i].powi(2)).sum()
    }

    /// Differences of the active unknowns from their described values.
    pub(super) fn distances(&self, values: &Values) -> DVector<f64> {
        let values = self.active.iter().map(|&global| values.unknowns[global]);
        DVector::from_iterator(self.active.len(), values) - &self.mean
    }
}

/// Weights 1/σ² of the joints' equations in units of force.
pub(super) fn force_weights(weighting: &Weighting, gains: &[f64]) -> Vec<f64> {
    weighting.sigma.iter().zip(gains).map(|(sigma, gain)| (sigma * gain).powi(-2)).collect()
}

/// Minimizes `Σ ‖K z − rigid − W δ − Θ φ − o‖² / σ² + λ δᵀ R δ + T Σ (φ − φ₀)² / s²`.
///
/// - K: gains of `start`
/// - z: measured efforts
/// - rigid: described rigid-body forces
/// - W, δ: regressor, and difference from the described inertial parameters
/// - Θ, φ: columns of friction and their coefficients, with the described values φ₀ and standard deviations s
/// - o: offsets. The prior of an offset has the weight of `T σ² / s_o²` samples with zero force, with the offset's standard
///   deviation s_o.
/// - σ: standard deviation of each joint's residual
/// - λ, R: weight and metric of the description
/// - T: number of correlated samples of a joint that count as one sample
pub(super) fn fit(
    centred: &Centred,
    products: &[DMatrix<f64>],
    model: &Model,
    prior: &Prior,
    weighting: &Weighting,
    start: &Values,
) -> Result<Solved> {
    let layout = centred.layout;
    let active = model.active(layout, prior);
    let weights = force_weights(weighting, &start.gains);
    let normal = assemble(layout, products, &active, &weights, &start.gains);
    let known = prior.friction(layout, model, &active);
    let stiffness = known.precision.component_mul(&known.time);
    let metric = weighting.metric(prior, &active) + DMatrix::from_diagonal(&stiffness);
    let regularized = regularized(&normal, &metric);
    let linear = normal.linear + stiffness.component_mul(&known.mean);
    let right = DMatrix::from_column_slice(active.len(), 1, linear.as_slice());
    let mut x = Factor::new(&regularized)?.solve(&right).column(0).into_owned();
    if model.consistent {
        x = bounded(layout, prior, &active, &regularized, &linear, &x)?;
    }
    let mut values = Values { unknowns: DVector::zeros(layout.len()), gains: start.gains.clone() };
    active.iter().zip(x.iter()).for_each(|(&global, x)| values.unknowns[global] = *x);
    Ok(Solved { values, active, regularized, metric, mean: known.mean, time: known.time })
}

/// Held-out errors: for each fold, the errors of the values that were fitted to the other folds.
pub(super) fn held_out(
    centred: &Centred,
    model: &Model,
    prior: &Prior,
    weighting: &Weighting,
    start: &Values,
) -> Result<HeldOut> {
    let joints = centred.layout.joints;
    let mut found = HeldOut { scores: Vec::new(), rss: vec![0.0; joints], distance: 0.0, values: Vec::new() };
    let folds = centred.sums.folds.len();
    for fold in 0..folds {
        let solved = fit(centred, &centred.without[fold], model, prior, weighting, start)?;
        let rss = centred.held_out(fold, &solved.values);
        let weights = force_weights(weighting, &start.gains);
        found.scores.push(rss.iter().zip(&weights).map(|(rss, w)| rss * w).sum());
        let offsets = (0..joints).map(|j| weights[j] * centred.distance_of_offsets(fold, &solved.values, j));
        found.distance += (solved.distance_of_friction(centred.layout) + offsets.sum::<f64>()) / folds as f64;
        found.rss.iter_mut().zip(&rss).for_each(|(sum, rss)| *sum += rss);
        found.values.push(solved.values);
    }
    Ok(found)
}

/// Alternates between the fit and the standard deviations of the joints' residuals, which weight the fit, until both
/// converge.
pub(super) fn reweighted(
    centred: &Centred,
    model: &Model,
    prior: &Prior,
    weighting: &mut Weighting,
    start: &Values,
) -> Result<Solved> {
    let mut solved = fit(centred, &centred.all, model, prior, weighting, start)?;
    for _ in 0..ROUNDS {
        let before = weighting.sigma.clone();
        weighting.sigma = deviations(centred, &solved.values);
        solved = fit(centred, &centred.all, model, prior, weighting, &solved.values)?;
        let settled = before.iter().zip(&weighting.sigma).all(|(a, b)| (a - b).abs() <= 1e-3 * b);
        if settled {
            break;
        }
    }
    Ok(solved)
}

/// Standard deviation of each joint's residual, in units of its measured column.
pub(super) fn deviations(centred: &Centred, values: &Values) -> Vec<f64> {
    let rss = centred.residuals(&centred.all, values);
    let count = |j: usize| centred.sums.by_run(j, None).iter().map(|(n, _)| n).sum::<f64>();
    let energy = |j: usize| {
        let products = &centred.all[j];
        products[(products.nrows() - 1, products.nrows() - 1)]
    };
    // A perfect fit would give its joint an infinite weight. So the deviation is at least 1e-6 of the effort.
    let deviation = |j: usize| {
        if !centred.layout.measured[j] {
            return 1.0;
        }
        let floor = 1e-12 * energy(j) + f64::MIN_POSITIVE;
        ((rss[j] / values.gains[j].powi(2)).max(floor) / count(j).max(1.0)).sqrt()
    };
    (0..centred.layout.joints).map(deviation).collect()
}
