//! All efforts explained by one set of parameters, as one robot has them: the judge of bandwidths.
//!
//! A fit of its own to each effort has as many parameters as there are columns, and explains vibrations of the gears by
//! masses that no other effort agrees with. Such fits like wide filters.

use super::super::run::PreparedRun;
use super::regression::{Columns, RIDGE, Sample};
use nalgebra::{DMatrix, DVector};

/// Fits whose residuals weigh the efforts of the next one.
const PASSES: usize = 2;

/// Least share of an effort's variation that counts as unexplained.
const LEAST: f64 = 1e-12;

/// An effort at the chosen samples.
pub(super) struct Target {
    /// Through the filter of the columns.
    pub filtered: DVector<f64>,
    /// As it was measured.
    pub measured: DVector<f64>,
}

/// Columns of one effort `[columns × samples]`, zero where a joint rests that it acts on, and 0 there, 1 elsewhere.
struct Rows {
    columns: DMatrix<f64>,
    moving: DVector<f64>,
    target: Target,
}

/// Logarithms of the share of each effort's variation, as measured, that the common fit to the filtered efforts leaves.
/// Efforts without values at all samples, or without variation, have none.
pub(super) fn unexplained(
    columns: &Columns,
    runs: &[&PreparedRun],
    samples: &[Sample],
    targets: Vec<Target>,
) -> Vec<f64> {
    let blocks: Vec<DMatrix<f64>> = samples.iter().map(|sample| columns.at(runs, *sample)).collect();
    let Some(first) = blocks.first() else { return Vec::new() };
    let finite = |x: &DVector<f64>| x.iter().all(|x| x.is_finite());
    let known = |(_, t): &(usize, Target)| finite(&t.filtered) && finite(&t.measured);
    let rows = targets.into_iter().enumerate().filter(known).map(|(m, target)| {
        let moves = |(r, i): &Sample| f64::from(u8::from(!columns.rests(runs[*r], m, *i)));
        let moving = DVector::from_iterator(samples.len(), samples.iter().map(moves));
        let columns = DMatrix::from_fn(first.ncols(), blocks.len(), |k, i| blocks[i][(m, k)] * moving[i]);
        Rows { columns, moving, target }
    });
    let rows: Vec<Rows> = rows.filter(|rows| rows.variation() > 0.0).collect();
    let Some(factors) = factors(&rows) else { return Vec::new() };
    rows.iter()
        .map(|rows| (rows.left(&rows.target.measured, &factors) / rows.variation()).max(LEAST).ln())
        .collect()
}

impl Rows {
    /// Sum of the squares of the measured effort without its mean.
    fn variation(&self) -> f64 {
        let mean = self.target.measured.dot(&self.moving) / self.moving.sum();
        self.energy(&self.target.measured.add_scalar(-mean))
    }

    fn energy(&self, left: &DVector<f64>) -> f64 {
        left.component_mul(&self.moving).norm_squared()
    }

    fn left(&self, effort: &DVector<f64>, factors: &DVector<f64>) -> f64 {
        self.energy(&(effort - self.columns.tr_mul(factors)))
    }
}

/// Least squares on all filtered efforts, each weighed by its own residuals; `None` where nothing can be solved.
fn factors(rows: &[Rows]) -> Option<DVector<f64>> {
    // The product with a transposed copy is a blocked one, several times faster than dot products.
    let products: Vec<(DMatrix<f64>, DVector<f64>)> = rows
        .iter()
        .map(|rows| (&rows.columns * rows.columns.transpose(), &rows.columns * &rows.target.filtered))
        .collect();
    let mut weights: Vec<f64> = rows.iter().map(|rows| 1.0 / rows.variation()).collect();
    let mut found = solution(&products, &weights)?;
    for _ in 1..PASSES {
        let left =
            rows.iter().map(|rows| rows.left(&rows.target.filtered, &found).max(LEAST * rows.variation()));
        weights = left.map(|left| 1.0 / left).collect();
        found = solution(&products, &weights)?;
    }
    Some(found)
}

/// The weighted normal equations, columns of unit length, with a ridge: parameters that the motion does not show stay at
/// zero.
fn solution(products: &[(DMatrix<f64>, DVector<f64>)], weights: &[f64]) -> Option<DVector<f64>> {
    let count = products.first()?.1.len();
    let (mut gram, mut right) = (DMatrix::zeros(count, count), DVector::zeros(count));
    for ((products, targets), weight) in products.iter().zip(weights) {
        gram += products * *weight;
        right += targets * *weight;
    }
    let largest = gram.diagonal().max();
    let length = |square: f64| if square > 1e-18 * largest { square.sqrt() } else { f64::INFINITY };
    let lengths = gram.diagonal().map(length);
    let unit = DMatrix::from_fn(count, count, |i, k| {
        gram[(i, k)] / (lengths[i] * lengths[k]) + if i == k { RIDGE } else { 0.0 }
    });
    Some(unit.cholesky()?.solve(&right.component_div(&lengths)).component_div(&lengths))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two efforts with one unknown in common: each weighs by its own residuals, and a column of zeros stays out.
    #[test]
    fn efforts_share_their_parameters() {
        let wave = |phase: f64, i: usize| (0.1 * i as f64 + phase).sin();
        let effort = |noise: f64, phase: f64| {
            let columns = DMatrix::from_fn(3, 400, |k, i| [wave(phase, i), 1.0, 0.0][k]);
            let target =
                DVector::from_fn(400, |i, _| 2.0 * wave(phase, i) + 0.5 + noise * wave(7.3 * i as f64, i));
            let moving = DVector::from_element(400, 1.0);
            Rows { columns, moving, target: Target { filtered: target.clone(), measured: target } }
        };
        let exact = factors(&[effort(0.0, 0.0), effort(0.0, 1.0)]).unwrap();
        assert!((exact[0] - 2.0).abs() < 1e-6 && (exact[1] - 0.5).abs() < 1e-6 && exact[2] == 0.0, "{exact}");
        let noisy = factors(&[effort(0.0, 0.0), effort(3.0, 1.0)]).unwrap();
        assert!((noisy[0] - 2.0).abs() < 1e-3, "{noisy}");
    }
}
