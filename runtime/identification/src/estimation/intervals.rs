//! Covariance of the estimate for correlated residuals, including the uncertainty of the description.
//!
//! The covariance is `A⁻¹ (S + ω² Λ) A⁻¹` with the normal matrix H, the description's metric Λ (including its weight), and
//! `A = H + Λ`. S is the covariance of the score (the gradient of the objective). It is computed from sums of the score over
//! short blocks ([`super::cosines`]), and it has as many degrees of freedom as there are cosines. `ω² Λ⁻¹` is the covariance
//! of the errors of described bodies: ω² = δᵀ Λ δ / γ, with the difference δ from the description and the effective number γ
//! of parameters that the data determine (MacKay 1992). The standard deviations of friction and offsets are given
//! ([`super::joint_prior`]).

use super::super::error::Result;
use super::super::numeric::kernel::BLOCK;
use super::super::run::PreparedRun;
use super::choice::Chosen;
use super::cosines;
use super::fit::{Solved, force_weights};
use super::layout::Layout;
use super::levels;
use super::normal::{Centred, Factor, residual_vector, selection};
use super::prior::Prior;
use super::residuals::{RunOffsets, huber, residual};
use super::result::Offsets;
use super::rows::Rows;
use nalgebra::{DMatrix, DVector};

/// Scores of the blocks (gradients of the objective), in the order of time, run after run.
pub(super) struct Scores {
    blocks: Vec<DVector<f64>>,
    samples: usize,
    /// Correlation time of the residuals [samples], the largest of all joints.
    pub(super) correlation_time: f64,
    /// Whether the blocks are independent groups of samples instead of a time series.
    are_groups: bool,
}

/// A fit of bodies, friction and drives to sums of products, with the description as prior.
pub(super) struct RigidFit<'a> {
    pub(super) chosen: &'a Chosen<'a>,
    pub(super) prior: &'a Prior,
    pub(super) solved: Solved,
    pub(super) offsets: RunOffsets,
    /// Robust standard deviation of each joint's residual. Samples whose residual exceeds a multiple of it lose weight. It is
    /// infinite if all samples have the weight one.
    pub(super) outlier: &'a [f64],
}

impl<'a> RigidFit<'a> {
    pub(super) fn new(chosen: &'a Chosen<'a>, prior: &'a Prior, outlier: &'a [f64]) -> Result<Self> {
        let solved = chosen.solved(prior)?;
        let offsets = chosen.centred.all_offsets(&solved.values);
        Ok(Self { chosen, prior, solved, offsets, outlier })
    }

    pub(super) fn layout(&self) -> &'a Layout {
        self.chosen.centred.layout
    }

    /// Weight of each joint's squared force.
    pub(super) fn weights(&self) -> Vec<f64> {
        force_weights(&self.chosen.weighting, &self.solved.values.gains)
    }

    /// Derivatives of a joint's columns, with their factors, with respect to the active unknowns.
    fn selection(&self, joint: usize) -> DMatrix<f64> {
        selection(self.layout(), joint, self.solved.values.gains[joint], &self.solved.active)
    }
}

/// Integrated autocorrelation time of a series in samples, `1 + 2 Σ ρ` with the autocorrelations ρ. The sum
/// has a window of five times the result (Sokal 1997).
pub(crate) fn correlation_time(series: &[&[f64]]) -> f64 {
    let count: usize = series.iter().map(|s| s.len()).sum();
    let mean = series.iter().flat_map(|s| s.iter()).sum::<f64>() / count.max(1) as f64;
    let lagged = |lag: usize| -> f64 {
        let of =
            |s: &&[f64]| s.iter().zip(s.iter().skip(lag)).map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>();
        series.iter().map(of).sum()
    };
    let variance = lagged(0);
    let mut time = 1.0;
    for lag in 1..(count / 4).max(1) {
        if variance <= 0.0 || lag as f64 > 5.0 * time {
            break;
        }
        time += 2.0 * lagged(lag) / variance;
        time = time.max(1.0);
    }
    time
}

/// Computes the scores of the blocks (gradients of the objective) in one pass along the runs.
pub(super) fn scores(rows: &mut Rows, runs: &[PreparedRun], of: &RigidFit, time: f64) -> Scores {
    let layout = of.layout();
    let total: usize = runs.iter().map(|r| r.times.len()).sum();
    let length = total
        .div_ceil(levels::MOST_BLOCKS.get())
        .clamp(1, BLOCK)
        .max(((0.5 * time) as usize).clamp(1, BLOCK));
    let weights = of.weights();
    let selections: Vec<_> = (0..layout.joints).map(|joint| of.selection(joint)).collect();
    let factors: Vec<_> = (0..layout.joints).map(|j| residual_vector(layout, &of.solved.values, j)).collect();
    let means: Vec<_> = (0..layout.joints).map(|j| column_means(&of.chosen.centred, j, runs.len())).collect();
    let mut found = Scores { blocks: Vec::new(), samples: total, correlation_time: time, are_groups: false };
    for (run, samples) in runs.iter().enumerate() {
        for start in (0..samples.times.len()).step_by(length) {
            rows.evaluate((run, samples), start..samples.times.len().min(start + length));
            let mut score = DVector::zeros(of.solved.active.len());
            for joint in 0..layout.joints {
                let products = products(
                    &rows.joint(joint),
                    rows.moving(joint),
                    &factors[joint],
                    of.offsets[joint][run],
                    of.outlier[joint],
                    &means[joint][run],
                );
                score += selections[joint].tr_mul(&(products * weights[joint]));
            }
            found.blocks.push(score);
        }
    }
    found
}

/// `Σ w r (x − x̄)` over a block, for each column x of a joint with the mean x̄, the residual r and the weights w.
fn products(
    columns: &[&[f64]],
    moving: &[f64],
    factors: &DVector<f64>,
    offset: f64,
    outlier: f64,
    means: &DVector<f64>,
) -> DVector<f64> {
    let mut r = residual(factors, offset, columns);
    let weights = huber(&r, outlier);
    r.iter_mut().zip(weights).zip(moving).for_each(|((r, w), moves)| *r *= w * moves);
    let total: f64 = r.iter().sum();
    let dot = |column: &&[f64]| -> f64 { column.iter().zip(&r).map(|(x, r)| x * r).sum() };
    DVector::from_iterator(columns.len(), columns.iter().map(dot)) - means * total
}

/// Means of a joint's columns over samples that share an offset, for each run.
pub(super) fn column_means(centred: &Centred, joint: usize, runs: usize) -> Vec<DVector<f64>> {
    let means: Vec<DVector<f64>> = centred.means(joint).into_iter().map(|(_, mean)| mean).collect();
    match centred.layout.offsets(joint, centred.offsets) {
        Offsets::None => vec![DVector::zeros(centred.layout.width(joint)); runs],
        Offsets::Common => means.iter().cycle().take(runs).cloned().collect(),
        Offsets::ByRun => means,
    }
}

/// Covariance of the score (the gradient of the objective) that is due to errors of described bodies,
/// friction and offsets.
///
/// - `spread`: ω², the variance factor of the errors of described bodies
fn described(of: &RigidFit, spread: f64) -> DMatrix<f64> {
    let (solved, zeros) = (&of.solved, &of.chosen.centred.zeros);
    let (n, bodies) = (solved.active.len(), solved.bodies(of.layout()));
    let factor = |i: usize| if i < bodies { spread } else { solved.time[i] };
    let mut sum = DMatrix::from_fn(n, n, |i, k| factor(i) * solved.metric[(i, k)]);
    let weights = of.weights();
    for (joint, known) in of.prior.joints.iter().enumerate().filter(|(joint, _)| zeros[*joint] > 0.0) {
        for (_, mean) in of.chosen.centred.means(joint) {
            let score = of.selection(joint).tr_mul(&mean);
            sum.ger(zeros[joint] * weights[joint] * known.time, &score, &score, 1.0);
        }
    }
    sum
}

/// Standard error of each offset of a joint, from the error of the mean residual and the errors of the unknowns.
pub(super) fn offset_errors(of: &RigidFit, covariance: &Covariance, joint: usize) -> Vec<f64> {
    let weight = of.weights()[joint];
    let time = of.prior.joints.get(joint).map_or(1.0, |prior| prior.time);
    let error = |(samples, mean): (f64, DVector<f64>)| {
        let change = of.selection(joint).tr_mul(&mean);
        (time / (weight * samples) + (&covariance.matrix * &change).dot(&change)).sqrt()
    };
    of.chosen.centred.means(joint).into_iter().map(error).collect()
}

impl Scores {
    /// The scores (gradients of the objective) of the folds if there are no samples but only sums. Each fold
    /// is a group of distant blocks and independent of the other folds (random groups; Wolter 2007, chapter
    /// 2). One degree of freedom is lost because the sum of the scores is nearly zero.
    pub(super) fn of_folds(of: &RigidFit, time: f64) -> Self {
        let layout = of.layout();
        let folds = &of.chosen.centred.sums.folds;
        let weights = of.weights();
        let share = (folds.len() as f64 / (folds.len() as f64 - 1.0).max(1.0)).sqrt();
        let score = |fold: &Vec<DMatrix<f64>>| {
            let mut score = DVector::zeros(of.solved.active.len());
            for joint in 0..layout.joints {
                let products = &fold[joint] * residual_vector(layout, &of.solved.values, joint);
                score += of.selection(joint).tr_mul(&(products * (share * weights[joint])));
            }
            score
        };
        Self {
            blocks: folds.iter().map(score).collect(),
            samples: of.chosen.centred.sums.samples,
            correlation_time: time,
            are_groups: true,
        }
    }

    /// Degrees of freedom of the score's variance.
    fn freedom(&self) -> usize {
        if self.are_groups {
            return self.blocks.len().saturating_sub(1).max(1);
        }
        let wanted = cosines::count(self.samples as f64 / self.correlation_time, self.blocks.len());
        wanted.max(levels::FEWEST_COSINES.get().min(self.blocks.len()))
    }

    /// Columns whose mean square is the variance of the total score.
    fn projected(&self) -> DMatrix<f64> {
        if self.are_groups {
            return DMatrix::from_columns(&self.blocks) * (self.freedom() as f64).sqrt();
        }
        cosines::projections(&DMatrix::from_columns(&self.blocks), self.freedom())
    }
}

/// Covariance of the active unknowns, with the degrees of freedom.
pub(super) struct Covariance {
    pub(super) matrix: DMatrix<f64>,
    /// Effective number of inertial parameters that the data determine: the trace of `(H + Λ)⁻¹ H` over these
    /// parameters, with the Hessian H and the metric Λ of the description.
    pub(super) decided: f64,
    /// Degrees of freedom of the covariance, for Student's t distribution.
    pub(super) freedom: usize,
}

impl Covariance {
    /// Covariance of two unknowns; zero if at least one of the two is not estimated.
    pub(super) fn of(&self, solved: &Solved, one: usize, other: usize) -> f64 {
        let place = |global: usize| solved.active.iter().position(|&active| active == global);
        place(one).zip(place(other)).map_or(0.0, |at| self.matrix[at])
    }
}

/// Derivatives of the right side of the normal equations with respect to the logarithm of each joint's gain.
fn slopes_of_gains(of: &RigidFit) -> DMatrix<f64> {
    let (gains, weights) = (&of.solved.values.gains, of.weights());
    let of_joint = |joint: usize| {
        let products = &of.chosen.centred.all[joint];
        let effort = products.column(products.ncols() - 1) * (weights[joint] * gains[joint]);
        of.selection(joint).tr_mul(&effort)
    };
    DMatrix::from_columns(&(0..gains.len()).map(of_joint).collect::<Vec<_>>())
}

/// Covariance of the active unknowns.
pub(super) fn covariance(of: &RigidFit, scores: &Scores) -> Result<Covariance> {
    let solved = &of.solved;
    let (n, bodies) = (solved.active.len(), solved.bodies(of.layout()));
    let factor = Factor::new(&solved.regularized)?;
    let inverse = factor.solve(&DMatrix::identity(n, n));
    let of_bodies = |matrix: &DMatrix<f64>| matrix.view((0, 0), (bodies, bodies)).into_owned();
    let metric = of_bodies(&solved.metric);
    let decided = bodies as f64 - of_bodies(&inverse).component_mul(&metric).sum();
    let change = solved.distances(&solved.values).rows(0, bodies).into_owned();
    let spread = (&metric * &change).dot(&change) / decided.max(1.0);
    let equations = of.chosen.centred.sums.samples * of.layout().joints;
    let unknowns = decided + (n - bodies) as f64;
    let spent = unknowns * scores.correlation_time / equations.max(1) as f64;
    // Both parts are products with their transposes, so rounding cannot make a variance negative.
    let projected = factor.solve(&scores.projected()) / (1.0 - spent).max(0.25).sqrt();
    let described = factor.solve(&(described(of, spread) * &inverse));
    let slopes = factor.solve(&slopes_of_gains(of));
    let of_gains = &slopes * &of.chosen.log_gains * slopes.transpose();
    let matrix = &projected * projected.transpose() / scores.freedom() as f64 + described + of_gains;
    Ok(Covariance { matrix, decided, freedom: scores.freedom() })
}
