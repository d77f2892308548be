//! The estimate from sums of products, if the samples are not available.
//!
//! The samples of all logs are divided into groups, called shares. Each share is a fold of the held-out error and a block of
//! the covariance. The mean of each column over a run is subtracted before the products are formed. This has the effect of a
//! separate offset for each run, and the sums of any logs can be added. The rows of joints with a quaternion have no offset,
//! so the means of their columns are not subtracted.

use super::super::error::{Result, require_finite};
use super::super::methods::library::{slope, smooth_sign};
use super::super::numeric::kernel::{BLOCK, add_products};
use super::super::preparation::Filter;
use super::super::robot::Robot;
use super::super::run::{Effort, PreparedRun};
use super::checks::no_effort;
use super::choice::{Freedom, choose};
use super::estimated::{Estimated, require_explained, unexplained};
use super::fit::HeldOut;
use super::intervals::{RigidFit, Scores, covariance};
use super::layout::{ASYMMETRY, COULOMB, Layout, TERMS, VISCOUS};
use super::levels;
use super::normal::{force_vector, residual_vector};
use super::prior::Prior;
use super::result::{Estimate, Gravity, JointEstimate, Offsets};
use super::rows::Rows;
use super::settings::EstimationSettings;
use super::sums::{PieceSums, Sums};
use super::trial::Case;
use super::unit::{CommonRatio, Sizes, common_ratio, unit_doubt};
use gelenk_findings::Finding;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Factors k of the terms tanh(k v) [s/rad or s/m]. The friction library has the same factors, which do not depend on a log.
const STEEPNESS: [f64; 4] = [100.0, 20.0, 10.0, 5.0];
/// Number of additional columns after the columns of the estimate. Most joints have the columns sign v and |tanh 20 v|, which
/// only the friction law needs. A joint with a quaternion has a column of ones instead. The products of the column of ones
/// are the sums of the other columns.
const EXTRA: [usize; 2] = [2, 1];

/// Columns of each joint's equation: inertial parameters, candidate terms, described force, measured force, and the columns
/// of [`EXTRA`].
#[derive(Debug, Clone)]
pub(crate) struct Columns {
    layout: Layout,
}

/// Sums of products over one share (a group of samples of all logs), or over one piece of a log.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct ShareSums<T> {
    pub(crate) samples: u64,
    /// Sums of each joint; empty for a share without samples.
    pub(crate) joints: Vec<JointSums<T>>,
}

/// Sums of products of one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct JointSums<T> {
    /// Σ w, with the weights w of the samples.
    pub(crate) weight: T,
    /// Sums of squares that the reduced weights w of outliers remove: Σ (1 − w) r² and Σ (1 − w)(z − z̄)², in squared units of
    /// the effort, with the residual r and the measured effort z.
    pub(crate) lost: [T; 2],
    /// Lower triangle, row by row, of Σ w (x − x̄)(x − x̄)ᵀ of the columns x with their means x̄; of Σ w x xᵀ for a joint with
    /// a quaternion.
    pub(crate) products: Vec<T>,
}

impl<T: Copy> ShareSums<T> {
    /// The same sums as numbers of another kind.
    pub(crate) fn converted<U>(&self, of: impl Fn(T) -> Result<U>) -> Result<ShareSums<U>> {
        let joint = |joint: &JointSums<T>| {
            let [residual, total] = joint.lost.map(&of);
            let products = joint.products.iter().map(|product| of(*product)).collect::<Result<_>>()?;
            Ok(JointSums { weight: of(joint.weight)?, lost: [residual?, total?], products })
        };
        Ok(ShareSums { samples: self.samples, joints: self.joints.iter().map(joint).collect::<Result<_>>()? })
    }
}

impl JointSums<f64> {
    /// The products as a symmetric matrix.
    ///
    /// - `width`: number of columns
    pub(crate) fn matrix(&self, width: usize) -> DMatrix<f64> {
        let place = |i: usize, j: usize| i * (i + 1) / 2 + j;
        DMatrix::from_fn(width, width, |i, j| self.products[place(i.max(j), i.min(j))])
    }
}

/// A contiguous part of a run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RunPiece {
    pub(crate) run: usize,
    pub(crate) rows: Range<usize>,
}

/// Weights and residuals of samples, `[run][joint][sample]`. The residuals are in units of the effort times the input
/// matrix B.
pub(crate) struct Weighted<'a> {
    pub(crate) weights: &'a [Vec<Vec<f64>>],
    pub(crate) residuals: &'a [Vec<Vec<f64>>],
}

impl Columns {
    /// The columns for a robot, chosen before the samples are read.
    ///
    /// - `spans`: for each joint, the largest range of positions in a log
    /// - `measured`: for each joint, whether a log has its effort
    ///
    /// # Errors
    /// [`IdentificationError::File`](super::super::error::IdentificationError::File) if inputs act at frames and efforts are
    /// not forces at the joints. The same error is returned if motor constants are unknown and an input drives several joints.
    pub(crate) fn new(robot: &dyn Robot, effort: Effort, spans: &[f64], measured: Vec<bool>) -> Result<Self> {
        let joints = spans.iter().zip(robot.speed_scales()).zip(&measured);
        let moves = joints
            .map(|((span, scale), measured)| *measured && *span > levels::STANDSTILL.get() * scale)
            .collect();
        let scales = robot.speed_scales().into_iter();
        let steepness = scales.map(|scale| STEEPNESS.map(|factor| slope(factor, scale))).collect();
        let layout = Layout::without_data(robot, effort, steepness, moves, false)?;
        Ok(Self { layout: Layout { measured, ..layout }.without_resting_currents() })
    }

    /// Number of columns of each joint's equation.
    pub(crate) fn widths(&self) -> Vec<usize> {
        let extra = |joint: usize| EXTRA[usize::from(self.layout.exact[joint])];
        (0..self.layout.joints).map(|joint| self.layout.width(joint) + extra(joint)).collect()
    }

    /// Candidate terms of the friction law, with the index of each term's column.
    pub(crate) fn library(&self, joint: usize) -> Vec<(String, usize)> {
        let (first, width) = (self.layout.local[joint].len() - TERMS, self.layout.width(joint));
        let coulomb = |place: usize| first + COULOMB.start + place;
        let tanh = |place: usize| smooth_sign(self.layout.steepness[joint][place]);
        vec![
            ("v".to_owned(), first + VISCOUS),
            ("sign(v)".to_owned(), width),
            (tanh(3), coulomb(3)),
            (tanh(2), coulomb(2)),
            (tanh(1), coulomb(1)),
            (tanh(0), coulomb(0)),
            ("abs(v)".to_owned(), first + ASYMMETRY),
            (format!("abs({})", tanh(1)), width + 1),
        ]
    }

    /// Sums of products over each piece of the runs. The mean of each column over its run is subtracted,
    /// except for joints with a quaternion.
    ///
    /// - `filter`: filter of the efforts, which the columns of friction also pass
    /// - `of`: weights and residuals of the samples
    pub(crate) fn sums(
        &self,
        robot: &dyn Robot,
        runs: &[PreparedRun],
        gravity: Gravity,
        filter: Option<&Filter>,
        of: &Weighted,
        pieces: &[RunPiece],
    ) -> Vec<ShareSums<f64>> {
        let mut rows = Rows::new(robot, &self.layout, gravity, filter, None);
        let means: Vec<Vec<Vec<f64>>> =
            runs.iter().zip(of.weights).map(|(run, weights)| self.means(&mut rows, run, weights)).collect();
        let sums = |piece: &RunPiece| {
            let (weights, residuals) = (&of.weights[piece.run], &of.residuals[piece.run]);
            let run = &runs[piece.run];
            self.of_piece(&mut rows, run, piece.rows.clone(), &means[piece.run], [weights, residuals])
        };
        pieces.iter().map(sums).collect()
    }

    /// Weighted means of the columns of each joint over a run.
    fn means(&self, rows: &mut Rows, run: &PreparedRun, weights: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut sums: Vec<Vec<f64>> = self.widths().into_iter().map(|width| vec![0.0; width]).collect();
        for start in (0..run.times.len()).step_by(BLOCK) {
            let block = start..run.times.len().min(start + BLOCK);
            rows.evaluate((0, run), block.clone());
            for (joint, sums) in sums.iter_mut().enumerate() {
                let weights = &weights[joint][block.clone()];
                for (sum, column) in sums.iter_mut().zip(self.columns(rows, joint)) {
                    *sum += column.iter().zip(weights).map(|(x, w)| x * w).sum::<f64>();
                }
            }
        }
        for (sums, weights) in sums.iter_mut().zip(weights) {
            let total = weights.iter().sum::<f64>().max(f64::MIN_POSITIVE);
            sums.iter_mut().for_each(|sum| *sum /= total);
        }
        sums
    }

    fn of_piece(
        &self,
        rows: &mut Rows,
        run: &PreparedRun,
        piece: Range<usize>,
        means: &[Vec<f64>],
        [weights, residuals]: [&Vec<Vec<f64>>; 2],
    ) -> ShareSums<f64> {
        let widths = self.widths();
        let mut products: Vec<Vec<f64>> = widths.iter().map(|width| vec![0.0; width * width]).collect();
        let mut lost = vec![[0.0; 2]; widths.len()];
        for start in piece.clone().step_by(BLOCK) {
            let block = start..piece.end.min(start + BLOCK);
            rows.evaluate((0, run), block.clone());
            for (joint, products) in products.iter_mut().enumerate() {
                let weights = &weights[joint][block.clone()];
                let mut columns = self.columns(rows, joint);
                let force = self.layout.width(joint) - 1;
                let mut measured = columns[force].clone();
                subtract(&mut measured, means[joint][force]);
                add_lost(&mut lost[joint], weights, [&residuals[joint][block.clone()], &measured]);
                if !self.layout.exact[joint] {
                    columns.iter_mut().zip(&means[joint]).for_each(|(column, mean)| subtract(column, *mean));
                }
                columns.iter_mut().for_each(|column| scale(column, weights));
                add_products(&columns.iter().map(Vec::as_slice).collect::<Vec<_>>(), products);
            }
        }
        let joint = |(joint, products): (usize, &Vec<f64>)| JointSums {
            weight: weights[joint][piece.clone()].iter().sum(),
            lost: lost[joint],
            products: (0..widths[joint])
                .flat_map(|row| &products[row * widths[joint]..][..=row])
                .copied()
                .collect(),
        };
        ShareSums {
            samples: run.count_moving(piece.clone()) as u64,
            joints: products.iter().enumerate().map(joint).collect(),
        }
    }

    /// Columns of a joint at the last evaluated samples.
    fn columns(&self, rows: &Rows, joint: usize) -> Vec<Vec<f64>> {
        let mut columns: Vec<Vec<f64>> = rows.joint(joint).into_iter().map(<[f64]>::to_vec).collect();
        if self.layout.exact[joint] {
            columns.push(vec![1.0; columns[0].len()]);
            return columns;
        }
        let first = self.layout.local[joint].len() - TERMS;
        let sign = |v: &f64| if *v == 0.0 { 0.0 } else { v.signum() };
        let signs = columns[first + VISCOUS].iter().map(sign).collect();
        let asymmetric = columns[first + COULOMB.start + 1].iter().map(|t| t.abs()).collect();
        columns.extend([signs, asymmetric]);
        columns
    }
}

fn subtract(column: &mut [f64], mean: f64) {
    column.iter_mut().for_each(|x| *x -= mean);
}

fn scale(column: &mut [f64], weights: &[f64]) {
    column.iter_mut().zip(weights).for_each(|(x, w)| *x *= w.sqrt());
}

/// Adds the squares that the reduced weights of outliers remove. A sample with the weight zero is at rest and does not count.
/// The weight of an outlier is positive.
fn add_lost(lost: &mut [f64; 2], weights: &[f64], squared: [&[f64]; 2]) {
    for (sum, values) in lost.iter_mut().zip(squared) {
        let counted = values.iter().zip(weights).filter(|(_, w)| **w > 0.0);
        *sum += counted.map(|(x, w)| (1.0 - w) * x * x).sum::<f64>();
    }
}

/// Inputs of [`estimate_shares`].
pub(crate) struct SharedData<'a> {
    pub(crate) robot: &'a dyn Robot,
    pub(crate) settings: &'a EstimationSettings,
    /// Part of the robot's weight that the logged efforts contain. The value comes from the file of the sums,
    /// not from the settings.
    pub(crate) gravity: Gravity,
    pub(crate) columns: &'a Columns,
    /// Sums of each share (group of samples) that has samples.
    pub(crate) shares: &'a [ShareSums<f64>],
    /// Correlation time of the residuals [samples].
    pub(crate) correlation_time: f64,
}

/// The estimate, and the friction torque of each joint as factors of the joint's columns (regressor, terms,
/// measured force).
pub(crate) struct SharedEstimate {
    pub(crate) estimate: Estimate,
    pub(crate) friction: Vec<DVector<f64>>,
}

/// Estimates inertial parameters, friction and gains as [`super::estimate`] does, with an offset for each run. Efforts,
/// predictions and offsets in the result are empty, because they need samples.
///
/// # Errors
/// The errors are those of [`super::estimate`].
pub(crate) fn estimate_shares(data: &SharedData) -> Result<SharedEstimate> {
    let SharedData { robot, settings, columns, shares, .. } = *data;
    settings.check()?;
    require_finite("the description's inertial parameters", &robot.parameters())?;
    let layout = &columns.layout;
    let prior = Prior::new(&robot.parameters(), robot.bodies(), Vec::new());
    let sums = sums_of(columns, shares);
    let freedom = Freedom {
        offsets: Some(Offsets::None),
        terms: settings.optional_terms,
        loads: &[],
        consistent: settings.consistent,
    };
    let chosen = choose(layout, &sums, &prior, freedom)?;
    let fit = RigidFit::new(&chosen, &prior, &[])?;
    let held_out = chosen.held_out(&prior)?;
    let mut found = Found {
        data,
        doubts: Vec::new(),
        fitted: Estimated {
            robot,
            settings,
            gravity: data.gravity,
            covariance: covariance(&fit, &Scores::of_folds(&fit, data.correlation_time))?,
            fit: &fit,
            margin: DVector::zeros(layout.len()),
            delays: &[],
        },
        held_out,
    };
    let ratio = found.common_ratio();
    let case = Case::new(robot, &prior, &chosen, &found.held_out, ratio.as_ref(), None)?;
    found.doubts = case.signs()?;
    found.require_explained()?;
    let accept_poor = found.fitted.settings.accept_poor;
    let unit = ratio.as_ref().map(|ratio| ratio.judged(accept_poor, || case.unit())).transpose()?.flatten();
    let mut estimate = found.estimate();
    estimate.findings.splice(0..0, unit);
    Ok(SharedEstimate { estimate, friction: (0..layout.joints).map(|j| found.friction(j)).collect() })
}

/// Converts sums of the shares to the form that the fit needs. The columns of measured forces have the mean
/// zero.
fn sums_of(columns: &Columns, shares: &[ShareSums<f64>]) -> Sums {
    let (layout, widths) = (&columns.layout, columns.widths());
    let matrix = |joint: usize, share: &ShareSums<f64>| share.joints[joint].matrix(widths[joint]);
    let of_estimate = |share: &ShareSums<f64>| -> Vec<DMatrix<f64>> {
        let part = |joint: usize| matrix(joint, share).resize(layout.width(joint), layout.width(joint), 0.0);
        (0..layout.joints).map(part).collect()
    };
    let sums = |joint: usize, share: &ShareSums<f64>| match layout.exact[joint] {
        true => matrix(joint, share).column(layout.width(joint)).rows(0, layout.width(joint)).into_owned(),
        false => DVector::zeros(layout.width(joint)),
    };
    let piece = |(fold, share): (usize, &ShareSums<f64>)| PieceSums {
        run: 0,
        fold,
        weight: share.joints.iter().map(|joint| joint.weight).collect(),
        columns: (0..layout.joints).map(|joint| sums(joint, share)).collect(),
    };
    Sums {
        folds: shares.iter().map(of_estimate).collect(),
        pieces: shares.iter().enumerate().map(piece).collect(),
        samples: shares.iter().map(|share| share.samples as usize).sum(),
        away: None,
    }
}

/// Inputs of the reported estimate.
struct Found<'a> {
    data: &'a SharedData<'a>,
    fitted: Estimated<'a>,
    held_out: HeldOut,
    doubts: Vec<Finding>,
}

impl Found<'_> {
    /// Refuses a fit that explains too little, or a fit that would be better with the other sign of an effort.
    fn require_explained(&self) -> Result<()> {
        let Estimated { robot, settings, fit, .. } = self.fitted;
        let layout = fit.layout();
        let held_out: Vec<f64> =
            (0..layout.joints).map(|joint| self.r_squared(joint, self.held_out.rss[joint])).collect();
        let reasons = |joint: usize| vec![unexplained(robot, joint)];
        require_explained(robot, layout, settings, &held_out, &self.doubts, reasons)
    }

    /// Ratio of estimated to described forces of the robot as a whole; `None` if no joint determines the ratio.
    fn common_ratio(&self) -> Option<CommonRatio> {
        let (robot, layout) = (self.fitted.robot, self.fitted.layout());
        let sizes: Vec<Sizes> = (0..layout.joints).map(|joint| self.sizes(joint)).collect();
        common_ratio(robot, layout.effort, &layout.known_efforts(), &sizes)
    }

    /// Root sums of squares of the estimated rigid force, the described rigid force and the measured force, each without its
    /// mean.
    fn sizes(&self, joint: usize) -> Sizes {
        let products = self.products(joint);
        let width = products.nrows();
        let force = force_vector(self.fitted.layout(), &self.fitted.fit.solved.values, joint);
        let [described, measured] = [(width - 2, 1.0), (width - 1, self.gain(joint))]
            .map(|(place, factor)| DVector::from_fn(width, |i, _| if i == place { factor } else { 0.0 }));
        [&force, &described, &measured].map(|of| (products * of).dot(of).max(0.0).sqrt())
    }

    fn gain(&self, joint: usize) -> f64 {
        self.fitted.fit.solved.values.gains[joint]
    }

    fn products(&self, joint: usize) -> &DMatrix<f64> {
        &self.fitted.fit.chosen.centred.all[joint]
    }

    /// Sums of squares that the reduced weights w of outliers remove, in units of force: Σ (1 − w) r² and Σ
    /// (1 − w)(z − z̄)², with the residual r and the measured effort z.
    fn lost(&self, joint: usize) -> [f64; 2] {
        let sum =
            |which: usize| self.data.shares.iter().map(|share| share.joints[joint].lost[which]).sum::<f64>();
        [0, 1].map(|which| self.gain(joint).powi(2) * sum(which))
    }

    /// `R² = 1 − RSS / Σ (τ − τ̄)²` of the force τ, with the mean τ̄ over each run if runs have offsets. Outliers have their
    /// full weight here. NaN if no force acts.
    fn r_squared(&self, joint: usize, rss: f64) -> f64 {
        let variation = self.fitted.fit.chosen.centred.variation(joint);
        let [residual, total] = self.lost(joint);
        1.0 - (rss + residual) / (self.gain(joint).powi(2) * variation + total)
    }

    fn estimate(&self) -> Estimate {
        let Estimated { robot, fit: RigidFit { chosen, solved, .. }, .. } = self.fitted;
        let driven = robot.unmeasured();
        let doubts = (0..driven.len()).flat_map(|joint| {
            let is_missing = !self.fitted.layout().measured[joint] && !driven[joint];
            is_missing.then(|| no_effort(robot, joint)).into_iter().chain(self.doubts_of(joint))
        });
        let findings = self.fitted.offsets_found(Offsets::ByRun).chain(self.fitted.choices()).chain(doubts);
        let rss = chosen.centred.residuals(&chosen.centred.all, &solved.values);
        let samples = chosen.centred.sums.samples.max(1) as f64;
        let fit = |joint: usize| JointEstimate {
            sigma: ((rss[joint] + self.lost(joint)[0]) / samples).sqrt(),
            r_squared: self.r_squared(joint, rss[joint]),
            held_out_r_squared: self.r_squared(joint, self.held_out.rss[joint]),
            held_out_with_rest: f64::NAN,
            ..JointEstimate::default()
        };
        let fits = (0..rss.len()).map(fit).collect();
        Estimate { offsets: Offsets::ByRun, ..self.fitted.estimate(fits, findings.collect()) }
    }

    /// Doubts about a moving joint: its unit and its sign. In the rows of a joint with a quaternion there is no sensor, so
    /// only the unit is doubted.
    fn doubts_of(&self, joint: usize) -> Vec<Finding> {
        let (robot, layout) = (self.fitted.robot, self.fitted.layout());
        if !layout.moves[joint] && !layout.exact[joint] {
            return Vec::new();
        }
        let is_own = |doubt: &&Finding| doubt.about.subject == robot.subject(joint);
        let sign = self.doubts.iter().filter(is_own).cloned().map(Finding::accepted);
        let found = sign.chain(unit_doubt(self.sizes(joint)));
        found.map(|finding| finding.of(robot.subject(joint))).collect()
    }

    /// Friction torque of a joint as factors of its columns: the measured force minus the forces of the rigid
    /// body and of an added inertia.
    fn friction(&self, joint: usize) -> DVector<f64> {
        let layout = self.fitted.layout();
        let mut factors = residual_vector(layout, &self.fitted.fit.solved.values, joint);
        let first = layout.first_term(joint);
        (VISCOUS..=ASYMMETRY).for_each(|term| factors[first + term] = 0.0);
        let width = factors.len();
        factors.resize_vertically(width + EXTRA[usize::from(layout.exact[joint])], 0.0)
    }
}
