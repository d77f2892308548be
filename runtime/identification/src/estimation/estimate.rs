//! The steps from runs to an estimate.

use super::super::error::{IdentificationError, Result, require_finite};
use super::super::robot::Robot;
use super::super::run::PreparedRun;
use super::checks::Checked;
use super::choice::{Chosen, Freedom, choose};
use super::delays::FirstFit;
use super::estimated::{Estimated, is_doubted, is_unexplained, require_explained, unexplained};
use super::fit::HeldOut;
use super::intervals::{RigidFit, correlation_time, covariance, offset_errors, scores};
use super::joint_prior::JointPrior;
use super::layout::Layout;
use super::loads::{Loads, PASSES, settled};
use super::margin::{change_at_margin, runs_away_from_stops};
use super::normal::{Centred, Values, residual_vector};
use super::prior::Prior;
use super::report::Report;
use super::residuals::{Forces, RunOffsets, huber, residual, robust_deviations};
use super::result::{Estimate, Gravity, Offsets};
use super::settings::EstimationSettings;
use super::signs::is_driving;
use super::sums::{Sums, Weights, cut, moving, resting, sum};
use super::task::Task;
use super::trial::{Case, is_refusal};
use gelenk_findings::{Finding, Rule, Subject};
use nalgebra::DVector;

/// Sees: coefficients of load-dependent friction that change from pass to pass.
/// Matters: their intervals are too narrow.
/// Example: friction that is not proportional to the load.
/// Fixture: `estimation/tests/load.rs`.
const UNSETTLED: Rule = Rule::warning("load-shares-unsettled");

/// Sees: a joint whose effort the fit hardly explains, while it explains the efforts of other joints.
/// Matters: the joint keeps its described friction and drive.
/// Example: a dead channel of one effort.
/// Fixture: `codegen/tests/external_arm/doubts.rs`.
const LEFT_OUT: Rule = Rule::warning("joint-left-out");

/// Estimates inertial parameters, friction, offsets of the efforts and gains of the drives of a robot from its runs.
///
/// For each joint j the fit explains the measured force, with weights 1/σⱼ² from the variance σⱼ² of the joint's residual e:
///
/// `K z = W(y, ẏ, ÿ) π + s + v φ₁ + tanh(k v) φ₂ [+ |v| φ₃ + ÿ φ₄] + o + e`
///
/// - z: measured effort of the joint. If efforts are inputs or currents, it is the row of the input matrix B times the efforts.
/// - K: gain of the drive. The gain is one except for currents without a described motor constant. Such gains are estimated
///   first, relative to the described masses.
/// - W π: regressor of the robot times its inertial parameters
/// - s: forces in the description that are not inertial, for example forces of springs
/// - v: velocity of the joint, the entry j of ẏ
/// - k: factor of the smoothed Coulomb term ([`EstimationSettings::steepness`])
/// - φ: friction and reflected inertia. The terms in brackets are optional.
/// - o: offset
///
/// Regularization keeps the parameters π near the description in directions that the data do not determine: λ times the
/// squared distance from the described bodies is added to the sum of squares. The held-out error is the error on folds of the
/// data to which the values were not fitted. λ is the largest value whose held-out error exceeds the smallest held-out error
/// by at most one standard error.
///
/// If [`EstimationSettings::load_friction`] is set, the friction of a joint may also contain `|τ_l| s₁ tanh(k v)` with a
/// coefficient s₁. The load τ_l of the gear is the force of the rigid-body dynamics without friction. It is computed with the
/// estimate of the previous pass. Passes are repeated until s₁ settles.
///
/// `progress` receives a sentence at each stage.
///
/// An effort that is NaN in all samples counts as not measured, and its joint keeps the described values. A joint whose fit
/// explains too little is left out with a warning if no remedy is known and other joints remain.
///
/// # Errors
/// - [`Shape`](IdentificationError::Shape), [`NotFinite`](IdentificationError::NotFinite),
///   [`TooFewSamples`](IdentificationError::TooFewSamples): runs of a wrong shape, with values that are not finite, or with
///   fewer than three samples
/// - [`Empty`](IdentificationError::Empty): no runs, or no measured effort
/// - [`Setting`](IdentificationError::Setting): a setting out of its range
/// - [`File`](IdentificationError::File): efforts of several kinds; inputs at frames, or currents of joints with several
///   inputs; load-dependent friction that is requested although no moving joint has an input that drives it alone
/// - [`Found`](IdentificationError::Found): a moving joint with a lower R² on held-out data than
///   [`EstimationSettings::least_r_squared`], if a remedy is known or no other joint remains; another explanation of the
///   data, such as other gravity or another unit, that is clearly better
/// - [`NoSolution`](IdentificationError::NoSolution), [`Overflow`](IdentificationError::Overflow),
///   [`NotConverged`](IdentificationError::NotConverged): equations that are singular or overflow, or gains that do not
///   converge
pub fn estimate(
    robot: &dyn Robot,
    runs: &[PreparedRun],
    settings: &EstimationSettings,
    progress: &mut dyn FnMut(&str),
) -> Result<Estimate> {
    settings.check()?;
    require_finite("the description's inertial parameters", &robot.parameters())?;
    let mut settings = settings.clone();
    let (mut findings, mut first) = (Vec::new(), None);
    loop {
        let error = match estimate_of(robot, runs, &settings, progress) {
            Ok(mut found) => {
                found.findings.splice(0..0, findings);
                return Ok(found);
            }
            Err(error) => error,
        };
        let untold = untold(robot, &error).filter(|(joint, _)| has_others(robot, runs, &settings, *joint));
        let Some((joint, finding)) = untold else { return Err(first.unwrap_or(error)) };
        settings.without.push(joint);
        findings.push(finding);
        first.get_or_insert(error);
    }
}

/// The joint whose effort no hypothesis explains, and the finding that the joint is left out; `None` if the error has
/// another reason.
fn untold(robot: &dyn Robot, error: &IdentificationError) -> Option<(usize, Finding)> {
    let (refusal, reasons) = error.refusals().split_first().filter(|(refusal, _)| is_doubted(refusal))?;
    let (reason, remedy) = match reasons.iter().find(|reason| is_driving(reason)) {
        Some(driving) => (driving.message.clone(), driving.remedy.clone()),
        None if !reasons.iter().any(is_unexplained) => return None,
        None => (refusal.message.clone(), None),
    };
    let kept = "It is left out. Its friction and drive, and body parameters that other joints do not determine, stay as described";
    let finding = LEFT_OUT.found(format!("{reason}. {kept}")).of(refusal.about.subject.clone());
    let joint =
        (0..robot.joint_names().len()).find(|joint| robot.subject(*joint) == finding.about.subject)?;
    Some((joint, Finding { remedy, ..finding }))
}

/// Whether another joint moves and has a usable effort.
fn has_others(robot: &dyn Robot, runs: &[PreparedRun], settings: &EstimationSettings, joint: usize) -> bool {
    let without = [&settings.without[..], &[joint]].concat();
    Layout::of(robot, runs, &EstimationSettings { without, ..settings.clone() }, None, false)
        .is_ok_and(|layout| layout.rubbing().next().is_some())
}

/// The estimate of all joints except the joints in `settings.without`.
fn estimate_of(
    robot: &dyn Robot,
    runs: &[PreparedRun],
    settings: &EstimationSettings,
    progress: &mut dyn FnMut(&str),
) -> Result<Estimate> {
    if settings.load_friction {
        return under_load(robot, runs, settings, progress);
    }
    let layout = Layout::of(robot, runs, settings, settings.steepness.as_deref(), false)?;
    pass(robot, runs, settings, &layout, None, progress).map(|(found, _)| found)
}

/// Repeats the estimate until the coefficients of load-dependent friction settle.
fn under_load(
    robot: &dyn Robot,
    runs: &[PreparedRun],
    settings: &EstimationSettings,
    progress: &mut dyn FnMut(&str),
) -> Result<Estimate> {
    let layout = Layout::of(robot, runs, settings, settings.steepness.as_deref(), false)?;
    // Load-dependent friction may be most of the residual, so a poor fit is accepted here.
    let first = EstimationSettings { accept_poor: true, ..settings.clone() };
    let (mut found, steepness) = pass(robot, runs, &first, &layout, None, progress)?;
    // The term of load-dependent friction has the same steepness k as the Coulomb term.
    let layout = Layout::of(robot, runs, settings, Some(&steepness), true)?;
    for number in 1..=PASSES {
        let loads = Loads::new(robot, &layout, &found)?;
        progress(&format!("Load-dependent friction, pass {number}."));
        let (next, _) = pass(robot, runs, settings, &layout, Some(&loads), progress)?;
        let settled = number > 1 && settled(&found, &next);
        found = next;
        if settled {
            return Ok(found);
        }
    }
    let message = format!(
        "load-dependent friction did not converge within {PASSES} passes, so the intervals of its coefficients are too narrow"
    );
    found.findings.push(UNSETTLED.found(message));
    Ok(found)
}

/// One estimate with given loads of the gears. Also returns the factor k of each joint's Coulomb term tanh(k
/// v), with the velocity v.
fn pass(
    robot: &dyn Robot,
    runs: &[PreparedRun],
    settings: &EstimationSettings,
    layout: &Layout,
    loads: Option<&Loads>,
    progress: &mut dyn FnMut(&str),
) -> Result<(Estimate, Vec<f64>)> {
    let prior = Prior::new(&robot.parameters(), robot.bodies(), JointPrior::all(robot, layout, runs));
    let pieces = cut(runs, settings.folds);
    let gravity = Gravity::of(settings.gravity_compensated);
    let (first_fit, more) = (None, None);
    let task = Task { robot, runs, settings, layout, prior: &prior, gravity, pieces, loads, first_fit, more };
    let samples: usize = runs.iter().map(|r| r.times.len()).sum();
    progress(&format!("The equations of motion are evaluated at {samples} samples of {} runs.", runs.len()));
    let (task, first) = task.with_its_compensation(progress)?;
    let first_fit = task.first_fit(&first)?;
    let (task, first) = match &first_fit {
        Some(fit) => {
            let task = Task { runs: &fit.runs, first_fit: Some(fit), ..task };
            let sums = task.sums(None);
            (task, sums)
        }
        None => (task, first),
    };
    progress(
        "Friction terms, offsets and the weight of the description are chosen by the error on held-out data.",
    );
    let mut outlier = vec![f64::INFINITY; layout.joints];
    let mut times = vec![1.0; layout.joints];
    let mut robust = first.clone();
    for pass in 0..settings.robust_passes {
        let chosen = task.choose(&robust)?;
        let passes = settings.robust_passes;
        progress(&format!("Pass {} of {passes} reduces the weights of outliers.", pass + 1));
        let offsets = chosen.centred.all_offsets(&chosen.values);
        let forces = task.forces(&chosen.values, &offsets);
        outlier = robust_deviations(layout, runs, &forces);
        times = task.correlation_times(&forces);
        let sums = task.sums(Some((&chosen.values, &offsets, &outlier)));
        drop(chosen);
        robust = sums;
    }
    let mut prior = prior.clone();
    prior.joints.iter_mut().zip(&times).for_each(|(joint, time)| joint.time = *time);
    let task = Task { prior: &prior, ..task };
    let chosen = task.choose(&robust)?;
    let widths = layout.steepness.iter().zip(&chosen.model.coulomb);
    let steepness = widths.map(|(steepness, width)| steepness[*width]).collect();
    Ok((task.finish(&first, &chosen, &outlier, progress)?, steepness))
}

/// Values of the unknowns, offsets, and robust deviations of the residuals. They determine the weights of the
/// samples.
type Robust<'a> = (&'a Values, &'a RunOffsets, &'a [f64]);

impl Task<'_> {
    /// Sums of products over the samples in which the joints move. If gains are estimated, there are also
    /// sums without the samples near stops.
    pub(super) fn sums(&self, robust: Option<Robust>) -> Sums {
        let away = self.layout.known_gains.contains(&false).then(|| runs_away_from_stops(self)).flatten();
        let away = away.map(|runs| Box::new(Task { runs: &runs, ..self.clone() }.weighted(robust)));
        Sums { away, ..self.weighted(robust) }
    }

    /// Weighted sums of products over the samples in which the joints move.
    pub(super) fn weighted(&self, robust: Option<Robust>) -> Sums {
        let factors: Vec<DVector<f64>> = robust.map_or(Vec::new(), |(values, ..)| {
            (0..self.layout.joints).map(|j| residual_vector(self.layout, values, j)).collect()
        });
        let Some((_, offsets, deviations)) = robust else { return self.sums_of(&moving) };
        self.sums_of(&|run, joint, columns, moving| {
            let residual = residual(&factors[joint], offsets[joint][run], columns);
            let weights = huber(&residual, deviations[joint]);
            weights.iter().zip(moving).map(|(weight, moves)| weight * moves).collect()
        })
    }

    /// The first fit with unknown delays; `None` if the delays are known.
    fn first_fit(&self, sums: &Sums) -> Result<Option<FirstFit>> {
        if self.layout.delays.is_empty() {
            return Ok(None);
        }
        let chosen = self.choose(sums)?;
        let forces = self.forces(&chosen.values, &chosen.centred.all_offsets(&chosen.values));
        Ok(Some(FirstFit::new(self.layout, self.runs, &chosen.values, &forces)))
    }

    pub(super) fn sums_of(&self, weights: Weights) -> Sums {
        sum(&mut self.rows(), self.layout, self.runs, &self.pieces, weights)
    }

    /// R² of each joint on held-out data including the samples at rest, which the fit leaves out; `None` if no joint rests.
    ///
    /// - `judged`: fit to the sums of moving samples
    /// - `errors`: held-out errors of this fit
    fn with_rest(&self, judged: &Chosen, errors: &HeldOut) -> Option<Vec<f64>> {
        let rests = |run: &PreparedRun| run.resting.iter().flatten().any(|rests| *rests);
        if !self.runs.iter().any(rests) {
            return None;
        }
        let resting = self.sums_of(&resting);
        let all = judged.centred.sums.with(&resting);
        let whole = Centred::new(self.layout, &all, judged.model.offsets, judged.centred.zeros.clone());
        let share = |joint: usize| {
            let at_rest = errors.values.iter().enumerate();
            let at_rest =
                at_rest.map(|(fold, values)| judged.centred.rss_over(&resting, fold, values, joint));
            let rss = errors.rss[joint] + at_rest.sum::<f64>();
            1.0 - rss / (judged.values.gains[joint].powi(2) * whole.variation(joint))
        };
        Some((0..self.layout.joints).map(share).collect())
    }

    /// The task with the kind of gravity compensation that explains the data better, and its sums of
    /// products. The comparison uses one offset for all runs unless the settings give another kind. Offsets
    /// of single runs would explain the weight that is not compensated.
    fn with_its_compensation(self, progress: &mut dyn FnMut(&str)) -> Result<(Self, Sums)> {
        let sums = self.sums(None);
        if self.gravity != Gravity::Compensated {
            return Ok((self, sums));
        }
        let as_described = Self { gravity: Gravity::CompensatedAsDescribed, ..self.clone() };
        let other_sums = as_described.sums(None);
        let is_better = {
            let offsets = self.settings.offsets.or(Some(Offsets::Common));
            let own = self.choose_with(&sums, offsets)?;
            let mut other = as_described.choose_with(&other_sums, offsets)?;
            // Errors can be compared only in the same units.
            other.weighting.sigma.clone_from(&own.weighting.sigma);
            let (excess, deviation) = other.held_out(self.prior)?.excess(&own.held_out(self.prior)?);
            excess < -deviation
        };
        if !is_better {
            return Ok((self, sums));
        }
        progress(
            "The error on held-out data shows that the robot compensates only the weight of the described bodies.",
        );
        Ok((as_described, other_sums))
    }

    /// The kind of offsets, if it is already decided; otherwise `None`.
    fn offsets(&self) -> Option<Offsets> {
        let weighs = self.gravity == Gravity::CompensatedAsDescribed;
        self.settings.offsets.or(weighs.then_some(Offsets::Common))
    }

    pub(super) fn choose<'s>(&'s self, sums: &'s Sums) -> Result<Chosen<'s>> {
        self.choose_with(sums, self.offsets())
    }

    fn choose_with<'s>(&'s self, sums: &'s Sums, offsets: Option<Offsets>) -> Result<Chosen<'s>> {
        let freedom = Freedom {
            offsets,
            terms: self.settings.optional_terms,
            consistent: self.settings.consistent,
            loads: self.loads.map_or(&[], |loads| &loads.joints),
        };
        choose(self.layout, sums, self.prior, freedom)
    }

    /// Intervals, doubts and predictions of the last fit.
    ///
    /// - `plain`: sums in which every sample has the weight one
    /// - `last`: the choice of the last fit
    /// - `outlier`: robust deviation of each joint
    fn finish(
        &self,
        plain: &Sums,
        last: &Chosen,
        outlier: &[f64],
        progress: &mut dyn FnMut(&str),
    ) -> Result<Estimate> {
        let fit = RigidFit::new(last, self.prior, outlier)?;
        progress("Intervals are computed for correlated residuals.");
        let forces = self.forces(&fit.solved.values, &fit.offsets);
        let times = self.correlation_times(&forces);
        let measured = times.iter().zip(&self.layout.measured).filter(|(_, measured)| **measured);
        let time = measured.map(|(time, _)| *time).fold(1.0, f64::max);
        let covariance = covariance(&fit, &scores(&mut self.rows(), self.runs, &fit, time))?;
        let errors = |joint: usize| offset_errors(&fit, &covariance, joint);
        let offset_errors = (0..self.layout.joints).map(errors).collect();
        let judged = last.with_sums(plain, self.prior)?;
        let errors = judged.held_out(self.prior)?;
        let held_out = judged.centred_r_squared(&errors.rss);
        let with_rest = self.with_rest(&judged, &errors);
        progress("Other explanations of the data are tried, for example wrong signs or units.");
        let doubts = self.doubts(&judged, &errors, &held_out, &forces, time)?;
        let report = Report {
            fitted: Estimated {
                robot: self.robot,
                settings: self.settings,
                gravity: self.gravity,
                margin: change_at_margin(self, &fit),
                fit: &fit,
                covariance,
                delays: self.first_fit.map_or(&[], |fit| &fit.delays),
            },
            runs: self.runs,
            forces: &forces,
            offset_errors,
            held_out: &held_out,
            with_rest: with_rest.as_deref().unwrap_or(&held_out),
        };
        Ok(report.estimate(doubts.into_iter().map(Finding::accepted).collect()))
    }

    /// Findings that raise doubts about the fit, from other explanations of the data and from checks of the
    /// residuals.
    ///
    /// - `judged`, `errors`: fit to the sums of moving samples, and its held-out errors
    /// - `held_out`: R² of each joint on held-out data
    /// - `forces`, `correlation_time`: forces of the last fit, and the correlation time of the residuals
    ///
    /// # Errors
    /// [`IdentificationError::Found`] if another explanation is clearly better, if the unit is wrong for the
    /// whole robot, or if the fit explains too little.
    fn doubts(
        &self,
        judged: &Chosen,
        errors: &HeldOut,
        held_out: &[f64],
        forces: &Forces,
        correlation_time: f64,
    ) -> Result<Vec<Finding>> {
        let checked = Checked { task: self, forces, correlation_time };
        let accept_poor = self.settings.accept_poor;
        let ratio = checked.common_ratio();
        let case = Case::new(self.robot, self.prior, judged, errors, ratio.as_ref(), Some(&checked))?;
        let mut doubts = case.doubts()?;
        let of_all = |doubt: &&Finding| doubt.about.subject == Subject::Whole && is_refusal(doubt);
        let refusals: Vec<Finding> = doubts.iter().filter(of_all).cloned().collect();
        if !refusals.is_empty() && !accept_poor {
            return Err(IdentificationError::Found { findings: refusals });
        }
        self.require_explained(held_out, &doubts, &checked)?;
        if let Some(ratio) = &ratio {
            doubts.extend(ratio.judged(accept_poor, || case.unit())?);
        }
        // A residual that a remedy removes has no second cause.
        let is_explained = |of: &Finding| doubts.iter().any(|offered| offered.about == of.about);
        let found: Vec<Finding> = checked.findings().into_iter().filter(|of| !is_explained(of)).collect();
        doubts.extend(found);
        Ok(doubts)
    }

    /// Refuses a fit that explains too little, with the likely reason.
    fn require_explained(&self, held_out: &[f64], doubts: &[Finding], checked: &Checked) -> Result<()> {
        let reasons = |joint: usize| {
            let of_all = doubts.iter().filter(|doubt| !is_refusal(doubt)).cloned();
            let reasons = of_all.chain(checked.joint(joint));
            reasons.chain([unexplained(self.robot, joint)]).collect()
        };
        require_explained(self.robot, self.layout, self.settings, held_out, doubts, reasons)
    }

    /// Correlation time of the residual of each joint [samples].
    fn correlation_times(&self, forces: &Forces) -> Vec<f64> {
        let time = |j: usize| {
            let of_run = |(run, forces): (&PreparedRun, &Vec<Vec<f64>>)| {
                let stretches = run.stretches(j, self.layout.moves[j]).into_iter();
                stretches.map(|rows| forces[j][rows].to_vec()).collect::<Vec<_>>()
            };
            let series: Vec<Vec<f64>> = self.runs.iter().zip(&forces.residual).flat_map(of_run).collect();
            correlation_time(&series.iter().map(Vec::as_slice).collect::<Vec<_>>())
        };
        (0..self.layout.joints).map(time).collect()
    }
}

impl Chosen<'_> {
    /// R² of each joint from its residual sum of squares. The total sum of squares is centred over the runs
    /// that share an offset.
    pub(super) fn centred_r_squared(&self, rss: &[f64]) -> Vec<f64> {
        let share = |(joint, rss): (usize, &f64)| {
            let variation = self.centred.variation(joint);
            1.0 - rss / (self.values.gains[joint].powi(2) * variation)
        };
        rss.iter().enumerate().map(share).collect()
    }
}
