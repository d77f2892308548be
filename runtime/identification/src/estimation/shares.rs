//! The same estimate from sums of products by share, where the samples are gone.
//!
//! The columns' means over each run are taken off before they are multiplied: so each run has an offset of its own,
//! and sums of any logs add up. A share is a fold of the held-out error and a block of the covariance.

use super::super::error::{IdentificationError, Result, require_finite};
use super::super::kernel::{BLOCK, add_products};
use super::super::preparation::Filter;
use super::super::robot::Robot;
use super::super::run::{Effort, PreparedRun};
use super::super::shafts::slope;
use super::alternatives::signs;
use super::checks::{acceleration_doubt_of, first_gains, unit_doubt};
use super::choice::{Chosen, Freedom, choose};
use super::fit::{HeldOut, Solved, fit};
use super::intervals::{Covariance, Fitted, Scores, covariance};
use super::layout::{ARMATURE, ASYMMETRY, COULOMB, Layout, TERMS, VISCOUS};
use super::normal::{Values, force_vector, residual_vector};
use super::prior::Prior;
use super::report::chosen_in_words;
use super::result::{Estimate, EstimatedTerm, JointEstimate, Offsets, Uncertain};
use super::rows::Rows;
use super::settings::EstimationSettings;
use super::sums::{PieceSums, Sums};
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Factors k of the terms tanh(k v): those of the friction library, so that no log decides them for others.
const STEEPNESS: [f64; 4] = [100.0, 20.0, 10.0, 5.0];
/// Columns behind those of the estimate: sign v and |tanh 20 v|, which only the friction law asks for.
const EXTRA: usize = 2;

/// Columns of each joint's equation: inertial parameters, candidate terms, described force, measured force, and
/// the two terms that only the friction law asks for.
#[derive(Debug, Clone)]
pub(crate) struct Columns {
    layout: Layout,
}

/// Sums over one share, or over one piece of a log.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ShareSums {
    pub(crate) samples: usize,
    /// Σ w of each joint.
    pub(crate) weights: Vec<f64>,
    /// Σ w (x − x̄)(x − x̄)ᵀ of each joint.
    pub(crate) products: Vec<DMatrix<f64>>,
    /// What outliers lost with their weight: Σ (1 − w) r² and Σ (1 − w)(z − z̄)² of each joint.
    pub(crate) lost: Vec<[f64; 2]>,
}

/// A contiguous part of a run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RunPiece {
    pub(crate) run: usize,
    pub(crate) rows: Range<usize>,
}

/// Weights and residuals of samples, `[run][joint][sample]`, the residuals in units of the effort times B.
pub(crate) struct Weighted<'a> {
    pub(crate) weights: &'a [Vec<Vec<f64>>],
    pub(crate) residuals: &'a [Vec<Vec<f64>>],
}

impl Columns {
    /// - `moves`: whether each joint moves in any log
    ///
    /// # Errors
    /// Currents of a robot whose joints have no inputs of their own.
    pub(crate) fn new(robot: &dyn Robot, effort: Effort, moves: Vec<bool>) -> Result<Self> {
        let scales = robot.speed_scales().into_iter();
        let steepness = scales.map(|scale| STEEPNESS.map(|factor| slope(factor, scale))).collect();
        Ok(Self { layout: Layout::without_data(robot, effort, steepness, moves)? })
    }

    /// Number of columns of each joint.
    pub(crate) fn widths(&self) -> Vec<usize> {
        (0..self.layout.joints).map(|joint| self.layout.width(joint) + EXTRA).collect()
    }

    /// Terms of the friction law, with the place of their columns.
    pub(crate) fn library(&self, joint: usize) -> Vec<(String, usize)> {
        let (first, width) = (self.layout.local[joint].len() - TERMS, self.layout.width(joint));
        let coulomb = |place: usize| first + COULOMB.start + place;
        let tanh = |place: usize| format!("tanh({}*v)", self.layout.steepness[joint][place]);
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

    /// Sums over each piece, the means of its run's columns taken off.
    ///
    /// - `filter`: what the efforts passed; friction passes it too
    pub(crate) fn sums(
        &self,
        robot: &dyn Robot,
        runs: &[PreparedRun],
        (gravity_compensated, filter): (bool, Option<&Filter>),
        of: &Weighted,
        pieces: &[RunPiece],
    ) -> Vec<ShareSums> {
        let mut rows = Rows::new(robot, &self.layout, gravity_compensated, filter, None);
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
            rows.evaluate(run, block.clone());
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
    ) -> ShareSums {
        let widths = self.widths();
        let mut products: Vec<Vec<f64>> = widths.iter().map(|width| vec![0.0; width * width]).collect();
        let mut lost = vec![[0.0; 2]; widths.len()];
        for start in piece.clone().step_by(BLOCK) {
            let block = start..piece.end.min(start + BLOCK);
            rows.evaluate(run, block.clone());
            for (joint, products) in products.iter_mut().enumerate() {
                let weights = &weights[joint][block.clone()];
                let mut columns = self.columns(rows, joint);
                centre(&mut columns, &means[joint]);
                let measured = &columns[self.layout.width(joint) - 1];
                add_lost(&mut lost[joint], weights, [&residuals[joint][block.clone()], measured]);
                columns.iter_mut().for_each(|column| scale(column, weights));
                add_products(&columns.iter().map(Vec::as_slice).collect::<Vec<_>>(), products);
            }
        }
        let square =
            |(sums, q): (&Vec<f64>, &usize)| DMatrix::from_fn(*q, *q, |i, j| sums[i.max(j) * q + i.min(j)]);
        ShareSums {
            samples: piece.len(),
            weights: weights.iter().map(|weights| weights[piece.clone()].iter().sum()).collect(),
            products: products.iter().zip(&widths).map(square).collect(),
            lost,
        }
    }

    /// Columns of a joint at the samples evaluated last.
    fn columns(&self, rows: &Rows, joint: usize) -> Vec<Vec<f64>> {
        let mut columns: Vec<Vec<f64>> = rows.joint(joint).into_iter().map(<[f64]>::to_vec).collect();
        let first = self.layout.local[joint].len() - TERMS;
        let sign = |v: &f64| if *v == 0.0 { 0.0 } else { v.signum() };
        let signs = columns[first + VISCOUS].iter().map(sign).collect();
        let asymmetric = columns[first + COULOMB.start + 1].iter().map(|t| t.abs()).collect();
        columns.extend([signs, asymmetric]);
        columns
    }
}

fn centre(columns: &mut [Vec<f64>], means: &[f64]) {
    for (column, mean) in columns.iter_mut().zip(means) {
        column.iter_mut().for_each(|x| *x -= mean);
    }
}

fn scale(column: &mut [f64], weights: &[f64]) {
    column.iter_mut().zip(weights).for_each(|(x, w)| *x *= w.sqrt());
}

fn add_lost(lost: &mut [f64; 2], weights: &[f64], squared: [&[f64]; 2]) {
    for (sum, values) in lost.iter_mut().zip(squared) {
        *sum += values.iter().zip(weights).map(|(x, w)| (1.0 - w) * x * x).sum::<f64>();
    }
}

/// What the estimate is made from.
pub(crate) struct SharedData<'a> {
    pub(crate) robot: &'a dyn Robot,
    pub(crate) settings: &'a EstimationSettings,
    pub(crate) columns: &'a Columns,
    /// Shares with samples.
    pub(crate) shares: &'a [ShareSums],
    /// Samples after which residuals forget.
    pub(crate) correlation_time: f64,
}

/// The estimate, and the factors of each joint's columns in its friction torque.
pub(crate) struct SharedEstimate {
    pub(crate) estimate: Estimate,
    pub(crate) friction: Vec<DVector<f64>>,
}

/// Inertial parameters, friction and gains as [`super::estimate`] has them, each run with its own offsets. What
/// needs samples is empty: efforts, predictions and offsets.
///
/// # Errors
/// As [`super::estimate`], and fewer than four shares with samples.
pub(crate) fn estimate_shares(data: &SharedData) -> Result<SharedEstimate> {
    let SharedData { robot, settings, columns, shares, .. } = *data;
    settings.check()?;
    require_finite("the description's inertial parameters", &robot.parameters())?;
    let layout = &columns.layout;
    let prior = Prior::new(&robot.parameters(), robot.bodies());
    let sums = sums_of(layout, shares);
    let gains = layout.effort == Effort::Current;
    let start = Values {
        unknowns: DVector::zeros(layout.len()),
        gains: if gains { first_gains(layout, &sums) } else { vec![1.0; layout.joints] },
    };
    let freedom = Freedom {
        offsets: Some(Offsets::None),
        terms: settings.optional_terms,
        loads: &[],
        consistent: settings.consistent,
    };
    let chosen = choose(layout, &sums, &prior, &start, freedom, gains)?;
    let Chosen { centred, model, weighting, values, .. } = &chosen;
    let solved = fit(centred, &centred.all, model, &prior, weighting, values)?;
    let fitted = Fitted {
        centred,
        solved: &solved,
        weighting,
        values: &solved.values,
        offsets: &Vec::new(),
        outlier: &[],
    };
    let scores = Scores::of_folds(&fitted, data.correlation_time);
    let held_out = chosen.held_out(&prior)?;
    let found = Found {
        data,
        prior: &prior,
        chosen: &chosen,
        covariance: covariance(&fitted, &prior, &scores)?,
        doubts: signs(&chosen, &held_out, &prior)?,
        solved: &solved,
        held_out,
    };
    found.require_explained()?;
    Ok(SharedEstimate {
        estimate: found.estimate(),
        friction: (0..layout.joints).map(|j| found.friction(j)).collect(),
    })
}

/// Sums as the fit takes them: their columns have no mean left.
fn sums_of(layout: &Layout, shares: &[ShareSums]) -> Sums {
    let of_estimate = |share: &ShareSums| -> Vec<DMatrix<f64>> {
        let part = |(joint, products): (usize, &DMatrix<f64>)| {
            let width = layout.width(joint);
            products.view((0, 0), (width, width)).into_owned()
        };
        share.products.iter().enumerate().map(part).collect()
    };
    let piece = |(fold, share): (usize, &ShareSums)| PieceSums {
        run: 0,
        fold,
        weight: share.weights.clone(),
        columns: (0..layout.joints).map(|joint| DVector::zeros(layout.width(joint))).collect(),
    };
    Sums {
        folds: shares.iter().map(of_estimate).collect(),
        pieces: shares.iter().enumerate().map(piece).collect(),
        samples: shares.iter().map(|share| share.samples).sum(),
    }
}

/// Everything that the estimate is reported from.
struct Found<'a> {
    data: &'a SharedData<'a>,
    prior: &'a Prior,
    chosen: &'a Chosen<'a>,
    solved: &'a Solved,
    covariance: Covariance,
    held_out: HeldOut,
    doubts: Vec<Option<String>>,
}

impl Found<'_> {
    fn layout(&self) -> &Layout {
        &self.data.columns.layout
    }

    /// Refuses a fit that explains too little, or another sign better.
    fn require_explained(&self) -> Result<()> {
        let least = self.data.settings.least_r_squared;
        let held_out: Vec<f64> =
            (0..self.layout().joints).map(|j| self.r_squared(j, self.held_out.rss[j])).collect();
        let poor = |j: &usize| {
            let wrong = held_out[*j] < least || held_out[*j].is_nan() || self.doubts[*j].is_some();
            self.layout().moves[*j] && wrong
        };
        let Some(joint) = (0..held_out.len()).find(poor).filter(|_| !self.data.settings.accept_poor) else {
            return Ok(());
        };
        let usual = "check sign, unit and assignment of the columns where the logs are reduced, and that the robot moved freely";
        Err(IdentificationError::Unexplained {
            joint: self.data.robot.joint_names()[joint].clone(),
            r_squared: held_out[joint],
            least,
            reasons: self.doubts[joint].clone().unwrap_or_else(|| usual.into()),
        })
    }

    fn gain(&self, joint: usize) -> f64 {
        self.solved.values.gains[joint]
    }

    /// Σ (1 − w) r² and Σ (1 − w)(z − z̄)² in units of force.
    fn lost(&self, joint: usize) -> [f64; 2] {
        let sum = |which: usize| self.data.shares.iter().map(|share| share.lost[joint][which]).sum::<f64>();
        [0, 1].map(|which| self.gain(joint).powi(2) * sum(which))
    }

    /// `1 − RSS / Σ (τ − τ̄)²`, τ̄ by run, outliers counted in full.
    fn r_squared(&self, joint: usize, rss: f64) -> f64 {
        let products = &self.chosen.centred.all[joint];
        let last = products.nrows() - 1;
        let [residual, total] = self.lost(joint);
        1.0 - (rss + residual) / (self.gain(joint).powi(2) * products[(last, last)] + total)
    }

    fn estimate(&self) -> Estimate {
        let described = self.data.robot.parameters();
        let parameters = described.iter().enumerate().map(|(i, base)| self.uncertain(i, *base));
        let names = self.data.robot.joint_names();
        let warnings = names.iter().enumerate().flat_map(|(joint, name)| {
            self.doubts_of(joint).into_iter().map(move |doubt| format!("Joint {name}: {doubt}"))
        });
        let warnings = warnings.collect();
        let mut choices = vec!["Each joint's force has an offset in each run.".to_owned()];
        choices.extend(chosen_in_words(
            self.data.robot,
            self.chosen,
            self.prior,
            self.solved,
            &self.covariance,
        ));
        let values = &self.solved.values.unknowns;
        Estimate {
            parameters: parameters.collect(),
            consistent: self.prior.can_exist(values),
            joints: names.into_iter().enumerate().map(|(joint, name)| self.joint(joint, name)).collect(),
            effort: self.layout().effort,
            offsets: Offsets::ByRun,
            description_weight: self.chosen.weighting.description,
            weights_tried: self.chosen.tried.clone(),
            effective_parameters: self.covariance.decided,
            load_friction: Vec::new(),
            measured: Vec::new(),
            predicted: Vec::new(),
            friction: Vec::new(),
            confidence: self.data.settings.confidence,
            instrumental: None,
            choices,
            warnings,
        }
    }

    /// Doubts about a moving joint: its sign, its unit, and a residual that follows the acceleration.
    fn doubts_of(&self, joint: usize) -> Vec<String> {
        let layout = self.layout();
        if !layout.moves[joint] {
            return Vec::new();
        }
        let products = &self.chosen.centred.all[joint];
        let width = products.nrows();
        let residual = residual_vector(layout, &self.solved.values, joint);
        let force = force_vector(layout, &self.solved.values, joint);
        let column = |place: usize| DVector::from_fn(width, |i, _| if i == place { 1.0 } else { 0.0 });
        let sum = |a: &DVector<f64>, b: &DVector<f64>| (products * a).dot(b);
        let acceleration = column(layout.local[joint].len() - TERMS + ARMATURE);
        let [described, measured] = [column(width - 2), column(width - 1) * self.gain(joint)];
        let sizes = [&force, &described, &measured].map(|of| sum(of, of).max(0.0).sqrt());
        let sums =
            [sum(&acceleration, &acceleration), sum(&acceleration, &residual), sum(&residual, &residual)];
        let (time, samples) = (self.data.correlation_time, self.chosen.centred.sums.samples);
        let doubts =
            [self.doubts[joint].clone(), unit_doubt(sizes), acceleration_doubt_of(sums, time, samples)];
        doubts.into_iter().flatten().collect()
    }

    fn uncertain(&self, global: usize, base: f64) -> Uncertain {
        self.with_interval(
            base + self.solved.values.unknowns[global],
            self.covariance.deviation(self.solved, global),
        )
    }

    /// Student's interval: the shares' scores have a variance of their own.
    fn with_interval(&self, value: f64, deviation: f64) -> Uncertain {
        let freedom = self.data.shares.len().max(2) as f64 - 1.0;
        let quantile = super::super::confidence::quantile(self.data.settings.confidence, freedom);
        Uncertain::new(value, deviation, quantile.unwrap_or(f64::INFINITY))
    }

    fn joint(&self, joint: usize, name: String) -> JointEstimate {
        let (layout, model) = (self.layout(), &self.chosen.model);
        let rss = self.chosen.centred.residuals(&self.chosen.centred.all, &self.solved.values)[joint];
        let samples: usize = self.data.shares.iter().map(|share| share.samples).sum();
        let armature = model.armature[joint] && layout.moves[joint];
        let gain = || {
            let relative = self.covariance.deviation(self.solved, layout.gain(joint));
            self.with_interval(self.gain(joint), self.gain(joint) * relative)
        };
        JointEstimate {
            name,
            unit: if self.data.robot.position_units()[joint] == "m" { "N" } else { "N·m" },
            terms: self.terms(joint),
            load: None,
            armature: armature.then(|| self.uncertain(layout.term(joint, ARMATURE), 0.0)),
            gain: model.gains.then(gain),
            offsets: Vec::new(),
            sigma: ((rss + self.lost(joint)[0]) / samples.max(1) as f64).sqrt(),
            r_squared: self.r_squared(joint, rss),
            held_out_r_squared: self.r_squared(joint, self.held_out.rss[joint]),
            moves: layout.moves[joint],
            exact: layout.exact[joint],
            measured: true,
        }
    }

    fn terms(&self, joint: usize) -> Vec<EstimatedTerm> {
        let (layout, model) = (self.layout(), &self.chosen.model);
        if !layout.moves[joint] {
            return Vec::new();
        }
        let width = model.coulomb[joint];
        let tanh = format!("tanh({}*v)", layout.steepness[joint][width]);
        let mut terms = vec![("v".to_owned(), VISCOUS), (tanh, COULOMB.start + width)];
        terms.extend(model.asymmetry[joint].then(|| ("abs(v)".to_owned(), ASYMMETRY)));
        let term = |(basis, term)| EstimatedTerm {
            basis,
            coefficient: self.uncertain(layout.term(joint, term), 0.0),
        };
        terms.into_iter().map(term).collect()
    }

    /// Measured force minus the rigid body's and an added inertia's, as factors of a joint's columns.
    fn friction(&self, joint: usize) -> DVector<f64> {
        let layout = self.layout();
        let mut factors = residual_vector(layout, &self.solved.values, joint);
        let first = layout.local[joint].len() - TERMS;
        (VISCOUS..=ASYMMETRY).for_each(|term| factors[first + term] = 0.0);
        let width = factors.len();
        factors.resize_vertically(width + EXTRA, 0.0)
    }
}
