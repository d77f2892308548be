//! The estimate by instrumental variables, and the Durbin–Wu–Hausman test of least squares against it.
//!
//! X: columns at the measured motion, Z: the same columns at the instruments' motion, both with offsets taken out, r:
//! residuals of least squares, Ω: weights, Λ: the description's metric. From least squares x with `A = XᵀΩX + Λ`,
//!
//! `x_IV = x + (ZᵀΩX + Λ)⁻¹ (ZᵀΩr − Λδ)`.
//!
//! The test looks at the moments that least squares does not make zero, `g = ZᵀΩr − (ZᵀΩX) A⁻¹ XᵀΩr`. Their
//! expectation is zero unless noise stands in X and r (Durbin 1954, Wu 1973, Hausman 1978; the form with moments is
//! robust: Wooldridge 1995). Their variance holds under correlated residuals, and the statistic is compared with
//! Fisher's F ([`super::cosines`]). Only the directions in which X and Z differ most count, so that there are several
//! cosines for each.

use super::super::error::Result;
use super::super::numeric::kernel::BLOCK;
use super::super::numeric::spectrum::symmetric_eigen;
use super::cosines::{FEWEST, count, projections};
use super::delays::rates;
use super::fit::force_weights;
use super::instruments::{InstrumentSource, Instruments};
use super::intervals::{Fitted, MOST_BLOCKS, column_means, described};
use super::layout::Layout;
use super::normal::{Factor, Values, residual_vector, selection};
use super::residuals::{forces, huber, residual};
use super::result::Offsets;
use super::task::Task;
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// Level of the test of least squares against instrumental variables.
const LEVEL: f64 = 0.05;
/// Level below which intervals reach as far as instrumental variables. Where they do so by a test at 5 %, the biases that it
/// does not see make them too narrow (Guggenberger 2010, *Econometric Theory* 26(2), on pretests of this kind).
const REACH: f64 = 0.3;
/// Cosines for each tested direction.
const COSINES_FOR_EACH: usize = 3;
/// Share of the largest difference between X and Z below which a direction is not tested.
const NEGLIGIBLE: f64 = 1e-6;

/// The estimate by instrumental variables, over all unknowns, and the test.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Endogeneity {
    pub(super) source: InstrumentSource,
    pub(super) values: Values,
    /// Covariance over the active unknowns.
    pub(super) covariance: DMatrix<f64>,
    /// Degrees of freedom of the covariance.
    pub(super) freedom: usize,
    pub(super) test: Test,
}

impl Endogeneity {
    /// Whether least squares differs from instrumental variables by more than chance.
    pub(super) fn rejects(&self) -> bool {
        self.test.p_value < LEVEL
    }

    /// Whether they differ by so much that intervals count it.
    pub(super) fn is_counted(&self) -> bool {
        self.test.p_value < REACH
    }

    /// Standard error of an unknown; zero where it is not estimated.
    ///
    /// - `active`: the unknowns that are estimated
    pub(super) fn deviation(&self, active: &[usize], global: usize) -> f64 {
        self.covariance(active, global, global).max(0.0).sqrt()
    }

    /// Covariance of two unknowns; zero where one of them is not estimated.
    pub(super) fn covariance(&self, active: &[usize], one: usize, other: usize) -> f64 {
        let place = |global: usize| active.iter().position(|&active| active == global);
        place(one).zip(place(other)).map_or(0.0, |at| self.covariance[at])
    }
}

/// A statistic with its distribution where least squares is not biased.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Test {
    pub(super) statistic: f64,
    pub(super) freedoms: [f64; 2],
    pub(super) p_value: f64,
}

/// Sums of a block of a run, for one joint: weighted residuals, and their products with the columns.
struct Block {
    run: usize,
    joint: usize,
    total: f64,
    x: DVector<f64>,
    z: DVector<f64>,
    /// Sum of weighted residuals where there are instruments.
    known: f64,
}

/// Sums over a run and joint where there are instruments.
#[derive(Clone)]
struct Products {
    weight: f64,
    x: DVector<f64>,
    z: DVector<f64>,
    zx: DMatrix<f64>,
    zz: DMatrix<f64>,
}

/// Compares least squares with instrumental variables; `None` where there are no instruments, or too few
/// independent residuals for a test.
///
/// # Errors
/// None in fact: those of linear algebra that overflows.
pub(super) fn endogeneity(
    task: &Task,
    of: &Fitted,
    spread: f64,
    correlation_time: f64,
) -> Result<Option<Endogeneity>> {
    let layout = task.layout;
    let Some(instruments) = Instruments::find(task.runs, &layout.moves, correlation_time) else {
        return Ok(None);
    };
    let pass = Pass::new(task, of, &instruments, correlation_time);
    let samples: usize = task.runs.iter().map(|run| run.times.len()).sum();
    let cosines = count(samples as f64 / correlation_time, pass.blocks.len() / layout.joints.max(1));
    if cosines < FEWEST {
        return Ok(None);
    }
    let equations = pass.equations(layout, of);
    let description = &described(of, task.prior, spread);
    let Some(found) = equations.compare(of, description, cosines, instruments.source) else {
        return Ok(None);
    };
    if !found.rejects() {
        return Ok(Some(found));
    }
    // Residuals of a biased fit hold the bias times the motion, which is no error of the instruments' estimate.
    let offsets = (0..layout.joints).map(|j| of.centred.offsets(&found.values, j)).collect();
    let own = Fitted { values: &found.values, offsets: &offsets, ..*of };
    let moments = Pass::new(task, &own, &instruments, correlation_time).equations(layout, &own).z;
    let covariance = equations.covariance(of, description, &moments, cosines);
    Ok(covariance.map(|covariance| Endogeneity { covariance, ..found }))
}

/// One pass along the runs.
struct Pass {
    blocks: Vec<Block>,
    /// By run, then joint.
    products: Vec<Vec<Products>>,
}

impl Pass {
    fn new(task: &Task, of: &Fitted, instruments: &Instruments, time: f64) -> Self {
        let layout = task.layout;
        // A delay's column along the instruments' motion: noise of the measured one stands in the other.
        let rates = task.first_fit.map(|_| {
            let forces = forces(&mut task.rows(), layout, &instruments.runs, of.values, of.offsets);
            rates(layout, &instruments.runs, of.values, &forces)
        });
        let (mut measured, mut other) = (task.rows(), task.rows().with_rates(rates.as_deref()));
        let total: usize = task.runs.iter().map(|run| run.times.len()).sum();
        let length = total.div_ceil(MOST_BLOCKS).max((0.5 * time) as usize).clamp(1, BLOCK);
        let factors: Vec<_> = (0..layout.joints).map(|j| residual_vector(layout, of.values, j)).collect();
        let empty = |j: usize| Products::empty(layout.width(j));
        let mut pass = Self {
            blocks: Vec::new(),
            products: vec![(0..layout.joints).map(empty).collect(); task.runs.len()],
        };
        for (run, samples) in task.runs.iter().enumerate() {
            for start in (0..samples.times.len()).step_by(length) {
                let rows = start..samples.times.len().min(start + length);
                measured.evaluate((run, samples), rows.clone());
                other.evaluate((run, &instruments.runs[run]), rows.clone());
                let known = &instruments.known[run][rows];
                for joint in 0..layout.joints {
                    let (x, z) = (measured.joint(joint), other.joint(joint));
                    let r = residual(&factors[joint], of.offsets[joint][run], &x);
                    let weights = huber(&r, of.outlier[joint]);
                    let weights =
                        weights.iter().zip(measured.moving(joint)).map(|(w, moves)| w * moves).collect();
                    pass.add(run, joint, &Columns { x, z, r, weights, known });
                }
            }
        }
        pass
    }

    fn add(&mut self, run: usize, joint: usize, of: &Columns) {
        let weighted: Vec<f64> = of.r.iter().zip(&of.weights).map(|(r, w)| r * w).collect();
        let masked: Vec<f64> =
            weighted.iter().zip(of.known).map(|(r, known)| if *known { *r } else { 0.0 }).collect();
        self.blocks.push(Block {
            run,
            joint,
            total: weighted.iter().sum(),
            x: dots(&of.x, &weighted),
            z: dots(&of.z, &masked),
            known: masked.iter().sum(),
        });
        let weights: Vec<f64> =
            of.weights.iter().zip(of.known).map(|(w, known)| if *known { *w } else { 0.0 }).collect();
        self.products[run][joint].add(of, &weights);
    }

    /// Means of the instruments of a joint over what shares an offset, for each run.
    fn means(&self, of: &Fitted, joint: usize) -> Vec<DVector<f64>> {
        let q = self.products[0][joint].z.len();
        let mean = |products: &[&Products]| {
            let weight: f64 = products.iter().map(|p| p.weight).sum();
            let sum = products.iter().fold(DVector::zeros(q), |sum, p| sum + &p.z);
            if weight > 0.0 { sum / (weight + of.centred.zeros[joint]) } else { DVector::zeros(q) }
        };
        let of_joint: Vec<&Products> = self.products.iter().map(|joints| &joints[joint]).collect();
        match of.centred.layout.offsets(joint, of.centred.offsets) {
            Offsets::None => vec![DVector::zeros(q); of_joint.len()],
            Offsets::Common => vec![mean(&of_joint); of_joint.len()],
            Offsets::ByRun => of_joint.iter().map(|p| mean(&[*p])).collect(),
        }
    }

    /// Products and moments over the active unknowns.
    fn equations(&self, layout: &Layout, of: &Fitted) -> Equations {
        let n = of.solved.active.len();
        let weights = force_weights(of.weighting, &of.values.gains);
        let runs = self.products.len();
        let all = (0..layout.joints).map(|j| column_means(of.centred, j, runs)).collect::<Vec<_>>();
        let blocks = self.blocks.len() / layout.joints.max(1);
        let mut sums = Equations {
            zx: DMatrix::zeros(n, n),
            zz: DMatrix::zeros(n, n),
            x: DMatrix::zeros(n, blocks),
            z: DMatrix::zeros(n, blocks),
        };
        for joint in 0..layout.joints {
            let selection = selection((layout, joint, of.values.gains[joint]), &of.solved.active);
            let means = self.means(of, joint);
            for (products, mean) in self.products.iter().map(|p| &p[joint]).zip(&means) {
                let [zx, zz] = products.centred(mean);
                sums.zx += selection.tr_mul(&zx) * &selection * weights[joint];
                sums.zz += selection.tr_mul(&zz) * &selection * weights[joint];
            }
            let of_joint = self.blocks.iter().filter(|block| block.joint == joint).enumerate();
            for (place, block) in of_joint {
                let x = &block.x - &all[joint][block.run] * block.total;
                let z = &block.z - &means[block.run] * block.known;
                sums.x.column_mut(place).gemv_tr(weights[joint], &selection, &x, 1.0);
                sums.z.column_mut(place).gemv_tr(weights[joint], &selection, &z, 1.0);
            }
        }
        sums
    }
}

/// Columns of a joint over a block.
struct Columns<'a> {
    x: Vec<&'a [f64]>,
    z: Vec<&'a [f64]>,
    r: Vec<f64>,
    weights: Vec<f64>,
    known: &'a [bool],
}

fn dots(columns: &[&[f64]], factors: &[f64]) -> DVector<f64> {
    let dot = |column: &&[f64]| -> f64 { column.iter().zip(factors).map(|(x, f)| x * f).sum() };
    DVector::from_iterator(columns.len(), columns.iter().map(dot))
}

impl Products {
    fn empty(q: usize) -> Self {
        let (vector, matrix) = (DVector::zeros(q), DMatrix::zeros(q, q));
        Self { weight: 0.0, x: vector.clone(), z: vector, zx: matrix.clone(), zz: matrix }
    }

    fn add(&mut self, of: &Columns, weights: &[f64]) {
        let matrix = |columns: &[&[f64]]| {
            DMatrix::from_fn(weights.len(), columns.len(), |i, k| columns[k][i] * weights[i].sqrt())
        };
        let (x, z) = (matrix(&of.x), matrix(&of.z));
        self.weight += weights.iter().sum::<f64>();
        self.x += dots(&of.x, weights);
        self.z += dots(&of.z, weights);
        self.zx += z.tr_mul(&x);
        self.zz += z.tr_mul(&z);
    }

    /// `Σ w (z − z̄) xᵀ` and `Σ w (z − z̄) zᵀ`.
    fn centred(&self, mean: &DVector<f64>) -> [DMatrix<f64>; 2] {
        let centre = |products: &DMatrix<f64>, sum: &DVector<f64>| products - mean * sum.transpose();
        [centre(&self.zx, &self.x), centre(&self.zz, &self.z)]
    }
}

/// `ZᵀΩX`, `ZᵀΩZ`, and the moments `XᵀΩr` and `ZᵀΩr` of the blocks, as columns.
struct Equations {
    zx: DMatrix<f64>,
    zz: DMatrix<f64>,
    x: DMatrix<f64>,
    z: DMatrix<f64>,
}

impl Equations {
    fn compare(
        &self,
        of: &Fitted,
        description: &DMatrix<f64>,
        cosines: usize,
        source: InstrumentSource,
    ) -> Option<Endogeneity> {
        let solved = of.solved;
        let factor = Factor::new(&solved.regularized).ok()?;
        // (ZᵀΩX) A⁻¹
        let projection = factor.solve(&self.zx.transpose()).transpose();
        let moments = &self.z - &projection * &self.x;
        let left = &self.zz - &projection * self.zx.transpose();
        let test = test(&factor, &left, moments, cosines)?;
        let right = self.z.column_sum() - &solved.metric * solved.distances(of.values);
        let right = DMatrix::from_column_slice(right.len(), 1, right.as_slice());
        let step = self.inverse(&factor, &solved.metric)(right)?;
        let mut values = of.values.clone();
        solved.active.iter().zip(step.iter()).for_each(|(&global, step)| values.unknowns[global] += step);
        let covariance = self.covariance(of, description, &self.z, cosines)?;
        Some(Endogeneity { source, values, covariance, freedom: cosines, test })
    }

    /// Covariance of the estimate by instrumental variables.
    ///
    /// - `description`: covariance of the score that its errors make
    /// - `moments`: `ZᵀΩr` of the blocks
    fn covariance(
        &self,
        of: &Fitted,
        description: &DMatrix<f64>,
        moments: &DMatrix<f64>,
        cosines: usize,
    ) -> Option<DMatrix<f64>> {
        let factor = Factor::new(&of.solved.regularized).ok()?;
        let inverted = self.inverse(&factor, &of.solved.metric);
        let deviations = inverted(projections(moments, cosines))?;
        let of_description = inverted(description.clone())?;
        let described = inverted(of_description.transpose())?.transpose();
        Some(&deviations * deviations.transpose() / cosines as f64 + described)
    }

    /// `(ZᵀΩX + Λ)⁻¹` times columns.
    fn inverse<'f>(
        &self,
        factor: &'f Factor,
        metric: &DMatrix<f64>,
    ) -> impl Fn(DMatrix<f64>) -> Option<DMatrix<f64>> + use<'f> {
        let system = factor.both_sides(&self.zx + metric).lu();
        move |columns| Some(factor.scaled(system.solve(&factor.scaled(columns))?))
    }
}

/// The test in the directions in which regressor and instruments differ most, relative to what the data tell.
fn test(factor: &Factor, difference: &DMatrix<f64>, moments: DMatrix<f64>, cosines: usize) -> Option<Test> {
    let white = factor.whitened(factor.whitened(difference.clone()).transpose());
    let eigen = symmetric_eigen(0.5 * (&white + white.transpose()));
    let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let largest = *order.first().map(|i| &eigen.eigenvalues[*i])?;
    let tested: Vec<usize> = order
        .into_iter()
        .take((cosines / COSINES_FOR_EACH).max(1))
        .filter(|i| eigen.eigenvalues[*i] > NEGLIGIBLE * largest)
        .collect();
    let q = tested.len();
    let series = eigen.eigenvectors.select_columns(&tested).tr_mul(&factor.whitened(moments));
    let sum = series.column_sum();
    let projected = projections(&series, cosines);
    let variance = &projected * projected.transpose() / cosines as f64;
    let wald = sum.dot(&variance.cholesky()?.solve(&sum));
    let freedoms = [q as f64, (cosines + 1 - q) as f64];
    let statistic = wald * freedoms[1] / (freedoms[0] * cosines as f64);
    let fisher = FisherSnedecor::new(freedoms[0], freedoms[1]).ok()?;
    statistic.is_finite().then(|| Test { statistic, freedoms, p_value: 1.0 - fisher.cdf(statistic) })
}
