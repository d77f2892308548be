//! The pipeline from runs to an estimate.

use super::super::error::{IdentificationError, Result, require_finite};
use super::super::robot::Robot;
use super::super::run::{Effort, PreparedRun};
use super::checks;
use super::choice::{Chosen, Freedom, choose};
use super::fit::{Solved, fit};
use super::intervals::{Fitted, correlation_time, covariance, scores};
use super::layout::{ARMATURE, ASYMMETRY, COULOMB, Layout, VISCOUS};
use super::normal::Values;
use super::normal::residual_vector;
use super::prior::Prior;
use super::residuals::{Forces, RunOffsets, forces, huber, residual, robust_deviations};
use super::result::{Estimate, EstimatedTerm, JointEstimate, Uncertain};
use super::rows::Rows;
use super::settings::EstimationSettings;
use super::sums::{Piece, Sums, cut, sum};
use nalgebra::DVector;
use statrs::distribution::{ContinuousCDF, Normal};

/// The robot, the data and the settings, as the stages need them.
pub(super) struct Task<'a> {
    pub(super) robot: &'a dyn Robot,
    pub(super) runs: &'a [PreparedRun],
    pub(super) settings: &'a EstimationSettings,
    pub(super) layout: &'a Layout,
    pub(super) prior: &'a Prior,
}

/// Inertial parameters, friction, offsets and gains of a robot from its runs.
///
/// For each joint j the fit explains the measured force, with weights 1/σⱼ² that follow from the residuals:
///
/// `K z = W(y, ẏ, ÿ) π + s + v φ₁ + tanh(k v) φ₂ [+ |v| φ₃ + ÿ φ₄] + o + e`
///
/// z is the measured effort times B, K the drive's gain (estimated where efforts are currents, else one), s the
/// description's forces that are no inertia, and o the offset. π is held near the description along directions
/// that the data cannot tell: `λ` times the squared distance of [`prior`](self) is added, with the largest λ
/// whose held-out error is not worse than the best by more than a standard error.
///
/// `progress` gets a sentence at each stage.
///
/// # Errors
/// Data of the wrong shape or not finite, settings out of range, and a fit that explains less of a moving joint
/// than [`EstimationSettings::least_r_squared`] on held-out data.
pub fn estimate(
    robot: &dyn Robot,
    runs: &[PreparedRun],
    settings: &EstimationSettings,
    progress: &mut dyn FnMut(&str),
) -> Result<Estimate> {
    settings.check()?;
    require_finite("the description's inertial parameters", &robot.parameters())?;
    let layout = Layout::new(robot, runs)?;
    let prior = Prior::new(&robot.parameters(), robot.bodies());
    let task = Task { robot, runs, settings, layout: &layout, prior: &prior };
    let pieces = cut(runs, settings.folds);
    let samples: usize = runs.iter().map(|r| r.times.len()).sum();
    progress(&format!("The regressor is evaluated at {samples} samples of {} runs.", runs.len()));
    let first = task.sums(&pieces, None);
    progress("Terms, offsets and the weight of the description are chosen by the held-out error.");
    let chosen = task.choose(&first)?;
    let mut outlier = vec![f64::INFINITY; layout.joints];
    let (mut values, mut offsets) = (chosen.values.clone(), chosen.offsets());
    let mut robust = first.clone();
    for pass in 0..settings.robust_passes {
        progress(&format!("Outliers lose weight, pass {} of {}.", pass + 1, settings.robust_passes));
        outlier = robust_deviations(&task.forces(&values, &offsets));
        robust = task.sums(&pieces, Some((&values, &offsets, &outlier)));
        let again = chosen.with_sums(&robust, &prior)?;
        (values, offsets) = (again.values.clone(), again.offsets());
    }
    let mut last = chosen.with_sums(&robust, &prior)?;
    last.reweight(&prior)?;
    task.finish(&chosen, last, &outlier, progress)
}

/// Values, offsets and deviations that weights of samples are made of.
type Robust<'a> = (&'a Values, &'a RunOffsets, &'a [f64]);

impl Task<'_> {
    pub(super) fn rows(&self) -> Rows<'_> {
        Rows::new(self.robot, self.layout, self.settings.gravity_compensated)
    }

    fn sums(&self, pieces: &[Piece], robust: Option<Robust>) -> Sums {
        let factors: Vec<DVector<f64>> = robust.map_or(Vec::new(), |(values, ..)| {
            (0..self.layout.joints).map(|j| residual_vector(self.layout, values, j)).collect()
        });
        let weights = |run: usize, joint: usize, columns: &[&[f64]]| match robust {
            None => vec![1.0; columns.first().map_or(0, |c| c.len())],
            Some((_, offsets, deviations)) => {
                huber(&residual(&factors[joint], offsets[joint][run], columns), deviations[joint])
            }
        };
        sum(&mut self.rows(), self.layout, self.runs, pieces, &weights)
    }

    pub(super) fn forces(&self, values: &Values, offsets: &RunOffsets) -> Forces {
        forces(&mut self.rows(), self.layout, self.runs, values, offsets)
    }

    fn choose<'s>(&'s self, sums: &'s Sums) -> Result<Chosen<'s>> {
        let gains = self.layout.effort == Effort::Current;
        let start = Values {
            unknowns: DVector::zeros(self.layout.len()),
            gains: if gains {
                checks::first_gains(self.layout, sums)?
            } else {
                vec![1.0; self.layout.joints]
            },
        };
        let freedom = Freedom {
            offsets: self.settings.offsets,
            terms: self.settings.optional_terms,
            consistent: self.settings.consistent,
        };
        choose(self.layout, sums, self.prior, &start, freedom, gains)
    }

    fn finish(
        &self,
        plain: &Chosen,
        last: Chosen,
        outlier: &[f64],
        progress: &mut dyn FnMut(&str),
    ) -> Result<Estimate> {
        let solved =
            fit(&last.centred, &last.centred.all, &last.model, self.prior, &last.weighting, &last.values)?;
        let values = solved.values.clone();
        let offsets = last.offsets();
        progress("Intervals are computed under correlated residuals.");
        let forces = self.forces(&values, &offsets);
        let time = self.correlation_time(&forces);
        let fitted = Fitted {
            centred: &last.centred,
            solved: &solved,
            weighting: &last.weighting,
            values: &values,
            offsets: &offsets,
            outlier,
        };
        let scores = scores(&mut self.rows(), self.layout, self.runs, &fitted, time);
        let covariance = covariance(&fitted, self.prior, &scores)?;
        let mut deviation = vec![0.0; self.layout.len()];
        solved
            .active
            .iter()
            .enumerate()
            .for_each(|(i, &g)| deviation[g] = covariance[(i, i)].max(0.0).sqrt());
        let held_out = plain.centred_r_squared(&plain.held_out(self.prior)?.rss);
        let report = Report {
            task: self,
            chosen: &last,
            solved: &solved,
            forces: &forces,
            offsets: &offsets,
            deviation: &deviation,
            held_out: &held_out,
        };
        report.estimate()
    }

    fn correlation_time(&self, forces: &Forces) -> f64 {
        let time = |j: usize| {
            let series: Vec<&[f64]> = forces.residual.iter().map(|run| run[j].as_slice()).collect();
            correlation_time(&series)
        };
        (0..self.layout.joints).map(time).fold(1.0, f64::max)
    }
}

impl Chosen<'_> {
    pub(super) fn offsets(&self) -> RunOffsets {
        (0..self.centred.layout.joints).map(|j| self.centred.offsets(&self.values, j)).collect()
    }

    /// R² of each joint for given residual sums: centred over what shares an offset.
    fn centred_r_squared(&self, rss: &[f64]) -> Vec<f64> {
        let share = |(joint, rss): (usize, &f64)| {
            let products = &self.centred.all[joint];
            let last = products.nrows() - 1;
            1.0 - rss / (self.values.gains[joint].powi(2) * products[(last, last)])
        };
        rss.iter().enumerate().map(share).collect()
    }
}

/// Everything that the printed estimate is made of.
struct Report<'a> {
    task: &'a Task<'a>,
    chosen: &'a Chosen<'a>,
    solved: &'a Solved,
    forces: &'a Forces,
    offsets: &'a RunOffsets,
    deviation: &'a [f64],
    held_out: &'a [f64],
}

impl Report<'_> {
    fn estimate(&self) -> Result<Estimate> {
        let Task { robot, settings, layout, .. } = self.task;
        let described = robot.parameters();
        let parameters = (0..layout.parameters).map(|i| self.uncertain(i, described[i]));
        let add = |a: &[f64], b: &[f64], sign: f64| {
            a.iter().zip(b).map(|(a, b)| a + sign * b).collect::<Vec<f64>>()
        };
        let each = |of: &dyn Fn(usize, usize) -> Vec<f64>| -> Vec<Vec<Vec<f64>>> {
            let runs = 0..self.forces.measured.len();
            runs.map(|r| (0..layout.joints).map(|j| of(r, j)).collect()).collect()
        };
        let Forces { measured, residual, rigid } = self.forces;
        Ok(Estimate {
            parameters: parameters.collect(),
            consistent: false,
            joints: self.joints(),
            effort: layout.effort,
            offsets: self.chosen.model.offsets,
            description_weight: self.chosen.weighting.description,
            weights_tried: self.chosen.tried.clone(),
            effective_parameters: 0.0,
            predicted: each(&|r, j| add(&measured[r][j], &residual[r][j], -1.0)),
            friction: each(&|r, j| add(&measured[r][j], &rigid[r][j], -1.0)),
            measured: measured.clone(),
            confidence: settings.confidence,
            choices: Vec::new(),
            warnings: Vec::new(),
            bias: None,
        })
    }

    fn uncertain(&self, global: usize, base: f64) -> Uncertain {
        let level = self.task.settings.confidence;
        let quantile = Normal::standard().inverse_cdf(0.5 + 0.5 * level);
        Uncertain::new(base + self.solved.values.unknowns[global], self.deviation[global], quantile)
    }

    fn joints(&self) -> Vec<JointEstimate> {
        let names = self.task.robot.joint_names();
        let rss: Vec<f64> = (0..names.len()).map(|j| self.squares(j)).collect();
        let in_fit = self.chosen.centred_r_squared(&rss);
        names.into_iter().enumerate().map(|(j, name)| self.joint(j, name, in_fit[j])).collect()
    }

    fn squares(&self, joint: usize) -> f64 {
        self.forces.residual.iter().flat_map(|run| &run[joint]).map(|r| r * r).sum()
    }

    fn joint(&self, joint: usize, name: String, r_squared: f64) -> JointEstimate {
        let Task { robot, layout, .. } = self.task;
        let model = &self.chosen.model;
        let count: usize = self.forces.residual.iter().map(|run| run[joint].len()).sum();
        let armature = model.armature[joint] && layout.moves[joint];
        JointEstimate {
            name,
            unit: if robot.position_units()[joint] == "m" { "N" } else { "N·m" },
            terms: self.terms(joint),
            armature: armature.then(|| self.uncertain(layout.term(joint, ARMATURE), 0.0)),
            gain: model.gains.then(|| self.gain(joint)),
            offsets: self.offsets[joint].clone(),
            sigma: (self.squares(joint) / count.max(1) as f64).sqrt(),
            r_squared,
            held_out_r_squared: self.held_out[joint],
            moves: layout.moves[joint],
        }
    }

    fn terms(&self, joint: usize) -> Vec<EstimatedTerm> {
        let layout = self.task.layout;
        if !layout.moves[joint] {
            return Vec::new();
        }
        let width = self.chosen.model.coulomb[joint];
        let tanh = format!("tanh({}*v)", layout.steepness[joint][width]);
        let mut terms = vec![("v".to_string(), VISCOUS), (tanh, COULOMB.start + width)];
        if self.chosen.model.asymmetry[joint] {
            terms.push(("abs(v)".to_string(), ASYMMETRY));
        }
        let term = |(basis, term)| EstimatedTerm {
            basis,
            coefficient: self.uncertain(layout.term(joint, term), 0.0),
        };
        terms.into_iter().map(term).collect()
    }

    /// K_M: its relative error is that of the rigid force.
    fn gain(&self, joint: usize) -> Uncertain {
        let value = self.solved.values.gains[joint];
        let quantile = Normal::standard().inverse_cdf(0.5 + 0.5 * self.task.settings.confidence);
        Uncertain::new(value, value * self.deviation[self.task.layout.gain(joint)], quantile)
    }
}

/// An error that names what a fit misses.
pub(super) fn unexplained(
    joint: &str,
    r_squared: f64,
    least: f64,
    reasons: &[String],
) -> IdentificationError {
    IdentificationError::Unexplained { joint: joint.into(), r_squared, least, reasons: reasons.join("; ") }
}
